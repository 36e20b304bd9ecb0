"""Files of a run: complete rows however the run ends, summary.json written last, one run per folder, and an error where a
file cannot be written."""

import csv
import resource
import shutil
import signal
import subprocess
import time
import unittest

import program as support

PROGRAM = None
LONG = ("--duration", "3600")


def start(*arguments):
    command = [PROGRAM.path, "run", support.SQUAT, *map(str, arguments)]
    return subprocess.Popen(command, cwd=support.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for_rows(file):
    end = time.monotonic() + 60.0
    while not (file.is_file() and file.stat().st_size > 0):
        if time.monotonic() > end:
            raise AssertionError(f"no rows in {file}")
        time.sleep(0.02)


def on_a_small_disk():
    resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))


class Files(unittest.TestCase):
    def setUp(self):
        self.out = support.temporary_folder(type(self)) / self.id().rsplit(".", 1)[-1]

    def assert_whole_rows(self):
        for name in ("trace.csv", "can.log"):
            self.assertTrue((self.out / name).read_bytes().endswith(b"\n"), name)
        with open(self.out / "trace.csv", newline="") as file:
            rows = list(csv.reader(file))
        self.assertGreater(len(rows), 10)
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})

    def test_a_scenario_of_this_folder_needs_no_folder(self):
        result = PROGRAM.run("run", "squat.yaml", "--duration", "0.1", "--out", self.out, cwd=support.SQUAT.parent)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.out / "summary.json").is_file())

    def test_a_full_disk_is_an_error(self):
        command = [PROGRAM.path, "run", support.SQUAT, "--duration", "5", "--out", self.out]
        result = subprocess.run(command, cwd=support.ROOT, capture_output=True, text=True, check=False,
                                preexec_fn=on_a_small_disk)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"^koboshi: cannot write .*/(can\.log|trace\.csv|run\.mcap): File too large\n$")
        self.assertFalse((self.out / "summary.json").exists())
        self.assert_whole_rows()
        PROGRAM.run_scenario(support.SQUAT, self.out, "--duration", "0.1")  # the folder is reusable
        self.assertTrue((self.out / "summary.json").is_file())

    def test_standard_output_may_be_full_as_well(self):
        with open("/dev/full", "w", encoding="ascii") as full:
            result = subprocess.run([PROGRAM.path, "dictionary", "--help"], stdout=full, stderr=subprocess.PIPE, text=True,
                                    check=False)
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr, "koboshi: cannot write standard output: No space left on device\n")

    def test_a_device_as_file_is_written_directly(self):
        motion = support.ROOT / "robots/koboshi/motions/squat.yaml"
        result = PROGRAM.run("motion", "compile", motion, "-o", "/dev/full")
        self.assertEqual((result.returncode, result.stderr), (2, "koboshi: cannot write /dev/full: No space left on device\n"))

    def test_an_interrupted_run_closes_its_files(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(number):
                shutil.rmtree(self.out, ignore_errors=True)
                process = start("--out", self.out, *LONG)
                wait_for_rows(self.out / "trace.csv")
                process.send_signal(number)
                _, said = process.communicate(timeout=60)
                self.assertEqual(process.returncode, status, said)
                self.assertRegex(said, r"^koboshi: interrupted at \d+\.\d\d s of 3600\.00 s; .*\n$")
                self.assertFalse((self.out / "summary.json").exists())
                self.assert_whole_rows()

    def test_a_folder_is_of_one_run(self):
        first = start("--out", self.out, *LONG)
        self.addCleanup(first.communicate)
        self.addCleanup(first.kill)
        wait_for_rows(self.out / "trace.csv")
        second = PROGRAM.run("run", support.SQUAT, "--duration", "0.1", "--out", self.out)
        self.assertEqual(second.returncode, 2)
        self.assertRegex(second.stderr, rf"^{self.out}: found a folder to which another run is writing, expected .*\n$")
        self.assertIsNone(first.poll())

    def test_an_earlier_run_does_not_mix_with_a_new_one(self):
        self.out.mkdir()
        for name in ("trace.csv", "can.log", "summary.json", "played.yaml", "zmp.png", "walk.csv"):
            shutil.copy(support.SQUAT, self.out / name)
        PROGRAM.run_scenario(support.SQUAT, self.out, "--duration", "0.1")
        names = {file.name for file in self.out.iterdir()}
        self.assertFalse(names & {"played.yaml", "zmp.png", "walk.csv"}, names)
        self.assertNotEqual((self.out / "trace.csv").read_text(), support.SQUAT.read_text())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
