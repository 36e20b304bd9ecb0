"""Robots with thirteen leg geometries stand, squat and step on the spot with one firmware."""

import csv
import math
import pathlib
import re
import shutil
import tempfile
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi"


def moved(text, link, offset_m):
    """Moves a link of both legs against the one that carries it; y points outward."""
    for side, outward in ("left", 1), ("right", -1):
        pose = re.compile(rf'(<link name="{side}_{link}">\s*<pose relative_to="[^"]*">)([^<]*)')
        numbers = [float(number) for number in pose.search(text).group(2).split()]
        for axis, sign in enumerate((1, outward, 1)):
            numbers[axis] += sign * offset_m[axis]
        text = pose.sub(lambda match: match.group(1) + " ".join(f"{number:.9g}" for number in numbers), text, count=1)
    return text


def turned(text, joint, left, right=None):
    """Gives a joint of both legs another axis."""
    for side, axis in ("left", left), ("right", right or left):
        text, count = re.subn(rf'(<joint name="{side}_{joint}".*?<xyz>)[^<]*', rf"\g<1>{axis}", text, count=1, flags=re.DOTALL)
        assert count == 1
    return text


def swapped(text, one, other):
    """Exchanges the places of two joints in both legs."""
    axes = [re.search(rf'<joint name="left_{joint}".*?<xyz>([^<]*)', text, re.DOTALL).group(1) for joint in (one, other)]
    text = turned(turned(text, one, axes[1]), other, axes[0])
    for side in "left", "right":
        text = (text.replace(f'<joint name="{side}_{one}"', "<joint name=\"?\"").replace(f'<joint name="{side}_{other}"', f'<joint name="{side}_{one}"')
                .replace("<joint name=\"?\"", f'<joint name="{side}_{other}"'))
    return text


def at_45_degrees(text):
    return turned(turned(text, "hip_yaw", "-0.70710678 0 0.70710678"), "hip_roll", "0.70710678 0 0.70710678")


def with_one_motor(text, multiplier):
    """Lets the left hip yaw's motor turn the right one as well."""
    text, count = re.subn(r'(<joint name="right_hip_yaw".*?)( *</axis>).*?(    </joint>)',
                          rf'\g<1><mimic joint="left_hip_yaw"><multiplier>{multiplier}</multiplier></mimic>\n\g<2>\n\g<3>',
                          text, count=1, flags=re.DOTALL)
    assert count == 1
    return text


def nao_hips(text):
    """Both hip yaws at 45 degrees about the axis to the side, turned by one motor as those of a NAO."""
    return with_one_motor(turned(text, "hip_yaw", "0 -0.70710678 0.70710678", "0 0.70710678 0.70710678"), -1)


# What differs from the default robot, in m.
GEOMETRIES = {
    "hip axes 0.1 mm apart": lambda text: moved(text, "hip_roll_link", (0.0001, 0, 0)),
    "hip axes 2 mm apart": lambda text: moved(text, "thigh", (0.001, 0.001, -0.001)),
    "hip axes 11 and 16 mm apart": lambda text: moved(moved(text, "hip_roll_link", (0.01, 0, -0.005)), "thigh", (-0.01, 0.005, -0.012)),
    "hip axes 50 mm apart": lambda text: moved(text, "hip_roll_link", (-0.03, 0, -0.04)),
    "the order roll, yaw, pitch": lambda text: swapped(text, "hip_yaw", "hip_roll"),
    "roll, yaw, pitch with offsets": lambda text: moved(swapped(text, "hip_yaw", "hip_roll"), "hip_roll_link", (0.006, 0.004, -0.01)),
    "hips at 45 degrees": at_45_degrees,
    "hips at 45 degrees with offsets": lambda text: moved(at_45_degrees(text), "thigh", (-0.005, 0.003, -0.008)),
    "ankle axes 10 mm apart": lambda text: moved(text, "foot", (0.005, 0.003, -0.008)),
    "hip and ankle offsets": lambda text: moved(moved(text, "thigh", (0.004, 0.004, -0.01)), "foot", (0.003, -0.002, -0.006)),
    "a knee aside": lambda text: moved(text, "shank", (0.004, 0.003, 0)),
    "one motor for hips at 45 degrees": nao_hips,
    "an oblique hip pitch": lambda text: turned(text, "hip_pitch", "0 0.99498744 0.1", "0 0.99498744 -0.1"),
}


