"""Scenarios, robots, motions and studies are found by name from any folder."""

import json
import os
import pathlib
import shutil
import subprocess
import unittest

import program as support

PROGRAM = None


class Names(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.user = cls.folder / "home" / "share" / "koboshi"
        cls.environment = {**os.environ, "XDG_DATA_HOME": str(cls.user.parent)}

    def setUp(self):
        self.here = self.folder / self.id().rpartition(".")[2]
        self.here.mkdir()

    def run_program(self, *arguments, program=None):
        return subprocess.run([program or PROGRAM.path, *map(str, arguments)], cwd=self.here, env=self.environment, capture_output=True,
                              text=True, timeout=300, check=False)

    def accept(self, *arguments, **options):
        result = self.run_program(*arguments, **options)
        self.assertEqual(0, result.returncode, f"{arguments}: {result.stderr}")
        return result.stdout

    def test_results_are_in_the_working_folder(self):
        self.accept("run", "walk", "--duration", "0.02", "--record", "no")
        self.assertTrue((self.here / "runs" / "walk" / "summary.json").is_file())
        self.assertEqual(["runs"], [path.name for path in self.here.iterdir()])

    def test_of_every_command(self):
        # The default robot of most of these is robots/koboshi/robot.sdf, which is not in this folder either.
        self.assertIn("no findings", self.accept("model", "check", "koboshi"))
        self.assertRegex(self.accept("model", "get", "koboshi", "left_shank.mass"), r"^[0-9.]+$")
        self.accept("motion", "check", "squat")
        self.accept("motion", "compile", "squat", "-o", "squat.kmot")
        self.assertIn("squat", self.accept("motion", "list"))
        self.accept("motion", "play", "robots/koboshi/motions/bow.yaml", "--record", "no", "--set", "noise=false")
        self.accept("gait", "koboshi", "--robot", "koboshi")
        self.accept("board", "board", "--duration", "0.02")
        self.accept("run", "scenarios/walk.yaml", "--duration", "0.02", "--record", "no")

    def test_of_another_robot(self):
        # A robot in a folder of its own: scenarios name motions, gait and parameters of whatever robot plays them.
        robots = self.here / "mine"
        shutil.copytree(support.ROOT / "robots" / "koboshi", robots / "koboshi")
        (robots / "servos").symlink_to(support.ROOT / "robots" / "servos")
        motion = robots / "koboshi" / "motions" / "stand.yaml"
        motion.write_text(motion.read_text().replace("knee: 43.72", "knee: 42"))
        file = robots / "koboshi" / "robot.sdf"
        short = ("--duration", "3", "--record", "no")
        results = {}
        for name, robot in {"own": "koboshi", "folder": robots / "koboshi", "file": file}.items():
            self.accept("run", "go", "--robot", robot, "--out", name, *short)
            results[name] = json.loads((self.here / name / "summary.json").read_text())["state_hash"]
        self.assertEqual(results["folder"], results["file"])
        self.assertNotEqual(results["folder"], results["own"])
        self.accept("motion", "play", "robots/koboshi/motions/bow.yaml", "--robot", robots / "koboshi", "--record", "no", "--set",
                    "noise=false")
        # A copy of the robot's file alone has the motions of the robot of its name.
        alone = self.here / "alone"
        alone.mkdir()
        shutil.copy(file, alone)
        (alone / "meshes").symlink_to(support.ROOT / "robots" / "koboshi" / "meshes")
        self.accept("run", "go", "--robot", alone, "--out", "alone_run", *short)
        result = self.run_program("run", "squat", "--robot", "kobushi")
        self.assertEqual(2, result.returncode)
        self.assertRegex(result.stderr, "^kobushi: found no such file, and no robot of this name in .*, "
                                        "expected the path of a robot or its name: chibi, hanpo, koboshi or noppo; the nearest is koboshi\n$")

    def test_of_a_learning_study(self):
        result = self.run_program("learn", "residaul")
        self.assertEqual(2, result.returncode)
        self.assertRegex(result.stderr, r"^residaul: found no such file, and no learning study of this name in \./studies/learn, .*: pushes or residual; the nearest is residual\n$")

    def test_of_a_study(self):
        result = self.run_program("tune", "wlak")
        self.assertEqual(2, result.returncode)
        self.assertRegex(result.stderr, r"^wlak: found no such file, and no study of this name in \./studies, .*; the nearest is walk\n$")

    def test_of_the_users_own(self):
        (self.user / "scenarios").mkdir(parents=True)
        self.addCleanup(shutil.rmtree, self.user)
        scenario = support.WALK.read_text()
        self.assertIn("robot: koboshi", scenario)
        (self.user / "scenarios" / "own.yaml").write_text(scenario)
        self.accept("run", "own", "--duration", "0.02", "--record", "no")
        self.assertEqual("own", next((self.here / "runs").iterdir()).name)
        self.assertIn("own\n", self.accept("manual", "names", "scenario"))

    def test_that_is_unknown(self):
        result = self.run_program("run", "wakl")
        self.assertEqual(2, result.returncode)
        self.assertEqual(1, result.stderr.count("\n"), result.stderr)
        for part in ("wakl: found no such file, and no scenario of this name in ./scenarios, ", str(self.user / "scenarios"),
                     str(support.ROOT / "scenarios"), "; the nearest is walk"):
            self.assertIn(part, result.stderr)

    def test_from_a_moved_installation(self):
        prefix = self.here / "prefix"
        (prefix / "bin").mkdir(parents=True)
        program = prefix / "bin" / "koboshi"
        try:
            os.link(PROGRAM.path, program)
        except OSError:  # another file system
            shutil.copy(PROGRAM.path, program)
        for name in ("robots", "scenarios"):
            shutil.copytree(support.ROOT / name, prefix / "share" / "koboshi" / name)
            (self.here / name).mkdir()  # a repository of its own, because that of the sources may be around it
        own = prefix / "share" / "koboshi" / "scenarios" / "walk.yaml"
        own.rename(own.with_name("installed.yaml"))
        names = self.accept("manual", "names", "scenario", program=program).split()
        self.assertIn("installed", names)
        self.assertNotIn("walk", names)
        self.accept("run", "installed", "--duration", "0.02", "--record", "no", program=program)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
