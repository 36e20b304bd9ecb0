"""Tests the command `koboshi studio`."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
KOBOSHI, STUDIO = sys.argv.pop(1), sys.argv.pop(1)
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

    def test_opens_a_window_and_ends_on_sigterm(self):
        with tempfile.TemporaryDirectory() as folder:
            environment = NO_DISPLAY | {"XDG_CONFIG_HOME": folder, "XDG_RUNTIME_DIR": folder, "LIBGL_ALWAYS_SOFTWARE": "1"}
            command = [str(ROOT / "tests/support/with_display.sh"), KOBOSHI, "studio", "scenarios/walk.yaml"]
            with subprocess.Popen(command, cwd=ROOT, env=environment, stderr=subprocess.PIPE, text=True,
                                  start_new_session=True) as process:
                time.sleep(3)
                self.assertIsNone(process.poll(), "the studio ended by itself")
                subprocess.run(["pkill", "-TERM", "-g", str(process.pid), "-f", "koboshi-studio"], check=False)
                process.wait(timeout=30)


if __name__ == "__main__":
    unittest.main()
