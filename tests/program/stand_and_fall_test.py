"""A robot hangs, stands for 10 s under servo control, is pushed over, and falls without an explosion.

    python3 tests/program/stand_and_fall_test.py KOBOSHI [ROBOT]

ROBOT is any robot's folder; without it, the default robot's body without its motions and parameters.
"""

import csv
import json
import math
import pathlib
import shutil
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import program as support

PROGRAM = None
ROBOT = None
RELEASE_S, PUSH_S, END_S = 3.5, 14.0, 19.0
PUSH_TIME_S = 0.3
GRAVITY = 9.80665
LIMIT_MARGIN_RAD = 0.05

SCENARIO = """version: 1
robot: {robot}
duration_s: {end}
seed: 1
motions: []
initial: {{held_until_s: {release}}}
commands:
  - {{at_s: 2, enable: true}}
pushes:
  - {{at_s: {push}, duration_s: {push_time}, shape: half-sine, link: {trunk}, force_N: [{force:.3f}, 0, 0]}}
"""


def local(tag):
    return tag.rpartition("}")[2]


def read_robot(folder):
    """Returns the base link, the total mass in kg, and the limits of each joint in rad."""
    model = ElementTree.parse(folder / "robot.sdf").getroot().find("model")
    joints = [joint for joint in model.findall("joint") if joint.get("type") == "revolute"]
    children = {joint.findtext("child") for joint in joints}
    base = next(link.get("name") for link in model.findall("link") if link.get("name") not in children)
    mass = sum(float(link.findtext("inertial/mass")) for link in model.findall("link"))
    limits = {joint.get("name"): tuple(float(joint.findtext(f"axis/limit/{end}")) for end in ("lower", "upper")) for joint in joints}
    return base, mass, limits


def read_trace(file):
    with open(file, encoding="utf-8") as text:
        rows = list(csv.reader(text))
    used = [(at, name) for at, name in enumerate(rows[0]) if name == "time_s" or name.startswith("true_") or name.endswith("_true_rad")]
    return [{name: float(row[at]) for at, name in used if row[at]} for row in rows[1:]]


def energies(rows):
    """The energy of the whole mass in its centre, in J/kg, above the ground; and the time of each."""
    result = []
    for before, after in zip(rows, rows[1:]):
        step = after["time_s"] - before["time_s"]
        speed = [(after[f"true_com_{axis}_m"] - before[f"true_com_{axis}_m"]) / step for axis in "xyz"]
        height = (after["true_com_z_m"] + before["true_com_z_m"]) / 2
        result.append((after["time_s"], GRAVITY * height + sum(value * value for value in speed) / 2))
    return result


class StandAndFall(unittest.TestCase):
    def test_stands_and_falls_without_an_explosion(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_fall_")
        self.addCleanup(folder.cleanup)
        folder = pathlib.Path(folder.name)
        robot = ROBOT
        if robot is None:
            robot = folder / "small"
            robot.mkdir()
            text = (support.ROOT / "robots" / "koboshi" / "robot.sdf").read_text()
            (robot / "robot.sdf").write_text(text.replace('<model name="koboshi"', '<model name="small"'))
            shutil.copytree(support.ROOT / "robots" / "koboshi" / "meshes", robot / "meshes")
        base, mass, limits = read_robot(robot)
        # 2.5 m/s of the whole mass, as a half-sine's mean is 2 / pi of its peak, tips every size.
        force = 2.5 * mass / PUSH_TIME_S * math.pi / 2
        scenario = folder / "fall.yaml"
        scenario.write_text(SCENARIO.format(robot=(robot / "robot.sdf").resolve(), trunk=base, force=force, release=RELEASE_S, push=PUSH_S,
                                            push_time=PUSH_TIME_S, end=END_S))
        result = PROGRAM.run("run", scenario, "--out", folder / "run", "--stepper", "lumped", "--record", "no")
        self.assertIn(result.returncode, (0, 1), result.stdout + result.stderr)
        summary = json.loads((folder / "run" / "summary.json").read_text())
        self.assertEqual(summary["solver_warnings"], 0)
        self.assertEqual(summary["faults"], 0, result.stdout)
        self.assertIn("Stands.", result.stdout)
        self.assertIn("The robot falls", result.stdout)

        rows = read_trace(folder / "run" / "trace.csv")
        stood = [row for row in rows if RELEASE_S + 0.5 <= row["time_s"] < PUSH_S]
        lean = max(max(abs(row["true_roll_rad"]), abs(row["true_pitch_rad"])) for row in stood)
        self.assertGreaterEqual(stood[-1]["time_s"] - stood[0]["time_s"], 9.9)
        self.assertLess(lean, 0.2)
        sag = max(row["true_com_z_m"] for row in stood) - min(row["true_com_z_m"] for row in stood)
        self.assertLess(sag, 0.01)

        miss = max((max(lower - row[f"{joint}_true_rad"], row[f"{joint}_true_rad"] - upper), joint)
                   for row in rows for joint, (lower, upper) in limits.items())
        self.assertLess(miss[0], LIMIT_MARGIN_RAD, miss[1])

        pushed = [energy for at, energy in energies(rows) if PUSH_S <= at <= PUSH_S + PUSH_TIME_S + 0.02]
        fallen = [energy for at, energy in energies(rows) if at > PUSH_S + PUSH_TIME_S + 0.02]
        self.assertLess(max(fallen), max(pushed) * 1.02)
        # At rest at the end: no energy comes from nowhere while it lies.
        self.assertLess(max(abs(rows[-1][f"true_com_{axis}_m"] - rows[-50][f"true_com_{axis}_m"]) for axis in "xyz"), 0.01)
        print(f"leans by {lean:.4f} rad and sags by {sag * 1000:.2f} mm while it stands, at most {miss[0]:.4f} rad beyond a limit "
              f"({miss[1]}), energy of its centre of mass {max(pushed):.3f} J/kg after the push, {max(fallen):.3f} J/kg at most in the fall")


if __name__ == "__main__":
    if len(sys.argv) > 2:
        ROBOT = pathlib.Path(sys.argv.pop(2)).resolve()
    PROGRAM = support.take_program_argument()
    unittest.main()
