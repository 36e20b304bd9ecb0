"""The same scenario and seed give the same bytes in each run. Those of an unoptimised build: proof.outside_folder.

Usage: repeat_test.py PROGRAM
"""

import json
import pathlib
import re
import unittest

import program as support

PROGRAM = None
EXACT = ("summary.json", "can.log", "trace.csv")
DURATION = ("--duration", "7")  # boot, standing and the first half of a squat


class Repeat(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.first = PROGRAM.run_scenario(support.SQUAT, cls.folder / "first", *DURATION)

    def test_run_after_run(self):
        again = PROGRAM.run_scenario(support.SQUAT, self.folder / "again", *DURATION)
        for name in EXACT:
            self.assertEqual((self.first / name).read_bytes(), (again / name).read_bytes(), name)

    def test_another_seed_is_another_run(self):
        other = PROGRAM.run_scenario(support.SQUAT, self.folder / "seed", *DURATION, "--seed", "2")
        hashes = [json.loads((run / "summary.json").read_text())["state_hash"] for run in (self.first, other)]
        self.assertNotEqual(*hashes)

    def test_summary_tells_nothing_of_machine_or_day(self):
        text = (self.first / "summary.json").read_text()
        self.assertNotRegex(text, r"/|\d{4}-\d\d-\d\d|" + re.escape(pathlib.Path("/etc/hostname").read_text().strip()))


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
