"""Drives scenarios/teleop.yaml by keys through a pseudo-terminal. Waits for the text on the screen, not for a time."""

import fcntl
import json
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time
import unittest

import program as support

PROGRAM = None
TELEOP = support.ROOT / "scenarios" / "teleop.yaml"
PATIENCE_S = 240.0  # limit of each wait; a run is real-time only on a fast machine
UP, DOWN, LEFT = "\x1b[A", "\x1b[B", "\x1b[D"
# A drawing begins at the first row and ends with the sequence that clears the rows below it.
DRAWING = re.compile(r"\x1b\[1;1H((?:(?!\x1b\[1;1H).)*)\x1b\[J", re.DOTALL)


class Operator:
    """An operator at a pseudo-terminal that runs the program."""

    def __init__(self, out):
        self.master, self.slave = pty.openpty()
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self.before = termios.tcgetattr(self.slave)
        self.text = ""
        command = [PROGRAM.path, "run", TELEOP, "--realtime", "--out", out]
        self.process = subprocess.Popen(command, cwd=support.ROOT, stdin=self.slave, stdout=self.slave, stderr=self.slave,
                                        start_new_session=True,  # Ctrl-C must reach the program
                                        preexec_fn=lambda: fcntl.ioctl(self.slave, termios.TIOCSCTTY, 0))

    def press(self, keys):
        os.write(self.master, keys.encode())

    def look(self):
        """Returns the lines of the last drawing without control sequences; keeps reading for a moment."""
        if select.select([self.master], [], [], 0.1)[0]:
            self.text += os.read(self.master, 65536).decode(errors="replace")
        drawings = DRAWING.findall(self.text)
        screen = re.sub(r"\x1b\[\d+;1H", "\n", drawings[-1]).replace("\x1b[K", "") if drawings else ""
        return re.sub(r"(?m) *[|+][-|+ .ox<>v^\w]{17}[|+]$", "", screen)  # without the map

    def wait_for(self, pattern):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            found = re.search(pattern, self.look(), re.MULTILINE)
            if found:
                return found
            if self.process.poll() is not None:
                break
        raise AssertionError(f"never saw {pattern}, but {self.text[-3000:]!r}")

    def wait_for_end(self):
        """Waits for the program and returns its exit status."""
        end = time.monotonic() + PATIENCE_S
        while self.process.poll() is None and time.monotonic() < end:
            self.look()
        self.look()
        return self.process.poll()

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        os.close(self.master)
        os.close(self.slave)


class Teleop(unittest.TestCase):
    def setUp(self):
        self.out = support.temporary_folder(type(self)) / self.id().rsplit(".", 1)[-1]
        self.operator = Operator(self.out)
        self.addCleanup(self.operator.close)

    def assert_ended_well(self, verdict):
        self.assertEqual(self.operator.wait_for_end(), 0, self.operator.text[-3000:])
        self.assertEqual(termios.tcgetattr(self.operator.slave), self.operator.before)
        tail = self.operator.text[self.operator.text.rindex("\x1b[?1049l"):]  # the previous screen is restored
        self.assertIn("\x1b[?25h", self.operator.text)
        self.assertRegex(tail, r"(?m)^done after .*\r\n^results in .*\r\n(^koboshi: .*\r\n)?^" + verdict + r"; 0 faults\r\n\Z")

    def assert_repeats(self):
        """Repeats the run without an operator, from the recorded commands, and compares the results."""
        again = PROGRAM.run_scenario(self.out / "played.yaml", self.out.parent / "again")
        hashes = [json.loads((run / "summary.json").read_text())["state_hash"] for run in (self.out, again)]
        self.assertEqual(*hashes)

    def test_walks_ahead_stops_and_gets_up(self):
        operator = self.operator
        operator.wait_for(r"^state +boot|^state +limp")
        self.assertFalse(termios.tcgetattr(operator.slave)[3] & termios.ECHO)
        operator.wait_for(r"^state +standing, by progress\n(.*\n)*load(?!.*held)")
        operator.press(UP * 4)
        operator.wait_for(r"^state +walking, by command\ncommanded +ahead \+0\.08 m/s, left \+0\.00 m/s")
        operator.wait_for(r"^measured +ahead \+0\.(0[5-9]|1\d) m/s")
        operator.press(DOWN)
        operator.wait_for(r"^commanded +ahead \+0\.06 m/s")
        operator.press(" ")
        operator.wait_for(r"^state +standing, by .*\ncommanded +ahead \+0\.00 m/s")
        operator.press("--p")
        operator.wait_for(r"^push +0\.10 N s, where to\?")
        operator.press(LEFT)
        operator.wait_for(r"^push +0\.10 N s\nlast key +turn left: push to the left with 0\.10 N s")
        operator.press("n")
        operator.wait_for(r"^command +enable: refused, not in this state \(standing\)")
        operator.press("+" * 22 + "p" + UP)
        operator.wait_for(r"^state +LIES; (?!standing)")
        # The simulated time of each key depends on the machine's load, so the state at the push and the number of falls
        # vary.
        operator.wait_for(r"^state +standing, by progress\n(.*\n)*load.*, \d+ falls?\n")
        operator.press("q")
        self.assert_ended_well(r"stands; fell (once|\d+ times, first) at .* s and (finally )?got up.* in .* s.*; 1 command refused")
        log = (self.out / "can.log").read_text()
        self.assertIn(" 301#500000000000", log)  # 80 mm/s forward, commanded on the bus
        self.assertRegex(log, r" 301#3C0000000000\n(.*\n)*.* 201#040000")
        self.assert_repeats()

    def test_ctrl_c_gives_the_terminal_back(self):
        operator = self.operator
        operator.wait_for(r"^state +limp")
        operator.press("e")
        operator.wait_for(r"^state +emergency stop, by command")
        operator.press("\x03")
        self.assert_ended_well("hangs on its stand, emergency stop; did not fall")


class WithoutATerminal(unittest.TestCase):
    def setUp(self):
        self.out = support.temporary_folder(type(self)) / "out"

    def test_is_refused_in_one_line(self):
        result = PROGRAM.run("run", TELEOP, "--realtime", "--out", self.out)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"^.*teleop\.yaml: found .*no terminal.*, expected .*\n$")
        self.assertFalse(self.out.exists())

    def test_the_scenario_runs_by_itself(self):
        out = PROGRAM.run_scenario(TELEOP, self.out, "--set", "teleop=false", "--duration", "0.1")
        self.assertTrue((out / "can.log").is_file())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
