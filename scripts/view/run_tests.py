#!/usr/bin/python3
"""Tests of the page, in a real browser without a screen: all, those named, or all but those named.

usage: run_tests.py PROGRAM [[but] TEST...]   exit code 77: there is no browser, nothing to drive it with, or no page
"""
import sys
import unittest

import page_case

names = sys.argv[2:]
if not names or names[0] == "but":
    names = sorted({file.stem for file in page_case.HERE.glob("test_*.py")} - set(names))
suite = unittest.defaultTestLoader.loadTestsFromNames(names)
ran = unittest.TextTestRunner(verbosity=2).run(suite)
sys.exit(77 if ran.skipped and ran.wasSuccessful() else not ran.wasSuccessful())
