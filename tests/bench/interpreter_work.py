#!/usr/bin/env python3
"""Measures the motion interpreter on the Cortex-M4 in QEMU under motions that ask the most of it.

interpreter_work.py PROGRAM [COUNT]: two motions play at once, one with the 12 joints of the legs and
one with the 8 others, without end. Prints, for each kind of move and each kind of steps between the
moves, the instructions of the interpreter per tick in which a motion plays: mean, 99 of 100 ticks, and
the most, in which ticks that start a motion take part. Needs the image of `./run target`. Takes about 5 s per row;
COUNT limits the rows.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SIDES = ("left", "right")
LEGS = [f"{side}_{joint}" for side in SIDES for joint in
        ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll")]
REST = [f"{side}_{joint}" for side in SIDES for joint in
        ("shoulder_pitch", "shoulder_roll", "elbow")] + ["head_pan", "head_tilt"]
STAND_DEG = {f"{side}_{joint}": angle for side in SIDES for joint, angle in
             (("hip_pitch", -16), ("knee", 44), ("ankle_pitch", -28))}
ARMS_DEG = {"left_shoulder_roll": 10, "right_shoulder_roll": -10, "left_elbow": -20, "right_elbow": -20}
SOURCES = ("roll_rate", "pitch_rate", "yaw_rate", "roll", "pitch")

# Interpolation and how long a move takes.
MOVES = (("linear", "time_s: 0.002"), ("linear", "time_s: 0.005"), ("linear", "speed_deg_per_s: 60"),
         ("minimum_jerk", "time_s: 0.002"), ("minimum_jerk", "speed_deg_per_s: 40"),
         ("cubic", "time_s: 0.003"), ("cubic", "time_s: 0.008"), ("cubic", "speed_deg_per_s: 40"))
# The steps after each move; {joint} is a joint of the motion.
BETWEEN = {
    "none": [],
    "set": ['{{set: {{a: "+= 1", b: "*= 3"}}}}'],
    "division": ['{{set: {{a: "+= 9", b: "/= 3"}}}}'],
    "five sets": ['{{set: {{a: "+= 1"}}}}'] * 5,
    "five divisions": ['{{set: {{b: "/= a"}}}}'] * 5,
    "if": ['{{if: "a > 5 or roll_mdeg > 9000 or angle_mdeg({joint}) > 90000", '
           'then: [{{set: {{a: 1}}}}]}}'],
    "mix": ["{{mix: {{{joint}: {{roll_rate: 0.3, limit_deg: 2}}}}}}",
            "{{mix: {{{joint}: {{roll_rate: 0.6, limit_deg: 2}}}}}}"],
}


def motion_text(name, joints, interpolation, duration, mixes, between):
    lines = ["version: 2", "robot: koboshi", f"name: {name}", f"joints: [{', '.join(joints)}]",
             "variables: {a: 1, b: 7}", f"interpolation: {interpolation}", "poses:"]
    for pose, offset_deg in (("p", 0.0), ("q", 0.2), ("r", 0.35)):
        angles = ", ".join(f"{joint}: {(STAND_DEG | ARMS_DEG).get(joint, 0) + offset_deg:.2f}"
                           for joint in joints)
        lines.append(f"  {pose}: {{{angles}}}")
    lines += ["steps:", "  - {pose: p, time_s: 0.3}"]
    for joint, source in [(joint, source) for source in SOURCES for joint in joints][:mixes]:
        lines += [f"  - {{mix: {{{joint}: {{{source}: 0.1, limit_deg: 2}}}}}}", "  - {wait_s: 0.01}"]
    lines += ["  - loop:", "      times: 20000", "      steps:"]
    for pose in "qrp":
        lines.append(f"        - {{pose: {pose}, {duration}}}")
        lines += [f"        - {step.format(joint=joints[0])}" for step in between]
    return "\n".join(lines) + "\n"


def scenario_text(folder):
    angles = ", ".join(f"{joint}: {angle}" for joint, angle in STAND_DEG.items())
    return f"""version: 1
robot: {ROOT}/robots/koboshi/robot.sdf
motions: [{folder}/legs.yaml, {folder}/rest.yaml]
duration_s: 6
seed: 1
initial:
  held_until_s: 5.9
  joints_deg: {{{angles}}}
commands:
  - {{at_s: 2, enable: true}}
  - {{at_s: 3, play: legs}}
  - {{at_s: 3.1, play: rest}}
"""


def measure(program, folder, interpolation, duration, mixes, between):
    for name, joints in (("legs", LEGS), ("rest", REST)):
        text = motion_text(name, joints, interpolation, duration, mixes, between)
        (folder / f"{name}.yaml").write_text(text)
    (folder / "scenario.yaml").write_text(scenario_text(folder))
    subprocess.run([program, "target-report", folder / "scenario.yaml", "--json", folder / "report.json"],
                   cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    report = json.loads((folder / "report.json").read_text())
    return report["while_moving"]["by_part"]["interpreter"]


def main():
    program = Path(sys.argv[1]).resolve()
    rows = [(move, between, 16) for between in BETWEEN for move in MOVES]
    rows += [(move, "none", 0) for move in MOVES]
    rows = rows[:int(sys.argv[2])] if len(sys.argv) > 2 else rows
    print("| moves | between them | corrections | mean | 99 of 100 ticks | most |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for (interpolation, duration), between, mixes in rows:
            found = measure(program, Path(folder), interpolation, duration, mixes, BETWEEN[between])
            print(f"| {interpolation}, {duration} | {between} | {mixes} | {found['mean']:.0f} |"
                  f" {found['p99']} | {found['max']} |", flush=True)


if __name__ == "__main__":
    main()