class LegGeometries(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_legs_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def play(self, robot, scenario, *options):
        result = PROGRAM.run("run", scenario, "--robot", robot / "robot.sdf", "--stepper", "lumped", "--record", "no",
                             "--out", self.folder / "run", *options)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def turning(self, change, command):
        """Walks on the spot, then by a command. Returns the turn in degrees and the output."""
        robot = self.folder / "robot"
        shutil.copytree(ROBOT, robot, dirs_exist_ok=True)
        (robot / "robot.sdf").write_text(change((ROBOT / "robot.sdf").read_text()))
        scenario = self.folder / "turn.yaml"
        text = (support.ROOT / "scenarios" / "go.yaml").read_text()
        head, _ = text.split("  - {at_s: 6, walk:")
        scenario.write_text(head + "  - {at_s: 5, walk: {" + command + "}}\n")
        output = self.play(robot, scenario, "--duration", "10")
        with open(self.folder / "run" / "trace.csv", newline="") as file:
            last = list(csv.DictReader(file))[-1]
        return math.degrees(float(last["true_yaw_rad"])), output

    def test_one_motor_for_both_hip_yaws_turns_the_robot(self):
        for name, hips in {"upright": lambda text: with_one_motor(text, -1), "at 45 degrees": nao_hips}.items():
            with self.subTest(name):
                turn_deg, output = self.turning(hips, "turn_rad_per_s: 0.4")
                self.assertIn("walks; did not fall; 0 faults", output)
                self.assertGreater(turn_deg, 105)  # of 115 by command
                self.assertLess(turn_deg, 125)

    def test_motions_name_the_joint_of_one_motor_with_and_without_its_side(self):
        robot = self.folder / "robot"
        shutil.copytree(ROBOT, robot, dirs_exist_ok=True)
        (robot / "robot.sdf").write_text(nao_hips((ROBOT / "robot.sdf").read_text()))
        for angles, status, found in ("hip_yaw: 5", 0, "0 errors"), ("left_hip_yaw: 5", 0, "0 errors"), \
                ("hip_yaw: 5, left_hip_yaw: 5", 2, "a second angle for left_hip_yaw"), ("right_hip_yaw: 5", 2, "right_hip_yaw"):
            with self.subTest(angles):
                motion = self.folder / "turn.yaml"
                motion.write_text(f"version: 1\nrobot: koboshi\nname: turn\nposes:\n  turned: {{{angles}}}\nsteps:\n  - {{pose: turned, time_s: 1}}\n")
                result = PROGRAM.run("motion", "check", motion, "--robot", robot / "robot.sdf")
                self.assertEqual(status, result.returncode, result.stdout + result.stderr)
                self.assertIn(found, result.stdout + result.stderr)

    def test_each_stands_squats_and_steps_on_the_spot(self):
        text = (ROBOT / "robot.sdf").read_text()
        self.assertEqual(len(GEOMETRIES), 13)
        for name, change in GEOMETRIES.items():
            with self.subTest(name):
                robot = self.folder / "robot"
                shutil.copytree(ROBOT, robot, dirs_exist_ok=True)
                changed = change(text)
                self.assertNotEqual(changed, text)
                (robot / "robot.sdf").write_text(changed)
                # Hips that are further apart do not let the centre of mass as low as those of the default robot.
                parameters = (ROBOT / "parameters.yaml").read_text()
                (robot / "parameters.yaml").write_text(re.sub(r"com_height_mm: \S+", "com_height_mm: 164", parameters))
                squat = self.play(robot, "squat", "--duration", "12")
                self.assertIn("Plays the motion squat.", squat)
                self.assertIn("plays squat; did not fall; 0 faults", squat)
                steps = self.play(robot, "go", "--duration", "6")  # on the spot from 4 s on
                self.assertIn("Stands.", steps)
                self.assertIn("walks; did not fall; 0 faults", steps)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
