#!/usr/bin/python3
"""Makes the default robot's meshes, robots/koboshi/meshes/*.stl, and the <visual> elements of robots/koboshi/robot.sdf.

A kit robot: servo cases with a horn at each end of the shaft, brackets of bent sheet between the horns of one joint and the
case of the next servo, and covers. The folder meshes/ makes the parts; here are their places and colours. On every joint's
axis the parent's servo case overlaps the child's horn, so links touch at every angle. tests/proof/meshes_test.py checks
that, closed surfaces, the number of triangles, and that the committed files are these.

    tools/dev/make_meshes.py [ROBOT_FOLDER]      needs python3-numpy
"""

import pathlib
import re
import sys

import numpy as np

from meshes import arms, joints, legs, trunk
from meshes.joints import TAB, TAB_OUT
from meshes.legs import ANKLE_SERVO, ROLL_SERVO, YAW_SERVO
from meshes.solids import stl_bytes
from meshes.trunk import TILT_SERVO

PARTS = joints.PARTS | legs.PARTS | arms.PARTS | trunk.PARTS

COLOURS = {
    "case": (0.13, 0.135, 0.15),
    "dark": (0.07, 0.072, 0.08),
    "rubber": (0.1, 0.1, 0.105),
    "label": (0.8, 0.81, 0.82),
    "steel": (0.45, 0.47, 0.5),
    "sheet": (0.76, 0.78, 0.81),
    "cover": (0.95, 0.93, 0.88),
    "red": (0.74, 0.07, 0.06),
    "gold": (0.86, 0.64, 0.22),
    "lens": (0.3, 0.85, 0.95),
}


def frame(shaft, case):
    """Rotation of a servo whose shaft and case point along these axes, such as "+y" and "-x"."""

    def axis(name):
        return np.eye(3)["xyz".index(name[1])] * (1 if name[0] == "+" else -1)

    x, z = axis(case), axis(shaft)
    return np.stack([x, np.cross(z, x), z], axis=1)


def servo_at(name, x, y, z, shaft, case):
    return (f"{name}_servo", "servo", "case", (x, y, z), frame(shaft, case))


def labelled(visuals):
    """Adds stickers to the servos among them."""
    return [
        each
        for v in visuals
        for each in ([v, (v[0].replace("servo", "label"), "servo_label", "label", *v[3:])] if v[1] == "servo" else [v])
    ]


def horn_at(kind, x, y, z, shaft, case="+x"):
    return (kind, kind, "steel", (x, y, z), frame(shaft, case))


def part(name, colour, x=0.0, y=0.0, z=0.0, rotation=None):
    return (name, name, colour, (x, y, z), np.eye(3) if rotation is None else rotation)


HALF_TURN = np.diag([-1.0, -1.0, 1.0])
QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
SHOULDER_SERVO = 70.0 - 24.0 - TAB  # y of the middle of the shoulder pitch servo in the trunk
PAN_SERVO = 142.0 - TAB_OUT  # z of the middle of the pan servo in the trunk


