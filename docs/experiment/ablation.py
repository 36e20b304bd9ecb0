"""What each part of the walk is worth: plays the same walks and pushes with one part off at a time, for docs/design/walking.md.

Usage: ablation.py [--koboshi PROGRAM] [--seeds N] [--first-seed N] [--jobs N] [--out FOLDER]

Each cell is `koboshi experiment robustness` in `rough` worlds, `mujoco`. All rows have the same worlds and pushes. Prints the table in
Markdown. What FOLDER has of an interrupted run is not played again.
"""

import argparse
import json
import pathlib
import subprocess

# Name of the part, and the parameters without it.
PARTS = {
    "nothing": {},
    "footholds ahead and behind": {"capture_forward_percent": 0},
    "footholds to the side": {"capture_lateral_percent": 0},
    "ZMP tracking": {"zmp_tracking_forward_percent": 0, "zmp_tracking_lateral_percent": 0},
    "age of the measurement": {"plan_age_ms": 0},
    "level soles": {"sole_levelling_percent": 0},
    "hold of the heading": {"heading_hold_percent": 0},
    "gyro feedback": {
        f"walking_gain_{joint}_s": 0 for joint in ("ankle_pitch", "ankle_roll", "hip_roll", "knee", "hip_pitch")
    },
    "feedback of the lean": {"walking_lean_gain_ankle_roll_percent": 0, "walking_lean_gain_hip_roll_percent": 0},
    "compensation of the legs' sag": {"pitch_compliance_rad_per_m": 0, "roll_compliance_rad_per_m": 0},
    "lean by the speed": {"trunk_pitch_by_speed_deg_s_per_m": 0},
    "wider fall limits while walking": {"fall_limits_walking_percent": 100},
    "steps from standing": {"longest_standing_dcm_mm": 0},
    "faster steps from standing": {"pushed_step_time_ms": 0},
    "arms that turn against the fall": {"arm_reaction_rad_per_m": 0},
}
EVERY_FEEDBACK = "every feedback of the walk"
for name in (
    "footholds ahead and behind",
    "footholds to the side",
    "ZMP tracking",
    "level soles",
    "hold of the heading",
    "gyro feedback",
    "feedback of the lean",
):
    PARTS.setdefault(EVERY_FEEDBACK, {}).update(PARTS[name])

# Column, activity of the experiment, factor, impulse in N s/kg.
ACTIVITIES = (
    ("walk at 0.33 m/s", "walk-full", "none", None),
    ("pushed at 0.165 m/s, 0.30 N s/kg", "push-half", "impulse", 0.30),
    ("pushed on the spot, 0.36 N s/kg", "push-on-the-spot", "impulse", 0.36),
    ("pushed standing, 0.44 N s/kg", "push-standing", "impulse", 0.44),
)


def lost(options, part, activity, factor, impulse):
    """Returns the number of trials that are lost, and the number of all."""
    folder = options.out / f"{list(PARTS).index(part)}-{activity}"
    results = folder / "lost.json"
    folder.mkdir(parents=True, exist_ok=True)
    command = [options.koboshi, "experiment", "robustness", "--others", "rough", "--stepper", "mujoco", "--cliff", "1"]
    command += ["--only", activity, "--factors", factor]
    command += ["--levels", str(impulse)] if impulse else []
    command += ["--seeds", str(options.seeds), "--first-seed", str(options.first_seed), "--jobs", str(options.jobs)]
    for key, value in PARTS[part].items():
        command += ["--set", f"parameters.{key}={value}"]
    command += ["--out", str(folder), "--json", str(results)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    (cell,) = json.loads(results.read_text(encoding="utf-8"))["cells"]
    return cell["lost"]["events"], cell["lost"]["count"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--koboshi", default="build/release/bin/koboshi")
    parser.add_argument("--seeds", type=int, default=48)
    parser.add_argument("--first-seed", type=int, default=1_600_000)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/ablation"))
    options = parser.parse_args()
    print("| without | " + " | ".join(column for column, *_ in ACTIVITIES) + " |")
    print("| --- |" + " ---: |" * len(ACTIVITIES))
    for part in PARTS:
        cells = [lost(options, part, *rest) for _, *rest in ACTIVITIES]
        print(f"| {part} | " + " | ".join(f"{events} of {count}" for events, count in cells) + " |", flush=True)


if __name__ == "__main__":
    main()
