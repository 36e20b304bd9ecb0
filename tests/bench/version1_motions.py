#!/usr/bin/env python3
"""Measures the motion interpreter on the Cortex-M4 in QEMU under the robot's motions of version 1.

version1_motions.py PROGRAM SOURCES: plays each motion of SOURCES/robots/koboshi/motions once, held in
the air, and prints the instructions of the interpreter per tick in which it plays: mean, 99 of 100
ticks, and the most. Steps that expect an attitude are left out, because the held robot is upright.
Needs the image of `./run target` in SOURCES. To compare two versions of the firmware, give the
program and the sources of each, with the same `tools/target`.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

MOTIONS = ("stand", "squat", "wave", "fall_front", "fall_back", "fall_left", "fall_right", "roll_left",
           "roll_right", "rise_prone", "rise_supine", "rise_seat")


def scenario_text(sources, motion_file, name):
    # The robot stands as in `stand` before it plays another motion.
    stand = "" if name == "stand" else f"{sources}/robots/koboshi/motions/stand.yaml, "
    return f"""version: 1
robot: {sources}/robots/koboshi/robot.sdf
motions: [{stand}{motion_file}]
duration_s: 9
seed: 1
initial:
  held_until_s: 8.9
  joints_deg: {{left_hip_pitch: -16, left_knee: 44, left_ankle_pitch: -28,
    right_hip_pitch: -16, right_knee: 44, right_ankle_pitch: -28}}
commands:
  - {{at_s: 2, enable: true}}
  - {{at_s: 4, play: {name}}}
"""


def measure(program, sources, folder, name):
    lines = (sources / "robots/koboshi/motions" / f"{name}.yaml").read_text().splitlines()
    motion = folder / f"{name}.yaml"
    motion.write_text("\n".join(line for line in lines if "expect:" not in line) + "\n")
    (folder / "scenario.yaml").write_text(scenario_text(sources, motion, name))
    report = folder / "report.json"
    subprocess.run([program, "target-report", folder / "scenario.yaml", "--json", report], cwd=sources,
                   check=True, stdout=subprocess.DEVNULL)
    moving = json.loads(report.read_text())["while_moving"]
    return moving["ticks"], moving["by_part"]["interpreter"]


def main():
    program, sources = (Path(argument).resolve() for argument in sys.argv[1:3])
    print("| motion | ticks | mean | 99 of 100 ticks | most |\n| --- | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for name in MOTIONS:
            ticks, found = measure(program, sources, Path(folder), name)
            print(f"| {name} | {ticks} | {found['mean']:.1f} | {found['p99']} | {found['max']} |", flush=True)


if __name__ == "__main__":
    main()