def layout():
    """For each link its visuals: name, part, colour, position and rotation."""
    links = {
        "trunk": [
            part("trunk_frame", "sheet"),
            part("trunk_core", "dark"),
            part("chest_cover", "cover"),
            part("chest_stripe", "red"),
            part("chest_gold", "gold"),
            part("chest_dark", "dark"),
            servo_at("left_hip_yaw", 0, 30, YAW_SERVO, "-z", "-x"),
            servo_at("right_hip_yaw", 0, -30, YAW_SERVO, "-z", "-x"),
            servo_at("left_shoulder_pitch", 0, SHOULDER_SERVO, 120, "+y", "-z"),
            servo_at("right_shoulder_pitch", 0, -SHOULDER_SERVO, 120, "-y", "-z"),
            servo_at("head_pan", 0, 0, PAN_SERVO, "+z", "-x"),
        ],
        "neck": [
            horn_at("horn", 0, 0, PAN_SERVO - 142.0, "+z"),
            part("neck_bracket", "sheet"),
            servo_at("head_tilt", 0, 0, TILT_SERVO, "+y", "-x"),
        ],
        "head": [
            horn_at("horns", 0, 0, 0, "+y"),
            part("head_frame", "sheet"),
            part("helmet", "red"),
            part("face_plate", "cover"),
            part("face_dark", "dark"),
            part("face_lens", "lens"),
            part("face_gold", "gold"),
        ],
    }
    for side, sign in (("left", 1), ("right", -1)):
        outward, inward = ("+y", "-y") if sign > 0 else ("-y", "+y")
        mirrored = np.eye(3) if sign > 0 else HALF_TURN
        links |= {
            f"{side}_hip_yaw_link": [
                horn_at("horn", 0, 0, YAW_SERVO, "-z"),
                part("hip_yaw_bracket", "sheet"),
                servo_at("hip_roll", ROLL_SERVO, 0, 0, "+x", "+z"),
            ],
            f"{side}_hip_roll_link": [
                horn_at("horn", ROLL_SERVO, 0, 0, "+x", "+z"),
                part("hip_roll_bracket", "sheet"),
                servo_at("hip_pitch", 0, 0, 0, outward, "+z"),
            ],
            f"{side}_thigh": [
                horn_at("horns", 0, 0, 0, outward),
                part("fork", "sheet"),
                part("leg_strut", "sheet"),
                part("leg_core", "dark"),
                part("thigh_cover", "cover"),
                part("thigh_stripe", "red"),
                servo_at("knee", 0, 0, -65, outward, "+z"),
            ],
            f"{side}_shank": [
                horn_at("horns", 0, 0, 0, outward),
                part("fork", "sheet"),
                part("leg_strut", "sheet"),
                part("leg_core", "dark"),
                part("shank_cover", "cover"),
                part("shank_stripe", "red"),
                servo_at("ankle_pitch", 0, 0, -65, outward, "+z"),
            ],
            f"{side}_ankle_link": [
                horn_at("horns", 0, 0, 0, outward),
                part("ankle_bracket", "sheet"),
                servo_at("ankle_roll", ANKLE_SERVO, 0, 0, "+x", "-z"),
            ],
            f"{side}_foot": [
                horn_at("horns", ANKLE_SERVO, 0, 0, "+x", "+z"),
                part("foot_bracket", "sheet"),
                part("foot_sensor", "steel"),
                part("foot_sole", "rubber"),
                part("foot_cover", "cover"),
                part("foot_stripe", "red"),
            ],
            f"{side}_shoulder_link": [
                horn_at("horn", 0, sign * (SHOULDER_SERVO - 70.0), 0, outward),
                part("shoulder_bracket", "sheet", rotation=mirrored),
                part("shoulder_cover", "cover", rotation=mirrored),
                part("shoulder_stripe", "red", rotation=mirrored),
                servo_at("shoulder_roll", 0, 0, 0, "+x", inward),
            ],
            f"{side}_upper_arm": [
                horn_at("horns", 0, 0, 0, "+x", "+z"),
                part("fork", "sheet", rotation=QUARTER_TURN),
                part("arm_strut", "sheet"),
                part("upper_arm_cover", "cover"),
                part("upper_arm_stripe", "red"),
                servo_at("elbow", 0, 0, -70, outward, "+z"),
            ],
            f"{side}_forearm": [
                horn_at("horns", 0, 0, 0, outward),
                part("fork", "sheet"),
                part("forearm_cover", "cover"),
                part("forearm_stripe", "red"),
                part("hand", "rubber"),
            ],
        }
    return {
        link: visuals if link == "trunk" else labelled(visuals) for link, visuals in links.items()
    }  # covers hide the trunk's


def number(value):
    return f"{round(value, 6) + 0.0:.6f}".rstrip("0").rstrip(".")  # + 0.0: no negative zero


def pose(position_mm, rotation):
    """x y z roll pitch yaw, in metres and radians."""
    pitch = np.arcsin(np.clip(-rotation[2, 0], -1, 1))
    if abs(rotation[2, 0]) < 0.999:
        roll, yaw = np.arctan2(rotation[2, 1], rotation[2, 2]), np.arctan2(rotation[1, 0], rotation[0, 0])
    else:
        roll, yaw = 0.0, np.arctan2(-rotation[0, 1], rotation[1, 1])
    return " ".join(number(v) for v in (*(p / 1000 for p in position_mm), roll, pitch, yaw))


def visual(name, file, colour, position, rotation):
    red_green_blue = " ".join(number(c) for c in COLOURS[colour])
    return (
        f'      <visual name="{name}">\n'
        f"        <pose>{pose(position, rotation)}</pose>\n"
        f"        <geometry><mesh><uri>meshes/{file}.stl</uri><scale>0.001 0.001 0.001</scale></mesh></geometry>\n"
        f"        <material><diffuse>{red_green_blue} 1</diffuse></material>\n"
        "      </visual>\n"
    )


def with_visuals(sdf):
    """The robot's file with the visuals of layout() in the place of those that it has."""
    for link, visuals in layout().items():
        start = sdf.index(f'<link name="{link}">')
        end = sdf.index("</link>", start)
        body = sdf[start:end]
        first = body.index("      <visual ")
        rest = re.sub(r"      <visual .*?</visual>\n", "", body, flags=re.DOTALL)
        sdf = sdf[:start] + rest[:first] + "".join(visual(*v) for v in visuals) + rest[first:] + sdf[end:]
    return sdf


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else root / "robots" / "koboshi"
    meshes = folder / "meshes"
    meshes.mkdir(parents=True, exist_ok=True)
    for old in meshes.glob("*.stl"):
        if old.stem not in PARTS:
            old.unlink()
    for name, make in PARTS.items():
        (meshes / f"{name}.stl").write_bytes(stl_bytes(make()))
    robot = folder / "robot.sdf"
    robot.write_text(with_visuals(robot.read_text()))


if __name__ == "__main__":
    main()
