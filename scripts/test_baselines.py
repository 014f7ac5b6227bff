#!/usr/bin/python3
"""Bullet's elements against theory, and how a stiffness is found. Skipped (77) where Bullet is not there.

usage: test_baselines.py LIBRARY      libshapebench.so"""
import os
import subprocess
import sys
import unittest


class Baselines(unittest.TestCase):
    def test_a_stiffness_is_found(self):
        self.assertAlmostEqual(baselines.match(lambda young: 3e4 / young, 0.1, 1e3, 1e8), 3e5, delta=3e3)
        self.assertEqual(baselines.match(lambda young: 1.0, 0.1, 1e3, 1e8), 1e8)  # the stiffest is too soft

    def test_methods_are_compared_with_the_first(self):
        rows = [{"sag %": 10.1, "ms/s": 20.0}, {"sag %": 10.3, "ms/s": 30.0}]
        self.assertEqual([(each["same sag"], each["times"]) for each in baselines.compared(rows, 10)],
                         [("yes", 1), ("no", 1.5)])

    def test_elements_sag_as_theory_says(self):
        """Linear elements of four cells through are stiffer than a beam, and no softer."""
        beam, young, gravity = baselines.Beam(4, shapebench), 2e6, 1.0
        free = beam.length - 1.5 * beam.cell
        theory = baselines.DENSITY * gravity * 12 * free ** 4 / (8 * young * baselines.THICK ** 2) / beam.length
        _, lies = baselines.bullet(beam, gravity, "elements", young, 0.01, 1, 0.02, 200)
        self.assertTrue(0.6 < beam.sag(lies) / theory < 1.05, (beam.sag(lies), theory))


if __name__ == "__main__":
    os.environ["SHAPEBENCH_LIBRARY"] = os.path.realpath(sys.argv.pop(1))
    if subprocess.run(["pkg-config", "--exists", "bullet"]).returncode:
        sys.exit(77)
    import baselines
    import shapebench
    baselines.build_adapter()
    unittest.main()
