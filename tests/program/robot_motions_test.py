"""All motions of all robots pass the check. Those of the robots beside Koboshi, which are Koboshi's by `koboshi motion retarget
--by targets`, leave them standing at their end. The argument `worlds` plays all of them in ten worlds in two engines and compares with docs/reference/motions.md."""

import pathlib
import re
import sys
import unittest

import program as support

PROGRAM = None
PAGE = support.ROOT / "docs/reference/motions.md"
ROBOTS = ("chibi", "hanpo", "noppo")


def retargeted(robot):
    """The files of the robot's motions that were retargeted, by name."""
    files = sorted((support.ROOT / "robots" / robot / "motions").glob("*.yaml"))
    return {file.stem: file for file in files if file.read_text().startswith("# Retargeted from ")}


class RobotMotions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def stands_after(self, robot, motion, *arguments):
        result = PROGRAM.run("motion", "play", retargeted(robot)[motion], "--robot", robot, "--record", "no", "--out",
                             self.folder / "run", *arguments)
        return result.returncode == 0 and "\nstands; did not fall; 0 faults\n" in "\n" + result.stdout

    def test_pass_the_check(self):
        """All motions of all robots of this repository, those for falling and getting up included."""
        for robot in (*ROBOTS, "koboshi"):
            files = sorted((support.ROOT / "robots" / robot / "motions").glob("*.yaml"))
            names = {file.stem for file in files}
            self.assertLessEqual({"stand", "fall_front", "roll_left", "rise_prone", "rise_supine"}, names)
            if robot in ROBOTS:
                self.assertGreaterEqual(len(retargeted(robot)), 7)
            with self.subTest(robot):
                result = PROGRAM.run("motion", "check", *files, "--robot", robot)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_end_standing(self):
        for robot, motion in (("chibi", "touch_floor"), ("hanpo", "one_leg_left"), ("noppo", "squat_deep")):
            with self.subTest(robot=robot, motion=motion):
                self.assertTrue(self.stands_after(robot, motion))


class Worlds(RobotMotions):
    def test_are_those_of_the_page(self):
        rows = re.findall(r"^\| `(\w+)` \| (`\w+`(?:, `\w+`)*) \| (\d+) \| (\d+) \|$", PAGE.read_text(), re.MULTILINE)
        stated = {(robot, motion.strip("`")): (int(lumped), int(mujoco))
                  for robot, motions, lumped, mujoco in rows if robot in ROBOTS for motion in motions.split(", ")}
        self.assertEqual(set(stated), {(robot, motion) for robot in ROBOTS for motion in retargeted(robot)})
        for (robot, motion), successes in sorted(stated.items()):
            with self.subTest(robot=robot, motion=motion):
                played = tuple(sum(self.stands_after(robot, motion, "--world", "mild", "--seed", str(seed), "--stepper", stepper)
                                   for seed in range(1, 11)) for stepper in ("lumped", "mujoco"))
                self.assertEqual(played, successes)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    worlds = sys.argv[1:] == ["worlds"] and sys.argv.pop(1)
    unittest.main(defaultTest="Worlds.test_are_those_of_the_page" if worlds else "RobotMotions")
