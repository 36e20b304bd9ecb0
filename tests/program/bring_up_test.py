"""koboshi bring-up: a robot that nobody has tuned stands, squats and walks, and the files say how."""

import pathlib
import shutil
import tempfile
import unittest

import program as support
import robot_sizes_test as sizes

PROGRAM = None


class BringUp(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_bring_up_")
        self.addCleanup(folder.cleanup)
        self.robot = pathlib.Path(folder.name, "kit")
        self.robot.mkdir()
        by = sizes.Scale(0.55, 3.2)
        (self.robot / "robot.sdf").write_text(sizes.scaled_robot((sizes.ROBOT / "robot.sdf").read_text(), by))
        shutil.copytree(sizes.ROBOT / "meshes", self.robot / "meshes")

    def climb(self, *arguments):
        return PROGRAM.run("bring-up", self.robot, "--seeds", 1, "--budget", 0, *arguments)

    def test_leads_from_a_model_to_a_robot_that_walks(self):
        result = self.climb("--until", "walks forward")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        for rung in ("loads", "hangs", "stands", "squats", "steps on the spot", "walks forward"):
            self.assertRegex(result.stdout, rf"(?m)^{rung} +yes ")
        self.assertIn("| walks forward | yes | 1 of 1 robots told ", (self.robot / "bring-up.md").read_text())
        with self.subTest("its files play"):
            played = PROGRAM.run("run", self.robot / "go.yaml", "--stepper", "lumped", "--record", "no", "--duration", 9, "--out", self.robot / "run")
            self.assertEqual(played.returncode, 0, played.stdout + played.stderr)
            self.assertIn("walks; did not fall; 0 faults", played.stdout)
            checked = PROGRAM.run("motion", "check", self.robot / "motions/squat.yaml", "--robot", self.robot)
            self.assertEqual(checked.returncode, 0, checked.stdout)
        with self.subTest("it climbs again over its own files"):
            before = (self.robot / "parameters.yaml").read_bytes()
            again = self.climb("--until", "stands")
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual(again.stdout.splitlines()[:3], result.stdout.splitlines()[:3])
            self.assertRegex(again.stdout, r"(?m)^squats +- ")
            self.assertEqual((self.robot / "parameters.yaml").read_bytes(), before)

    def test_names_the_rung_that_fails(self):
        text = (self.robot / "robot.sdf").read_text()
        # Servos of a tenth of the torque.
        self.assertIn("<torque_constant_Nm_per_A>", text)
        (self.robot / "robot.sdf").write_text(sizes.scaled_elements(text, "resistance_ohm", 10.0))
        result = self.climb("--until", "steps on the spot")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        failed = [line for line in result.stdout.splitlines() if " NO " in line]
        self.assertEqual(len(failed), 1, result.stdout)
        self.assertRegex(failed[0], "^(stands|squats|steps on the spot) ")
        self.assertRegex(result.stdout, r"(?m)^turns +- ")

    def test_keeps_files_that_it_has_not_written(self):
        own = self.robot / "parameters.yaml"
        own.write_text("version: 1\nrobot: koboshi\nparameters: {}\n# Written by Anna\n")
        result = self.climb()
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertRegex(result.stderr, r"parameters\.yaml: found a file that bring-up has not written, expected ")
        self.assertIn("# Written by Anna", own.read_text())
        self.assertFalse((self.robot / "go.yaml").exists())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
