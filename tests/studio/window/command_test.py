"""Tests the command `koboshi studio`."""

import os
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
KOBOSHI = sys.argv.pop(1)
NO_DISPLAY = {name: value for name, value in os.environ.items()
              if name not in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")}


class Studio(unittest.TestCase):
    def studio(self, *arguments):
        return subprocess.run([KOBOSHI, "studio", *arguments], cwd=ROOT, env=NO_DISPLAY, capture_output=True, text=True, timeout=60)

    def test_says_one_line_without_a_display(self):
        ran = self.studio()
        self.assertEqual(ran.returncode, 2)
        self.assertEqual(ran.stderr.count("\n"), 1, ran.stderr)
        self.assertIn("replay.html", ran.stderr)
        self.assertEqual(ran.stdout, "")

    def test_has_a_help(self):
        ran = self.studio("--help")
        self.assertEqual(ran.returncode, 0)
        self.assertIn("FILE", ran.stdout)

    def test_refuses_a_file_that_does_not_exist(self):
        ran = self.studio("no_such_scenario.yaml")
        self.assertEqual(ran.returncode, 2)
        self.assertIn("no_such_scenario.yaml", ran.stderr)


if __name__ == "__main__":
    unittest.main()
