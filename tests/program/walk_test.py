"""The walk of scenarios/walk.yaml on the level floor without noise, and the gait command that makes its motion."""

import csv
import json
import unittest

import program as support

PROGRAM = None


class Walk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_folder = PROGRAM.run_scenario(support.WALK, support.temporary_folder(cls) / "out", "--set", "noise=false")
        cls.summary = json.loads((cls.run_folder / "summary.json").read_text())

    def test_stays_on_its_feet_without_faults(self):
        self.assertFalse(self.summary["fell"])
        self.assertEqual(self.summary["duration_s"], 20.0)
        self.assertEqual(self.summary["faults"], 0)
        self.assertEqual(self.summary["solver_warnings"], 0)

    def test_asks_no_drive_for_more_than_its_limits(self):
        self.assertEqual(support.limited_statuswords(self.run_folder), 0)

    def test_is_fast_and_straight(self):
        self.assertGreater(self.summary["speed_m_per_s"], 0.15)
        self.assertLess(abs(self.summary["lateral_drift_m"]), 0.1 * self.summary["distance_m"])

    def test_steps_instead_of_sliding(self):
        """Each foot lifts off in each of its steps, and the soles do not push the robot along."""
        with open(self.run_folder / "trace.csv", newline="") as file:
            walking = [row for row in csv.DictReader(file) if 6.0 < float(row["time_s"]) < 18.0]
        self.assertLess(self.summary["foot_slip_max_m"], 0.02)
        for side in ("left", "right"):
            loads = [float(row[f"true_{side}_load_N"]) for row in walking]
            lifts = sum(a > 0.0 >= b for a, b in zip(loads, loads[1:]))
            self.assertGreaterEqual(lifts, 12.0 / 0.6, side)  # no gait of this robot has a longer cycle

    def test_ankle_sensors_tell_where_the_ground_pushes(self):
        error = self.summary["zmp_sensor_vs_truth_rms_m"]
        self.assertLess(error, 0.001)
        self.assertGreater(error, 1e-6)  # zero would mean that the true value was compared with itself

    def test_zmp_follows_its_plan(self):
        self.assertLess(self.summary["zmp_rms_error_m"], 0.04)
        self.assertGreater(self.summary["zmp_margin_p05_m"], -1e-9)  # the true ZMP cannot leave the feet

    def test_leaves_its_files(self):
        names = sorted(file.name for file in self.run_folder.iterdir())
        figures = [f"{name}.{kind}" for name in ("attitude", "body", "joints", "legs", "zmp") for kind in ("png", "svg")]
        self.assertEqual(names, sorted(figures + ["can.log", "events.txt", "run.mcap", "summary.json", "timing.json", "trace.csv"]))
        for figure in figures:
            self.assertGreater((self.run_folder / figure).stat().st_size, 5000, figure)


class Gait(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def make(self, name, *arguments):
        out = self.folder / name
        result = PROGRAM.run("gait", "robots/koboshi/gait.yaml", "--out", out, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return out

    def test_writes_a_motion_that_compiles_its_profile_and_a_figure(self):
        for points in ("4", "8", "16", "10"):
            out = self.make(f"walk_{points}", "--points", points, "--set", "period_s=0.8")
            self.assertEqual({file.suffix for file in self.folder.glob(out.name + ".*")},
                             {".yaml", ".csv", ".png", ".svg"})
            compiled = PROGRAM.run("motion", "compile", f"{out}.yaml", "--out", f"{out}.kmot")
            self.assertEqual(compiled.returncode, 0, compiled.stderr)

    def test_says_where_a_walk_is_impossible(self):
        result = PROGRAM.run("gait", "robots/koboshi/gait.yaml", "--out", self.folder / "no", "--set", "com_height_m=0.4")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(list(self.folder.glob("no*")), [])


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
