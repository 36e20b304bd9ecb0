"""The same scenario and seed give the same bytes in each run and each build type.

Usage: repeat_test.py PROGRAM DEBUG_FOLDER [Repeat | RepeatUnoptimised]
"""

import json
import pathlib
import re
import subprocess
import sys
import unittest

import program as support

PROGRAM = None
DEBUG_FOLDER = None
EXACT = ("summary.json", "can.log", "trace.csv")
DURATION = ("--duration", "7")  # boot, standing and the first half of a squat


class SquatRuns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.first = PROGRAM.run_scenario(support.SQUAT, cls.folder / "first", *DURATION)

    def assert_same(self, other):
        for name in EXACT:
            self.assertEqual((self.first / name).read_bytes(), (other / name).read_bytes(), name)


class Repeat(SquatRuns):
    def test_run_after_run(self):
        self.assert_same(PROGRAM.run_scenario(support.SQUAT, self.folder / "again", *DURATION))

    def test_another_seed_is_another_run(self):
        other = PROGRAM.run_scenario(support.SQUAT, self.folder / "seed", *DURATION, "--seed", "2")
        hashes = [json.loads((run / "summary.json").read_text())["state_hash"] for run in (self.first, other)]
        self.assertNotEqual(*hashes)

    def test_summary_tells_nothing_of_machine_or_day(self):
        text = (self.first / "summary.json").read_text()
        self.assertNotRegex(text, r"/|\d{4}-\d\d-\d\d|" + re.escape(pathlib.Path("/etc/hostname").read_text().strip()))


class RepeatUnoptimised(SquatRuns):
    def test_unoptimised_as_optimised(self):
        # Without debug information, which would take a third of the build time.
        flags = ("-DCMAKE_CXX_FLAGS_DEBUG=-D_GLIBCXX_ASSERTIONS", "-DCMAKE_UNITY_BUILD=ON")
        for command in (["cmake", "--preset", "debug", "-DBUILD_TESTING=OFF", *flags, "-B", DEBUG_FOLDER],
                        ["cmake", "--build", DEBUG_FOLDER, "--target", "bin/koboshi"]):
            result = subprocess.run(command, cwd=support.ROOT, capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stdout[-2000:] + result.stderr[-2000:])
        debug = support.Program(DEBUG_FOLDER / "bin" / "koboshi")
        self.assert_same(debug.run_scenario(support.SQUAT, self.folder / "debug", *DURATION))


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    DEBUG_FOLDER = pathlib.Path(sys.argv.pop(1))
    unittest.main()
