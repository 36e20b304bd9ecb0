"""Squats for 60 s with all models on, and the files of the run."""

import csv
import json
import unittest

import program as support

PROGRAM = None


class Squat(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_folder = PROGRAM.run_scenario(
            support.SQUAT, support.temporary_folder(cls) / "out", "--duration", "60")
        cls.summary = json.loads((cls.run_folder / "summary.json").read_text())

    def test_stays_on_its_feet_without_faults(self):
        self.assertFalse(self.summary["fell"])
        self.assertEqual(self.summary["duration_s"], 60.0)
        self.assertEqual(self.summary["faults"], 0)
        self.assertEqual(self.summary["solver_warnings"], 0)
        self.assertEqual(self.summary["stepper"], "lumped")

    def test_base_height_follows_the_pose(self):
        self.assertLess(self.summary["base_height_error_max_m"], 0.003)
        # Servos sag under load and lag a moving target, so a zero error would mean that nothing was measured.
        self.assertGreater(self.summary["base_height_error_max_m"], 0.0002)

    def test_feet_do_not_slip(self):
        self.assertLess(self.summary["foot_slip_max_m"], 0.001)

    def test_it_really_squats(self):
        with open(self.run_folder / "trace.csv", newline="") as file:
            heights = [float(row["true_base_z_m"]) for row in csv.DictReader(file) if float(row["time_s"]) > 6.0]
        self.assertGreater(max(heights) - min(heights), 0.028)
        middle = 0.5 * (max(heights) + min(heights))
        crossings = sum((a < middle) != (b < middle) for a, b in zip(heights, heights[1:]))
        self.assertAlmostEqual(crossings, 54, delta=1)  # two every two seconds

    def test_bus_is_half_full(self):
        self.assertGreater(self.summary["can_bus_load"], 0.46)
        self.assertLess(self.summary["can_bus_load"], 0.58)  # docs/design/timing.md: 56.4 %

    def test_leaves_its_files(self):
        names = sorted(file.name for file in self.run_folder.iterdir())
        self.assertEqual(names, ["body.png", "body.svg", "can.log", "events.txt", "legs.png", "legs.svg", "run.mcap",
                                 "summary.json", "timing.json", "trace.csv"])


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
