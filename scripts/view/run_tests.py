#!/usr/bin/python3
"""All tests of the page, in a real browser without a screen.

usage: run_tests.py PROGRAM [TEST...]   exit code 77: there is no browser, nothing to drive it with, or no page
"""
import sys
import unittest

import page_case

tests = unittest.defaultTestLoader
suite = tests.loadTestsFromNames(sys.argv[2:]) if len(sys.argv) > 2 else tests.discover(str(page_case.HERE))
ran = unittest.TextTestRunner(verbosity=2).run(suite)
sys.exit(77 if ran.skipped and ran.wasSuccessful() else not ran.wasSuccessful())
