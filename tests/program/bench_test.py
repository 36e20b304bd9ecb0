"""Output and errors of `koboshi bench`. The figures depend on the machine and are not checked."""

import json
import unittest

import program as support

PROGRAM = None
ARGUMENTS = ["--steppers", "world,lumped", "--duration", "5", "--reference-step-ms", "0.5"]


class Bench(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.result = PROGRAM.run("bench", *ARGUMENTS, "--json", cls.folder / "bench.json")
        cls.bench = json.loads((cls.folder / "bench.json").read_text())

    def test_prints_a_table_of_what_it_writes(self):
        self.assertEqual(self.result.returncode, 0)
        for name in self.bench["steppers"]:
            self.assertIn(name, self.result.stdout)

    def test_top_level_is_the_fastest_accurate_ode_stepper(self):
        steppers = self.bench["steppers"]
        self.assertEqual(list(steppers), ["world", "lumped"])
        fastest = max(steppers, key=lambda name: steppers[name]["closed_loop_real_time_factor"])
        self.assertEqual(self.bench["stepper"], fastest)
        for key, value in steppers[fastest].items():
            self.assertEqual(self.bench[key], value, key)

    def test_both_hold_the_accuracy(self):
        for name, stepper in self.bench["steppers"].items():
            with self.subTest(name):
                self.assertLess(stepper["squat_base_height_rms_m"], 2e-4)
                self.assertGreater(stepper["squat_base_height_rms_m"], 0.0)
                self.assertLess(stepper["squat_foot_slip_m"], 1e-3)
                self.assertFalse(stepper["walk_fell"] or stepper["squat_fell"])
                self.assertTrue(stepper["accurate"])

    def test_the_physics_of_each_posture_has_a_figure(self):
        for name, stepper in self.bench["steppers"].items():
            with self.subTest(name):
                figures = [stepper["physics_steps_per_s" + posture] for posture in ("", "_standing", "_lying")]
                self.assertGreater(min(figures), 0.0)
                self.assertEqual(len(set(figures)), 3)
                self.assertIsNone(stepper["physics_speed_vs_mujoco_lying"])  # MuJoCo was not asked for

    def test_shares_are_of_the_whole(self):
        for name, stepper in self.bench["steppers"].items():
            with self.subTest(name):
                self.assertAlmostEqual(sum(stepper["shares"].values()), 1.0)

    def test_a_world_fits_into_15_megabytes(self):
        for name, stepper in self.bench["steppers"].items():
            with self.subTest(name):
                self.assertGreater(stepper["memory_bytes_per_world"], 1e5)
                self.assertLess(stepper["memory_bytes_per_world"], 15e6)


class Refusals(unittest.TestCase):
    def test_unknown_stepper(self):
        result = PROGRAM.run("bench", "--steppers", "fast")
        self.assertEqual(result.returncode, 2)
        self.assertIn("fast", result.stderr)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
