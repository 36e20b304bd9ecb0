"""The same firmware in both engines: short version of docs/experiment/second-engine.md."""

import csv
import json
import pathlib
import unittest

import program as support

PROGRAM = None
FOLDER = support.ROOT / "docs" / "experiment" / "second-engine"


class SecondEngine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def play(self, scenario, stepper, *arguments):
        out = self.folder / f"{pathlib.Path(scenario).stem}-{stepper}"
        PROGRAM.run_scenario(scenario, out, "--stepper", stepper, *arguments)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["stepper"], stepper)
        self.assertEqual(summary["solver_warnings"], 0)
        self.assertEqual(summary["faults"], 0)
        with open(out / "trace.csv", newline="") as file:
            return summary, list(csv.DictReader(file))

    def play_in_both(self, scenario, *arguments):
        return self.play(scenario, "world", *arguments), self.play(scenario, "mujoco", *arguments)

    def assert_follow(self, ours, theirs, column, until_s, most):
        """Checks that the columns of both traces agree to `most` but are not identical, which would indicate a single engine."""
        differences = [abs(float(a[column]) - float(b[column])) for a, b in zip(ours, theirs) if float(a["time_s"]) < until_s]
        self.assertLess(max(differences), most, column)
        self.assertGreater(max(differences), 0.0, column)

    def test_squats_alike(self):
        (world, ours), (mujoco, theirs) = self.play_in_both(support.SQUAT, "--duration", "8")
        self.assertFalse(world["fell"] or mujoco["fell"])
        self.assertLess(mujoco["foot_slip_max_m"], 1e-4)
        self.assert_follow(ours, theirs, "true_base_z_m", 8.0, 1e-4)

    def test_walks_in_the_second_too(self):
        summary, _ = self.play(support.WALK, "mujoco")
        self.assertFalse(summary["fell"])
        self.assertEqual(summary["duration_s"], 20.0)
        self.assertGreater(summary["speed_m_per_s"], 0.15)
        self.assertLess(summary["foot_slip_max_m"], 0.02)
        self.assertLess(summary["zmp_sensor_vs_truth_rms_m"], 0.0015)

    def test_sways_alike_after_a_push(self):
        (world, ours), (mujoco, theirs) = self.play_in_both(FOLDER / "push.yaml")
        self.assertFalse(world["fell"] or mujoco["fell"])
        self.assertGreater(max(float(row["true_pitch_rad"]) for row in theirs if float(row["time_s"]) > 5.0), 0.03)
        self.assert_follow(ours, theirs, "true_pitch_rad", 8.0, 0.005)

    def test_falls_alike(self):
        (world, ours), (mujoco, theirs) = self.play_in_both(FOLDER / "fall.yaml")
        self.assertTrue(world["fell"] and mujoco["fell"])
        self.assert_follow(ours, theirs, "true_pitch_rad", 5.25, 0.03)  # until the hands touch the ground


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
