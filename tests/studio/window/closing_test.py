"""closing_test.py STUDIO: the program with real keys under a window manager: saving, the question at closing, and SIGTERM."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
WITH_DISPLAY = ROOT / "tests/support/with_display.sh"
INSIDE = "KOBOSHI_TEST_INSIDE_DISPLAY"
STUDIO = pathlib.Path(sys.argv[-1])
PATIENCE_S = 60.0


def xdotool(*arguments):
    return subprocess.run(["xdotool", *arguments], capture_output=True, text=True, check=False).stdout


def wait_for(condition, patience_s=PATIENCE_S):
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


class Closing(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.motion = pathlib.Path(folder.name) / "squat.yaml"
        shutil.copy(ROOT / "robots/koboshi/motions/squat.yaml", self.motion)
        self.before = self.motion.read_text()
        self.studio = subprocess.Popen([STUDIO, self.motion], cwd=ROOT)
        self.addCleanup(self.end)
        self.assertTrue(wait_for(lambda: self.title().startswith("squat.yaml -")), self.title())

    def end(self):
        if self.studio.poll() is None:
            self.studio.kill()
        self.studio.wait()

    @staticmethod
    def title():
        return xdotool("getactivewindow", "getwindowname").strip()

    def press(self, *keys):
        xdotool("key", *keys)

    def recoveries(self):
        state = pathlib.Path(os.environ["XDG_STATE_HOME"])
        return [text for text in (path.read_text() for path in state.rglob("*.recovery")) if str(self.motion) in text]

    # The first key of a window. The window manager names a window the active one a moment before the keyboard is the window's,
    # and a key between the two is nobody's: it is pressed until the window has taken it.
    def edit(self):
        def edited():
            self.press("Insert")
            return wait_for(lambda: self.title().startswith("squat.yaml*"), 2.0)

        self.assertTrue(wait_for(edited), self.title())

    def ask(self):
        self.press("ctrl+q")
        self.assertTrue(wait_for(lambda: self.title() == "Koboshi Studio"), self.title())

    def test_asks_until_the_work_is_saved(self):
        self.edit()
        self.ask()
        self.press("ctrl+q", "ctrl+q")
        time.sleep(0.2)
        self.assertIsNone(self.studio.poll())
        self.assertEqual(self.motion.read_text(), self.before)
        self.press("Escape")
        self.assertTrue(wait_for(lambda: self.title().startswith("squat.yaml*")), self.title())
        self.ask()
        self.press("Return")
        self.assertEqual(self.studio.wait(PATIENCE_S), 0)
        self.assertNotEqual(self.motion.read_text(), self.before)
        self.assertEqual(self.recoveries(), [])

    def test_keeps_the_work_when_it_is_terminated(self):
        self.edit()
        self.studio.send_signal(signal.SIGTERM)
        self.assertEqual(self.studio.wait(PATIENCE_S), 128 + signal.SIGTERM)
        self.assertEqual(self.motion.read_text(), self.before)
        self.assertEqual(len(self.recoveries()), 1)


if __name__ == "__main__":
    if INSIDE not in os.environ:
        command = [WITH_DISPLAY, "/usr/bin/python3", "-B", *sys.argv]
        sys.exit(subprocess.run(command, env=os.environ | {INSIDE: "1", "KOBOSHI_WINDOW_MANAGER": "1"}, check=False).returncode)
    unittest.main(argv=sys.argv[:1])
