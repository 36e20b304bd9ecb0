"""The walk of scenarios/terrain.yaml over a smooth patch, a mat and rough ground."""

import csv
import json
import statistics
import unittest

import program as support

PROGRAM = None
TERRAIN = support.ROOT / "scenarios" / "terrain.yaml"
SIDES = ("left", "right")


class Terrain(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run_folder = PROGRAM.run_scenario(TERRAIN, support.temporary_folder(cls) / "out")
        cls.summary = json.loads((run_folder / "summary.json").read_text())
        cls.limited = support.limited_statuswords(run_folder)
        with open(run_folder / "trace.csv", newline="") as file:
            cls.walking = [row for row in csv.DictReader(file) if float(row["time_s"]) > 4.5]

    def between(self, start_m, end_m):
        """Returns the ticks in which both soles are within this range of x."""
        rows = [row for row in self.walking
                if all(start_m < float(row[f"true_{side}_sole_x_m"]) < end_m for side in SIDES)]
        self.assertGreater(len(rows), 50)
        return rows

    def slip_m(self, rows):
        """Returns the median over ticks and soles: the largest value is that of a single step."""
        return statistics.median(float(row[f"true_{side}_slip_m"]) for row in rows for side in SIDES)

    def height_m(self, rows):
        return sum(float(row["true_base_z_m"]) for row in rows) / len(rows)

    def test_crosses_it_all_without_a_fall(self):
        self.assertFalse(self.summary["fell"])
        self.assertEqual(self.summary["faults"], 0)
        self.assertEqual(self.summary["solver_warnings"], 0)
        self.assertEqual(self.limited, 0)
        self.assertGreater(max(float(row["true_base_x_m"]) for row in self.walking), 1.5)

    def test_walks_on_top_of_the_mat(self):
        rise_m = self.height_m(self.between(0.87, 1.13)) - self.height_m(self.between(0.02, 0.25))
        self.assertGreater(rise_m, 0.0015)
        self.assertLess(rise_m, 0.0025)

    def test_slides_farther_on_the_patch(self):
        self.assertGreater(self.slip_m(self.between(0.33, 0.57)), 2 * self.slip_m(self.between(0.87, 1.13)))


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
