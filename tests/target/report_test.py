"""Checks the format, the sums and the repeatability of `koboshi target-report`, and the limits on the firmware's instructions.

Usage: report_test.py PROGRAM IMAGE
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, IMAGE = sys.argv[1:3]
PARTS = ["sensors", "estimation", "behaviour", "interpreter", "canopen", "drives", "rest"]


def report(*arguments):
    """Returns the JSON of a report."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "report.json")
        subprocess.run([PROGRAM, "target-report", "--image", IMAGE, "--json", file, *arguments], check=True, capture_output=True)
        return file.read_text()


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = report()
        cls.figures = json.loads(cls.text)

    def test_covers_twenty_seconds(self):
        self.assertEqual(self.figures["ticks"], 2000)
        self.assertGreater(self.figures["while_moving"]["ticks"], 1000)

    def test_keeps_the_budget_while_moving(self):
        moving = self.figures["while_moving"]
        self.assertLessEqual(moving["mean"], 60_000)
        self.assertLessEqual(moving["max"], 100_000)
        self.assertGreater(moving["mean"], 1_000)  # fewer would mean that not all were counted

    def test_has_parts_that_make_up_the_whole(self):
        parts = self.figures["by_part"]
        self.assertEqual(list(parts), PARTS)
        self.assertAlmostEqual(sum(part["mean"] for part in parts.values()), self.figures["instructions_per_tick_mean"], places=6)
        self.assertLess(parts["rest"]["max"], 100)  # ten times the cost of reading the timer
        for part in parts.values():
            self.assertGreater(part["mean"], 0)
            self.assertLessEqual(part["p99"], part["max"])

    def test_has_the_same_parts_while_moving(self):
        moving = self.figures["while_moving"]
        parts = moving["by_part"]
        self.assertEqual(list(parts), PARTS[:-1])
        self.assertLessEqual(sum(part["mean"] for part in parts.values()), moving["mean"])
        self.assertGreater(parts["behaviour"]["mean"], self.figures["by_part"]["behaviour"]["mean"])
        self.assertLess(parts["interpreter"]["max"], self.figures["by_part"]["interpreter"]["max"])  # the boot checks motions

    def test_finds_the_stack_within_its_bound(self):
        self.assertLessEqual(self.figures["stack_peak_bytes"], self.figures["by_entry_point"]["reset_handler"]["stack_bytes"])
        self.assertGreater(self.figures["stack_peak_bytes"], self.figures["stack_bytes"] / 2)

    def test_keeps_flash_and_ram_small(self):
        self.assertLessEqual(self.figures["flash_bytes"], 256 * 1024)
        self.assertLessEqual(self.figures["ram_bytes"], 64 * 1024)
        self.assertLessEqual(self.figures["stack_bytes"], 4 * 1024)
        for key in ("flash_bytes", "ram_bytes"):
            self.assertEqual(sum(folder[key] for folder in self.figures["by_folder"].values()), self.figures[key])

    def test_repeats_to_the_instruction_and_writes_its_page(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "target.md")
            self.assertEqual(report("--page", page), self.text)
            self.assertIn("| while moving ", page.read_text())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
