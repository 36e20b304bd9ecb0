"""Runs with a live view: what pages receive, their keys, and that they change nothing in the files of the run."""

import json
import pathlib
import re
import signal
import struct
import subprocess
import sys
import unittest
import urllib.error
import urllib.request

import program as support

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import web_socket

PROGRAM = None
TELEOP = support.ROOT / "scenarios" / "teleop.yaml"


def samples_of(message):
    """Counts the samples of batches (view/live/batch.h), with those that the page was too slow for."""
    count = 0
    while message:
        size, text_size, samples = struct.unpack("<3I", message[:12])
        text = message[size - text_size:size].strip()
        count += samples + (json.loads(text).get("lost", {}).get("samples", 0) if text else 0)
        message = message[size:]
    return count


class Live:
    """The program with --view, without a terminal."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([PROGRAM.path, *map(str, arguments), "--view"], cwd=support.ROOT, text=True,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        line = self.process.stdout.readline()
        found = re.fullmatch(r"live view on (http://127\.0\.0\.1:\d+/[0-9a-f]{32}/)\n", line)
        if not found:
            raise AssertionError(f"found {line!r} and {self.process.communicate()[1]!r}")
        self.address = found[1]

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()

    def end(self, number=None):
        if number is not None:
            self.process.send_signal(number)
        out, errors = self.process.communicate(timeout=120)
        return self.process.returncode, out, errors


class LiveView(unittest.TestCase):
    def setUp(self):
        self.folder = support.temporary_folder(type(self))

    def start(self, *arguments):
        live = Live(*arguments)
        self.addCleanup(live.close)
        return live

    def open(self, live, **options):
        page = web_socket.WebSocket(live.address, **options)
        self.addCleanup(page.close)
        return page

    def wait_for_note(self, page, pattern):
        while not re.search(pattern, page.next_text_with("note")):
            pass

    def assert_same_files(self, one, other, names):
        for name in names:
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)

    def test_changes_nothing_in_the_run(self):
        arguments = ("--duration", "3", "--stepper", "lumped")
        alone = PROGRAM.run_scenario(support.SQUAT, self.folder / "alone", *arguments)
        live = self.start("run", support.SQUAT, "--out", self.folder / "seen", *arguments, "--speed", "2")
        asleep = self.open(live, receive_buffer=4096)  # reads nothing
        page = self.open(live)
        gone = self.open(live)
        gone.close()
        page.next()
        page.next()  # the head
        samples = 0  # that arrived or are known to be lost
        while (message := page.next()) is not None:
            samples += samples_of(message) if isinstance(message, bytes) else 0
        status, out, errors = live.end()
        self.assertEqual(status, 0, errors)
        self.assertIn("done after 3.00 s", out)
        self.assertEqual(samples, 300)
        timing = json.loads((self.folder / "seen" / "timing.json").read_text())
        self.assertEqual((timing["records_dropped"], timing["recording_dropped"]), (0, 0))
        self.assert_same_files(alone, self.folder / "seen", ("can.log", "trace.csv", "events.txt", "run.mcap", "summary.json"))

    def test_keys_drive_the_robot_without_a_terminal(self):
        live = self.start("run", TELEOP, "--out", self.folder / "run", "--duration", "20", "--speed", "4", "--record", "no")
        page = self.open(live)
        control = json.loads(page.next())
        self.assertEqual(control["refusal"], "")
        self.assertIn({"keys": ["ArrowUp", "w"], "name": "forward"}, control["keys"])
        page.press("n")
        self.wait_for_note(page, "^key enable: enable the drives")
        page.press("+")
        self.wait_for_note(page, r"^key push more: the next push has 0\.25 N s")
        page.press("p")
        page.press("ArrowUp")
        self.wait_for_note(page, r"^key forward: push forward with 0\.25 N s")
        page.press("q")
        self.assertTrue(page.next_text_with("end"))
        status, out, errors = live.end()
        self.assertEqual(status, 0, errors)
        self.assertNotIn("\x1b", out)
        self.assertIn(" 201#010000", (self.folder / "run" / "can.log").read_text())
        self.assertFalse((self.folder / "run" / "run.mcap").exists())
        again = PROGRAM.run_scenario(self.folder / "run" / "played.yaml", self.folder / "again")
        self.assert_same_files(self.folder / "run", again, ("can.log", "trace.csv"))

    def test_keys_are_refused_with_a_reason(self):
        for arguments, scenario, reason in (
                (("--real-bus",), TELEOP, None),
                (("--real-bus", "--set", "teleop=false"), TELEOP, "Keys are refused: this run is on a real bus (--real-bus)."),
                ((), support.SQUAT, "This run takes no keys: --set teleop=true lets a page drive.")):
            out = self.folder / "refused"
            if reason is None:  # neither terminal nor page could drive
                result = PROGRAM.run("run", scenario, "--out", out, "--view", *arguments)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, r"^.*teleop\.yaml: found .*no terminal.*, expected .*\n$")
                continue
            live = self.start("run", scenario, "--out", out, "--stepper", "lumped", *arguments)
            page = self.open(live)
            self.assertEqual(json.loads(page.next())["refusal"], reason)
            page.press("g")
            self.assertEqual(page.next_text_with("refused"), reason)
            status, _, errors = live.end(signal.SIGINT)
            self.assertEqual(status, 0, errors)
            self.assertTrue((out / "summary.json").is_file())

    def test_refuses_strangers(self):
        live = self.start("board", "--duration", "60")
        host, port, path = web_socket.split(live.address)

        def status(url, **fields):
            try:
                with urllib.request.urlopen(urllib.request.Request(url, headers=fields), timeout=20) as answer:
                    return answer.status
            except urllib.error.HTTPError as error:
                return error.code

        self.assertEqual(status(live.address), 200)
        self.assertEqual(status(f"http://{host}:{port}/"), 404)
        self.assertEqual(status(f"http://{host}:{port}/{'0' * 32}/"), 404)
        self.assertEqual(status(live.address, Host="rebound.example"), 403)
        self.assertEqual(status(live.address, Origin="http://evil.example"), 403)
        with self.assertRaisesRegex(web_socket.Refused, "403"):
            web_socket.WebSocket(live.address, origin="http://evil.example")
        with self.assertRaisesRegex(web_socket.Refused, "403"):
            web_socket.WebSocket(live.address, host="rebound.example")
        with self.assertRaisesRegex(web_socket.Refused, "404"):
            web_socket.WebSocket(f"http://{host}:{port}/{'0' * 32}/")
        taken = PROGRAM.run("board", "--view", "--view-port", port)
        self.assertEqual((taken.returncode, taken.stderr),
                         (2, f"koboshi: found port {port} of 127.0.0.1 (Address already in use), expected a free port\n"))
        self.assertEqual(live.end(signal.SIGINT)[0], 0)

    def test_shows_a_board_without_controller(self):
        live = self.start("board", "--duration", "60")
        page = self.open(live)
        control = json.loads(page.next())
        self.assertEqual(control["keys"], [])
        hello = page.next()
        size = int.from_bytes(hello[:4], "little")
        run = json.loads(hello[4:4 + size])["run"]
        self.assertEqual((run["title"], run["scene"]["robot"]), ("board", "koboshi"))
        self.assertIn("left_knee_true", [signal_["name"] for signal_ in run["signals"]])
        while len(message := page.next()) < 64:
            self.assertIsInstance(message, bytes)
        status, out, errors = live.end(signal.SIGINT)
        self.assertEqual(status, 0, errors)
        self.assertRegex(out, r"^\d+\.\d\d s, \d+ frames, bus load \d+ %\n$")


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
