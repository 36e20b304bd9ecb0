#!/usr/bin/python3
"""Makes the looks of the default robot: robots/koboshi/meshes/*.stl, and the <visual> elements of robots/koboshi/robot.sdf.

A kit robot: servo cases with a horn at each end of the shaft, brackets of bent sheet between the horns of one joint and the
case of the next servo, and covers. A part's frame is that of its link unless it says otherwise; lengths in millimetres.
On every joint's axis the case of the parent's servo meets the horn of the child, at any angle of the joint.
tests/proof/meshes_test.py checks that, closed surfaces, the number of triangles and that the committed files are these.

    tools/dev/make_meshes.py [ROBOT_FOLDER]      needs python3-numpy
"""

import pathlib
import re
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from solids import (ALONG_X, ALONG_Y, DOWN, arc_band, block, both_sides, circle, curve, disc, hull, inset, join, loft, loft_x, move, # noqa: E402
                    plate_x, plate_y, plate_z, rectangle, rounded, stl_bytes, superellipse, tapered, tube, turn, turned)

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

# The servo, in its own frame: z along the shaft, the case towards +x. KONDO's KRS-2552 is 41 x 21 x 30.5; the boxes of the
# links leave room for 31.5 x 18 x 21.
SHAFT_END, FAR_END, HALF_WIDTH, HALF_CASE = 9.0, 22.5, 9.0, 10.5
HORN = 10.8        # the inner face of a horn, along the shaft from the case's middle; the boss on the case reaches 11
TAB = 12.3         # the inner face of the bracket on the horn
SHEET = 1.5        # thickness
TAB_OUT = TAB + SHEET
HORN_RADIUS = 7.6  # of brackets' round ends, too
PLATE_IN, PLATE_OUT = 10.4, 11.9  # plates that are screwed on the case's ends, within the tabs


# --- parts that several links share


def servo():
    outline = hull(circle(5.0, (-4.0, 4.0), 12), circle(5.0, (-4.0, -4.0), 12), circle(2.5, (20.0, 6.5), 8), circle(2.5, (20.0, -6.5), 8))
    slabs = [tapered_slab(outline, z0, z1) for z0, z1 in ((-10.5, -6.0), (-6.1, 6.1), (6.0, 10.5))]
    boss = [(0, 10.2), (6.6, 10.2), (6.6, 11.0), (0, 11.0)]
    screws = [move(screw(1.5, 0.9), x, y, 10.2) for x in (19.6,) for y in (6.2, -6.2)]
    ends = join(turned(boss, 12), *screws)
    plugs = join(block(22.0, 23.6, -6.5, -0.7, -3.0, 3.0, 0.4, 0.3, 1), block(22.0, 23.6, 0.7, 6.5, -3.0, 3.0, 0.4, 0.3, 1))
    return join(*slabs, ends, turn(ends, DOWN), plugs)


def servo_label():
    """The maker's stripe and two lines of print on both narrow sides of the case."""
    lines = [plate_y(rectangle(x0, x1, z0, z1), 8.8, 9.15) for x0, x1, z0, z1 in ((4.5, 17.5, 1.6, 4.0), (4.5, 14.0, -1.2, -0.1), (4.5, 11.0, -3.4, -2.3))]
    return both_sides(join(*lines))


def tapered_slab(outline, z0, z1, bevel=0.45):
    small = inset(outline, bevel)
    return loft([(z0, small), (z0 + bevel, outline), (z1 - bevel, outline), (z1, small)])


def screw(radius, height, corners=6):
    return turned([(0, 0), (radius, 0), (radius - 0.15, height), (0, height)], corners)


def horn():
    """In the servo's frame: a disc on the boss, with four screws and a middle one through the bracket."""
    rim = turned([(0, HORN), (7.2, HORN), (7.2, TAB + 0.1), (0, TAB + 0.1)], 18)
    screws = [move(screw(1.25, 2.4), 4.9 * c, 4.9 * s, TAB) for c, s in ((0.7071, 0.7071), (-0.7071, 0.7071), (-0.7071, -0.7071), (0.7071, -0.7071))]
    socket = turned([(0, TAB), (2.3, TAB), (2.3, 14.4), (2.0, 14.7), (1.2, 14.7), (1.1, 13.9), (0, 13.9)], 8)
    return join(rim, *screws, socket)


def horns():
    return join(horn(), turn(horn(), DOWN))


def bend(radius_in=0.5, steps=3):
    """The section of a bend of the sheet from the direction -y to +z, about the origin: outside in the quadrant y > 0, z < 0."""
    return arc_band(radius_in, radius_in + SHEET, -90, 0, steps)


def fork(foot=20.0, half_depth=8.5):
    """A U of sheet metal about the joint's y axis: two tabs on the horns, a foot across at z = -foot."""
    outline = hull(circle(HORN_RADIUS), rectangle(-half_depth, half_depth, 0.1 - foot, 2.0 - foot))
    waist = hull(circle(2.2, (-3.2, -12.6), 8), circle(2.2, (3.2, -12.6), 8))
    tabs = both_sides(plate_y(outline, TAB, TAB_OUT, [circle(3.4, corners=12), waist], 0.2))
    corner = bend() + np.array([TAB_OUT - 2.0, 0.5 - foot])
    bends = both_sides(plate_x(corner, -half_depth, half_depth))
    across = plate_z(rectangle(-half_depth, half_depth, -TAB_OUT + 1.8, TAB_OUT - 1.8), -foot - SHEET, -foot, [circle(4.0, corners=12)])
    return join(tabs, bends, across)


def strut(top, bottom, half_depth=7.6):
    """Two plates from a fork's foot at z = top to the case of the servo below, z = bottom; windows and rivets."""
    outline = hull(rectangle(-half_depth, half_depth, top - 6, top), rectangle(-6.8, 6.8, bottom, bottom + 4, 1.5, 2))
    middle = (top + bottom + 8) / 2
    window = hull(circle(3.6, (0, middle + 4.5), 12), circle(3.6, (0, middle - 2.0), 12))
    plates = both_sides(plate_y(outline, PLATE_IN, PLATE_OUT, [window], 0.2))
    rivets = [move(turn(screw(1.1, 0.6), ALONG_Y), x, PLATE_OUT - 0.2, bottom + 2.6) for x in (-4.6, 4.6)]
    posts = [move(turn(disc(2.0, -10.6, 10.6, 0.2, 8), ALONG_Y), x, 0, top - 5.0) for x in (-4.8, 4.8)]
    return join(plates, both_sides(join(*rivets)), *posts)


# --- legs


def hip_yaw_bracket():
    outline = hull(circle(HORN_RADIUS), rectangle(-34.7, -12.6, -8.7, 8.7))
    holes = [circle(2.0, (-26, -4.5), 10), circle(2.0, (-26, 4.5), 10), circle(2.6, corners=12)]
    top = plate_z(outline, YAW_PLATE, YAW_PLATE + SHEET, holes, 0.2)
    tab = plate_y(hull(rectangle(-34.7, -12.6, YAW_PLATE - 2, YAW_PLATE - 0.3), rectangle(-32, -15, 2, 5, 1, 2)), 8.9, 8.9 + SHEET,
                  [circle(3.4, (-23.6, 13), 12)], 0.2)
    corner = np.array([[1, 0], [0, -1]]) @ bend().T
    corner = corner.T[::-1] + np.array([8.4, YAW_PLATE - 0.5])
    tabs = join(tab, plate_x(corner, -34.7, -12.6))
    rivets = join(*[move(turn(screw(1.3, 0.8), ALONG_Y), x, 10.2, z) for x in (-29.5, -17.5) for z in (5.5, 19.5)])
    pad = block(-32, -15, -6.5, 6.5, 22.0, YAW_PLATE + 0.2, 1, 0.3)
    return join(top, both_sides(join(tabs, rivets)), pad)


YAW_SERVO = 39.8               # height of the middle of the hip yaw servo above the hips
YAW_PLATE = YAW_SERVO - TAB_OUT
ROLL_SERVO = -22.7             # x of the middle of the hip roll servo


def hip_roll_bracket():
    x0 = ROLL_SERVO + TAB
    back = plate_x(hull(circle(HORN_RADIUS), rectangle(-9.9, 9.9, 9, 21)), x0, x0 + SHEET, (), 0.2)
    tab = plate_y(hull(rectangle(x0 + 2, x0 + 3, 9, 21), rectangle(2, 5, 10, 20, 1.5, 2)), PLATE_IN, PLATE_OUT,
                  [circle(2.2, (-2.0, 15.0), 10)], 0.2)
    edge = arc_band(0.5, 0.5 + SHEET, 90, 180, 4, (x0 + 2.0, 9.9))
    rivets = join(*[move(turn(screw(1.1, 0.6), ALONG_Y), 2.6, PLATE_OUT - 0.2, z) for z in (12.4, 17.6)])
    return join(back, both_sides(join(tab, plate_z(edge, 9, 21), rivets)))


def thigh_cover():
    front = rounded((-56.0, 7.5, 10.0, -6.5, 6.5, 1.0), (-54.5, 6.0, 11.0, -8.0, 8.0, 1.8), (-40.0, 4.5, 12.4, -10.2, 10.2, 2.6),
                    (-26.0, 4.5, 12.4, -10.2, 10.2, 2.6), (-19.5, 5.0, 11.2, -8.6, 8.6, 2.2), (-17.5, 6.0, 9.8, -7.0, 7.0, 1.2))
    side = tapered_side(-24.5, -43.0)
    return join(front, both_sides(side))


def tapered_side(top, bottom):
    outline = hull(rectangle(-4.0, 6.0, bottom, top), rectangle(-6.5, 6.8, bottom + 5, top - 3))
    return plate_y(outline, PLATE_OUT - 0.2, PLATE_OUT + 1.7, (), 0.7)


def thigh_stripe():
    return tapered((-49.0, 10.0, 12.35, -1.2, 1.2, 0.4), (-40.0, 10.0, 12.95, -2.4, 2.4, 0.6), (-27.0, 10.0, 12.95, -2.4, 2.4, 0.6),
                   (-21.0, 9.0, 12.05, -2.0, 2.0, 0.4))


def shank_cover():
    front = rounded((-56.5, 7.0, 10.0, -6.0, 6.0, 1.0), (-54.5, 5.5, 11.2, -8.0, 8.0, 2.0), (-38.0, 4.5, 13.2, -11.6, 11.6, 3.0),
                    (-24.0, 4.5, 13.6, -12.0, 12.0, 3.0), (-15.5, 5.5, 12.2, -9.5, 9.5, 2.4), (-12.5, 7.0, 10.8, -7.5, 7.5, 1.4))
    return join(front, both_sides(tapered_side(-25.0, -42.0)))


def shank_stripe():
    return join(tapered((-22.0, 9.0, 14.1, -8.6, 8.6, 1.2), (-20.5, 9.0, 14.2, -9.4, 9.4, 1.4), (-16.4, 9.0, 13.2, -8.0, 8.0, 1.2),
                        (-15.0, 9.0, 12.6, -7.0, 7.0, 1.0)),
                tapered((-48.0, 9.0, 12.7, -1.0, 1.0, 0.4), (-38.0, 9.0, 13.8, -1.8, 1.8, 0.5), (-26.0, 9.0, 14.1, -2.0, 2.0, 0.5)))


def leg_core(top, bottom):
    """Wiring between the plates."""
    cables = [tube(curve((x, y, bottom - 1.0), (x - 0.8, 1.2 * y, (top + bottom) / 2), (x, y, top + 1.5), steps=3), 1.2)
              for x, y in ((-3.2, -3.6), (-3.2, 3.6), (-1.0, -1.2))]
    return join(block(-1.0, 5.2, -8.2, 8.2, bottom - 1.0, top + 0.5, 1.0, 0.6), *cables)


ANKLE_SERVO = -24.5            # x of the middle of the ankle roll servo


def ankle_bracket():
    arm = hull(circle(HORN_RADIUS), rectangle(-34.5, -30, -7.0, 5.5, 1.2, 2), circle(2.0, (-13, -3)))
    holes = [circle(3.4, corners=16), hull(circle(2.0, (-19.5, 0), 10), circle(2.0, (-26.0, 0), 10))]
    rivets = [move(turn(screw(1.2, 0.8), ALONG_Y), x, TAB_OUT - 0.2, z) for x, z in ((-15.8, 2.6), (-31.8, 3.0), (-31.8, -4.4))]
    posts = [move(turn(disc(2.6, 8.5, TAB + 0.2, 0.2, 10), ALONG_Y), x, 0, z) for x, z in ((-17.0, 0), (-31.5, 0))]
    return both_sides(join(plate_y(arm, TAB, TAB_OUT, holes, 0.2), *rivets, *posts))


def foot_bracket():
    front, foot = ANKLE_SERVO + TAB, -32.0
    tab = plate_x(hull(circle(HORN_RADIUS), rectangle(-10.5, 10.5, foot + 0.1, foot + 2)), front, front + SHEET,
                  [circle(3.4, corners=16), hull(circle(2.4, (-3.0, -19), 10), circle(2.4, (3.0, -19), 10), circle(1.6, (0, -14), 10))], 0.2)
    corner = bend() + np.array([front - 0.5, 0.5 + foot])  # in x and z
    edge = plate_y(corner, -10.5, 10.5)
    half = join(tab, edge)
    half = move(half, -ANKLE_SERVO)
    halves = join(half, turn(half, np.diag([-1, -1, 1])))
    across = plate_z(rectangle(-12.0, 12.0, -10.5, 10.5), foot - SHEET, foot, [circle(2.0, (8, 6), 8), circle(2.0, (-8, -6), 8)])
    screws = join(*[move(screw(1.6, 1.4), x, y, foot - 0.3) for x, y in ((-8, 6), (8, -6))])
    deck = plate_z(rectangle(-37.0, 61.0, -27.0, 27.0, 8.0, 4), -37.8, -36.0, [circle(4, (0, 18), 14), circle(4, (0, -18), 14)], 0.4)
    return join(move(join(halves, across, screws), ANKLE_SERVO), deck)


def foot_sensor():
    """The six-axis sensor between bracket and deck."""
    return join(move(turned([(0, -36.3), (11.0, -36.3), (11.0, -35.6), (9.5, -35.2), (9.5, -34.6), (11.0, -34.2), (11.0, -33.4), (0, -33.4)], 24),
                     ANKLE_SERVO), tube(curve((ANKLE_SERVO, -9, -35), (-17, -15, -34), (-8, -12, -33), (-4, -10, -35.9), steps=4), 1.0))


def foot_sole():
    return plate_z(rectangle(-38.0, 62.0, -28.0, 28.0, 9.0, 5), -40.0, -37.6, (), 0.6)


def foot_cover():
    toe = rounded((-36.4, 5.0, 60.5, -26.5, 26.5, 8.0), (-34.0, 5.0, 61.0, -27.0, 27.0, 8.0), (-31.0, 6.5, 58.5, -26.0, 26.0, 8.0),
                  (-25.2, 12.0, 44.0, -20.0, 20.0, 7.0), (-24.0, 14.0, 41.5, -18.0, 18.0, 6.0), steps=5)
    rail = tapered((-36.4, -37.0, 7.0, 17.5, 26.8, 4.0), (-33.0, -36.6, 7.0, 17.5, 26.6, 4.0), (-29.5, -33.0, 7.0, 18.5, 24.5, 2.5),
                   (-28.7, -31.0, 7.0, 19.5, 23.5, 1.5))
    return join(toe, both_sides(rail))


def foot_stripe():
    band = tapered((-31.5, 50.0, 59.3, -10.0, 10.0, 1.5), (-30.6, 49.0, 58.1, -10.0, 10.0, 1.5), (-25.2, 36.0, 45.6, -8.0, 8.0, 1.5),
                   (-23.6, 33.0, 41.8, -7.0, 7.0, 1.5), (-23.3, 33.6, 41.0, -6.4, 6.4, 1.2))
    return band


# --- arms


def shoulder_bracket():
    """Of the left side; the servo lies towards the trunk."""
    y0 = -24.0
    end = plate_y(hull(circle(HORN_RADIUS), rectangle(-7.5, 7.5, -8.4, 8.4)), y0, y0 + SHEET, (), 0.2)
    tab = plate_z(hull(rectangle(-7.5, 7.5, y0 + 2, y0 + 3), rectangle(-5.5, 5.5, -9, -6, 1.5, 2)), 8.9, 8.9 + SHEET, [circle(3.0, (0, -14.5), 12)], 0.2)
    edge = plate_x(arc_band(0.5, 0.5 + SHEET, 90, 180, 4, (y0 + 2.0, 8.4)), -7.5, 7.5)
    upper = join(tab, edge)
    return join(end, upper, turn(upper, np.diag([-1, 1, -1])))


def shoulder_cover():
    return tapered((10.0, -9.5, 9.5, -23.0, 6.0, 3.0), (11.0, -11.0, 11.0, -24.0, 7.0, 3.5), (14.0, -11.0, 11.0, -23.5, 6.5, 4.0),
                   (16.0, -9.2, 9.2, -21.0, 4.0, 3.5), (16.8, -7.4, 7.4, -18.5, 1.5, 3.0), steps=4)


def shoulder_stripe():
    return move(turned([(0, 15.5), (5.2, 15.5), (5.2, 17.0), (4.6, 17.4), (0, 17.4)], 20), 0, -8.5)


def upper_arm_cover():
    return tapered((-47.5, -7.6, 7.6, -10.8, 10.8, 2.5), (-46.5, -8.6, 8.6, -12.2, 12.2, 3.0), (-34.0, -10.2, 10.2, -13.2, 13.2, 3.5),
                   (-25.0, -10.2, 10.2, -13.2, 13.2, 3.5), (-22.0, -9.0, 9.0, -12.2, 12.2, 3.0), (-21.2, -8.0, 8.0, -11.2, 11.2, 2.5))


def upper_arm_stripe():
    return both_sides(plate_y(hull(rectangle(-4.6, 4.6, -36, -28, 1.5, 2), rectangle(-3.0, 3.0, -41, -28, 1.0, 2)), 12.9, 13.8, (), 0.3))


def forearm_cover():
    return tapered((-60.5, -6.4, 6.4, -6.4, 6.4, 2.5), (-59.5, -7.2, 7.2, -7.2, 7.2, 3.0), (-40.0, -9.4, 9.4, -9.8, 9.8, 4.0),
                   (-27.0, -10.0, 10.0, -11.0, 11.0, 4.0), (-22.2, -9.2, 9.2, -11.0, 11.0, 3.5), (-20.8, -8.0, 8.0, -9.8, 9.8, 3.0), steps=4)


def forearm_stripe():
    return tapered((-55.4, -7.4, 7.4, -7.4, 7.4, 3.0), (-54.9, -7.9, 7.9, -8.0, 8.0, 3.3), (-51.4, -8.3, 8.3, -8.5, 8.5, 3.5), (-50.9, -8.0, 8.0, -8.2, 8.2, 3.2),
                   steps=4)


def hand():
    """A gripper: a palm, two fingers at the front that bend inwards, a thumb behind them."""
    wrist = turned([(0, -66.5), (4.4, -66.5), (5.0, -66.0), (5.0, -64.0), (4.3, -63.4), (4.3, -62.8), (5.0, -62.2), (5.0, -60.0), (0, -60.0)], 16)
    palm = tapered((-76.0, -6.0, 6.0, -7.5, 7.5, 1.5), (-75.0, -7.0, 7.0, -8.5, 8.5, 2.0), (-69.0, -7.0, 7.0, -8.5, 8.5, 2.0), (-66.0, -5.0, 5.0, -6.0, 6.0, 2.0))

    def finger(x0, x1, reach):
        return tapered((-95.0, x0 + 1.0, x1 - 1.0, 0.8, 3.2, 0.8), (-93.0, x0 + 0.4, x1 - 0.4, 0.6, 5.0, 1.0), (-86.0, x0, x1, reach, reach + 4.2, 1.2),
                       (-80.0, x0, x1, reach - 0.4, reach + 4.2, 1.2), (-74.0, x0 + 0.4, x1 - 0.4, 2.6, 7.4, 1.2), steps=2)

    return join(wrist, palm, both_sides(join(finger(0.6, 6.4, 4.6), finger(-6.4, -0.6, 4.6))))


# --- trunk and head


def trunk_frame():
    """Sheet metal: side plates, decks and the pelvis."""
    side = hull(rectangle(-15.0, 11.0, 50.5, 60), rectangle(-12.0, 10.0, 60, 117.5))
    windows = [rectangle(-8.5, 6.5, 56, 68, 2.5, 2), rectangle(-8.0, 6.0, 73, 92, 2.5, 2)]
    sides = both_sides(plate_y(side, 20.5, 22.0, windows, 0.2))
    deck = plate_z(rectangle(-24.0, 12.0, -40.0, 40.0, 4.0, 2), 50.0, 51.5, [circle(3, (-18, 14), 10), circle(3, (-18, -14), 10)], 0.2)
    cheek = plate_y(hull(rectangle(-23.0, 9.5, 44, 49.5), rectangle(-18.0, 6.0, 33, 36, 1.5, 2)), 38.8, 40.3, [circle(3.2, (-7.0, 42), 14)], 0.2)
    edge = plate_x(arc_band(0.5, 0.5 + SHEET, 0, 90, 4, (38.3, 49.5)), -23.0, 9.5)
    rivets = join(*[move(turn(screw(1.2, 0.8), ALONG_Y), x, 40.1, 46) for x in (-17.5, 4.0)])
    shoulder = plate_z(rectangle(-14.0, 10.0, -44.0, 44.0, 3.0, 2), 129.2, 130.7, [circle(3.0, (0, 33.7), 12), circle(3.0, (0, -33.7), 12)], 0.2)
    lower = both_sides(plate_z(rectangle(-10.0, 9.0, 21.0, 43.5, 2.0, 2), 96.0, 97.5, (), 0.2))
    collar = turned([(0, 130.0), (15.0, 130.0), (15.0, 134.5), (14.0, 135.5), (11.0, 135.5), (11.0, 134.0), (0, 134.0)], 28)
    return join(sides, deck, both_sides(join(cheek, edge, rivets)), shoulder, lower, collar)


def trunk_core():
    """The pelvis between the yaw servos, the belly with its ribs, the boards, cables to legs and arms."""
    pelvis = block(-22.0, 9.0, -20.0, 20.0, 32.0, 50.3, 2.0, 1.0)
    ribs = join(*[tapered((z, -14.0, 13.5, -24.0, 24.0, 4.0), (z + 0.9, -15.5, 15.0, -25.5, 25.5, 5.0), (z + 3.3, -15.5, 15.0, -25.5, 25.5, 5.0),
                          (z + 4.2, -14.0, 13.5, -24.0, 24.0, 4.0)) for z in (51.0, 55.0, 59.0, 63.0, 67.0)])
    boards = block(-9.0, 9.0, -19.5, 19.5, 70.0, 117.0, 1.0, 0.5)
    cable = join(tube(curve((-22, 20, 66), (-27, 24, 60), (-25, 29, 54), (-21.8, 30, 46), steps=3), 1.5),
                 tube(curve((-22, 16, 66), (-26.5, 20, 59), (-24.5, 25, 53), (-21.8, 26.5, 44), steps=3), 1.5),
                 tube(curve((-20, 28, 112), (-17, 35, 112), (-11, 38, 106), (-4, 36, 100), steps=3), 1.5))
    return join(pelvis, ribs, boards, both_sides(cable))


def chest_cover():
    chest = rounded((76.0, 10.0, 22.0, -22.0, 22.0, 4.0), (78.0, 9.0, 25.0, -26.0, 26.0, 5.0), (90.0, 9.3, 30.0, -36.5, 36.5, 7.0),
                    (96.0, 9.3, 31.0, -38.5, 38.5, 7.5), (120.0, 9.3, 31.0, -39.0, 39.0, 8.0), (128.0, 9.3, 28.5, -37.0, 37.0, 8.0),
                    (133.0, 9.3, 23.0, -32.0, 32.0, 6.0), (134.5, 9.6, 19.0, -29.0, 29.0, 4.0), steps=6)
    abdomen = rounded((56.5, 13.0, 18.5, -13.0, 13.0, 2.5), (58.0, 12.5, 20.0, -15.0, 15.0, 3.5), (72.5, 12.5, 23.5, -21.0, 21.0, 4.0),
                      (74.5, 12.5, 22.0, -19.5, 19.5, 3.5))
    skirt = rounded((33.0, 9.5, 15.5, -27.0, 27.0, 2.5), (35.0, 8.8, 18.0, -31.0, 31.0, 4.0), (49.0, 8.8, 21.0, -38.5, 38.5, 5.0),
                    (53.0, 9.0, 19.5, -37.5, 37.5, 4.5), (54.0, 10.0, 17.5, -35.5, 35.5, 3.0), steps=4)
    top = tapered((130.3, -14.0, 9.6, -22.0, 22.0, 3.0), (133.0, -14.0, 9.6, -21.0, 21.0, 3.0), (134.5, -12.0, 9.6, -18.0, 18.0, 2.0))
    return join(chest, abdomen, skirt, top)


EMBLEM = 107.0  # height of the middle of the chest's emblem


def chest_stripe():
    disc_ = move(turn(turned([(0, 29.5), (8.6, 29.5), (8.6, 31.8), (7.6, 32.3), (0, 32.3)], 28), ALONG_X), 0, 0, EMBLEM)
    shoulders = both_sides(plate_x(hull(rectangle(17.5, 34.5, 113.5, 117.0, 0.8, 2), rectangle(23.0, 35.5, 117, 121.0, 0.8, 2)), 30.0, 31.5, (), 0.3))
    buckle = tapered((38.5, 16.0, 20.0, -5.0, 5.0, 1.0), (40.0, 16.0, 21.0, -6.5, 6.5, 1.4), (48.0, 16.0, 22.2, -8.0, 8.0, 1.6), (49.5, 16.0, 21.6, -7.0, 7.0, 1.2))
    battery = tapered((70.0, -33.6, -28.0, -20.0, 20.0, 2.0), (71.2, -34.6, -28.0, -21.5, 21.5, 2.6), (91.8, -34.6, -28.0, -21.5, 21.5, 2.6),
                      (93.0, -33.6, -28.0, -20.0, 20.0, 2.0))
    return join(disc_, shoulders, buckle, battery)


def chest_gold():
    """The ring of the emblem, and in it the weighted doll that rises again: a drop with its face."""
    ring = turned([(0, 29.0), (10.6, 29.0), (10.6, 32.0), (10.0, 32.6), (9.0, 32.6), (8.5, 32.0), (8.5, 30.5), (0, 30.5)], 32)
    body = hull(circle(4.6, (0, EMBLEM - 1.6), 24), circle(2.6, (0, EMBLEM + 3.0), 16))
    return join(move(turn(ring, ALONG_X), 0, 0, EMBLEM), plate_x(body, 32.0, 32.9, [circle(2.3, (0, EMBLEM + 1.2), 16)], 0.2))


def chest_dark():
    """Vents, and what the backpack carries."""
    vents = both_sides(join(*[plate_x(np.array([[16.0 + s, z], [30.0 + s, z + 1.6], [30.0 + s, z + 3.4], [16.0 + s, z + 1.8]]), 29.2, 31.3, (), 0.2)
                              for s, z in ((0, 91.5), (0.6, 95.2), (1.2, 98.9))]))
    pack = tapered((63.0, -25.0, -10.0, -24.0, 24.0, 3.0), (65.0, -28.0, -9.6, -27.0, 27.0, 4.0), (72.0, -30.0, -9.6, -30.0, 30.0, 5.0),
                   (118.0, -30.0, -9.6, -30.0, 30.0, 5.0), (128.0, -26.0, -9.6, -27.0, 27.0, 4.0), (130.0, -24.0, -10.0, -25.0, 25.0, 3.0))
    fins = join(*[block(-31.2, -29.0, -17.0, 17.0, z, z + 1.6, 0.5, 0.3, 1) for z in (101.0, 104.2, 107.4, 110.6)])
    switch = join(block(-32.0, -29.0, 20.0, 26.0, 106.0, 114.0, 0.8, 0.4), block(-31.6, -29.0, -26.5, -20.0, 104.0, 113.0, 0.8, 0.4))
    return join(vents, pack, fins, switch)


def neck_bracket():
    """A plate on the pan servo's horn, and two tabs beside the tilt servo, which lies above it."""
    base = plate_z(hull(circle(HORN_RADIUS), rectangle(-20.5, -8.5, -9.9, 9.9)), -SHEET, 0.0, [circle(2.6, (-14.5, 0), 12)], 0.2)
    tab = plate_y(hull(rectangle(-20.5, -8.5, 0.4, 2.0), rectangle(-20.0, -9.5, 20, 25, 2.0, 2)), PLATE_IN, PLATE_OUT, [circle(2.6, (-14.5, 8.0), 12)], 0.2)
    edge = plate_x(bend() + np.array([PLATE_OUT - 2.0, 0.5]), -20.5, -8.5)
    rivets = join(*[move(turn(screw(1.1, 0.6), ALONG_Y), x, PLATE_OUT - 0.2, 18.0) for x in (-17.5, -12.5)])
    pillar = block(-7.0, 5.0, -5.5, 5.5, -0.3, 9.4, 1.5, 0.4)
    return join(base, both_sides(join(tab, edge, rivets)), pillar)


TILT_SERVO = 18.0
FACE = (0.0, 26.0)  # y and z of the middle of the face, and of the head


def head_frame():
    tab = plate_y(hull(circle(HORN_RADIUS), rectangle(-8.5, 8.5, 12, 16)), TAB, TAB_OUT, [circle(3.4, corners=16)], 0.2)
    ear = turned([(0, 25.0), (8.5, 25.0), (8.5, 29.4), (7.5, 30.4), (5.6, 30.4), (5.2, 29.6), (0, 29.6)], 24)
    return both_sides(join(tab, move(turn(ear, ALONG_Y), -3.0, 0, FACE[1])))


def head_outline(scale, corners=52):
    return superellipse(27.6 * scale, 21.6 * scale, 2.6, (0.0, FACE[1] + 2.0), corners)


def helmet():
    sections = [(-25.0, 0.2), (-24.6, 0.38), (-23.7, 0.52), (-22.2, 0.64), (-20.0, 0.75), (-17.0, 0.84), (-13.0, 0.92), (-8.0, 0.975), (-2.0, 1.0), (8.0, 1.0), (15.0, 0.975), (17.5, 0.955)]
    shell = loft_x([(x, head_outline(s)) for x, s in sections])
    rim = plate_x(head_outline(0.955), 17.0, 23.0, [face_outline(0.0)], 1.6)
    crest = loft_x([(-21.0, superellipse(1.6, 1.6, 2.5, (0, 42.5), 12)), (-14.0, superellipse(2.6, 2.6, 2.5, (0, 46.6), 12)), (0.0, superellipse(3.2, 2.6, 2.5, (0, 49.0), 12)),
                    (14.0, superellipse(3.2, 2.6, 2.5, (0, 48.2), 12)), (21.0, superellipse(2.4, 1.8, 2.5, (0, 46.2), 12))])
    return join(shell, rim, crest)


def face_outline(grow):
    return superellipse(21.6 + grow, 14.6 + grow, 3.0, (0.0, FACE[1]), 36)


def face_plate():
    """The face, and a glint in each eye."""
    glints = [move(turn(disc(1.1, 20.0, 22.3, 0.2, 10), ALONG_X), 0, y + 1.7, EYE[1] + 1.7) for y in (EYE[0], -EYE[0])]
    return join(plate_x(face_outline(0.5), 16.5, 19.6), *glints)


EYE = (9.4, 27.2)


def face_dark():
    """Eyes' rims, a daruma's brows, mouth and the camera in the forehead."""
    eye = move(turn(turned([(0, 19.0), (6.6, 19.0), (6.6, 20.8), (6.0, 21.4), (4.9, 21.4), (4.5, 20.6), (0, 20.6)], 24), ALONG_X), 0, *EYE)
    mouth = plate_x(hull(circle(0.9, (-4.5, 15.6), 8), circle(0.9, (4.5, 15.6), 8)), 19.2, 20.3)
    camera = move(turn(turned([(0, 21.0), (2.6, 21.0), (2.6, 23.8), (2.1, 24.2), (1.5, 24.2), (1.3, 23.4), (0, 23.4)], 14), ALONG_X), 0, 0, 43.6)
    ears = both_sides(move(turn(turned([(0, 29.0), (4.6, 29.0), (4.6, 30.2), (4.0, 30.6), (0, 30.6)], 18), ALONG_Y), -3.0, 0, FACE[1]))
    mast = move(turned([(0, 0.0), (1.5, 0.0), (1.5, 5.0), (0.7, 6.0), (0.6, 19.0), (0, 19.0)], 8), -3.0, 28.0, FACE[1] + 7.5)
    brow = plate_x(arc_band(7.8, 10.4, 48, 132, 10, EYE), 19.2, 20.8)
    return join(both_sides(join(eye, brow)), mouth, camera, ears, mast)


def face_lens():
    return both_sides(move(turn(turned([(0, 20.2), (4.7, 20.2), (4.4, 21.0), (3.2, 21.6), (1.6, 21.9), (0, 22.0)], 20), ALONG_X), 0, *EYE))


def face_gold():
    """A daruma's whiskers; the tip of the antenna."""
    whisker = join(*[plate_x(arc_band(r, r + 1.2, -88 - s, -40 + s, 7, EYE), 19.2, 20.4) for r, s in ((8.2, 0), (10.4, 6))])
    tip = move(turned([(0, -1.8), (1.2, -1.4), (1.8, 0.0), (1.2, 1.4), (0, 1.8)], 10), -3.0, 28.0, FACE[1] + 27.0)
    return join(both_sides(whisker), tip)


PARTS = {
    "servo": servo, "servo_label": servo_label, "horn": horn, "horns": horns, "fork": fork,
    "leg_strut": lambda: strut(-20.4, -55.0), "arm_strut": lambda: strut(-20.4, -60.0),
    "leg_core": lambda: leg_core(-21.3, -42.7),
    "hip_yaw_bracket": hip_yaw_bracket, "hip_roll_bracket": hip_roll_bracket,
    "thigh_cover": thigh_cover, "thigh_stripe": thigh_stripe, "shank_cover": shank_cover, "shank_stripe": shank_stripe,
    "ankle_bracket": ankle_bracket, "foot_bracket": foot_bracket, "foot_sensor": foot_sensor, "foot_sole": foot_sole,
    "foot_cover": foot_cover, "foot_stripe": foot_stripe,
    "shoulder_bracket": shoulder_bracket, "shoulder_cover": shoulder_cover, "shoulder_stripe": shoulder_stripe,
    "upper_arm_cover": upper_arm_cover, "upper_arm_stripe": upper_arm_stripe,
    "forearm_cover": forearm_cover, "forearm_stripe": forearm_stripe, "hand": hand,
    "trunk_frame": trunk_frame, "trunk_core": trunk_core, "chest_cover": chest_cover, "chest_stripe": chest_stripe,
    "chest_gold": chest_gold, "chest_dark": chest_dark,
    "neck_bracket": neck_bracket, "head_frame": head_frame, "helmet": helmet, "face_plate": face_plate, "face_dark": face_dark,
    "face_lens": face_lens, "face_gold": face_gold,
}


# --- where the parts are


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
    return [each for v in visuals for each in ([v, (v[0].replace("servo", "label"), "servo_label", "label", *v[3:])] if v[1] == "servo" else [v])]


def horn_at(kind, x, y, z, shaft, case="+x"):
    return (kind, kind, "steel", (x, y, z), frame(shaft, case))


def part(name, colour, x=0.0, y=0.0, z=0.0, rotation=None):
    return (name, name, colour, (x, y, z), np.eye(3) if rotation is None else rotation)


HALF_TURN = np.diag([-1.0, -1.0, 1.0])
QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
SHOULDER_SERVO = 70.0 - 24.0 - TAB  # y of the middle of the shoulder pitch servo in the trunk
PAN_SERVO = 142.0 - TAB_OUT         # z of the middle of the pan servo in the trunk


def layout():
    """For each link its visuals: name, part, colour, position and rotation."""
    links = {
        "trunk": [part("trunk_frame", "sheet"), part("trunk_core", "dark"), part("chest_cover", "cover"), part("chest_stripe", "red"),
                  part("chest_gold", "gold"), part("chest_dark", "dark"),
                  servo_at("left_hip_yaw", 0, 30, YAW_SERVO, "-z", "-x"), servo_at("right_hip_yaw", 0, -30, YAW_SERVO, "-z", "-x"),
                  servo_at("left_shoulder_pitch", 0, SHOULDER_SERVO, 120, "+y", "-z"),
                  servo_at("right_shoulder_pitch", 0, -SHOULDER_SERVO, 120, "-y", "-z"), servo_at("head_pan", 0, 0, PAN_SERVO, "+z", "-x")],
        "neck": [horn_at("horn", 0, 0, PAN_SERVO - 142.0, "+z"), part("neck_bracket", "sheet"),
                 servo_at("head_tilt", 0, 0, TILT_SERVO, "+y", "-x")],
        "head": [horn_at("horns", 0, 0, 0, "+y"), part("head_frame", "sheet"), part("helmet", "red"), part("face_plate", "cover"),
                 part("face_dark", "dark"), part("face_lens", "lens"), part("face_gold", "gold")],
    }
    for side, sign in (("left", 1), ("right", -1)):
        outward, inward = ("+y", "-y") if sign > 0 else ("-y", "+y")
        mirrored = np.eye(3) if sign > 0 else HALF_TURN
        links |= {
            f"{side}_hip_yaw_link": [horn_at("horn", 0, 0, YAW_SERVO, "-z"), part("hip_yaw_bracket", "sheet"),
                                     servo_at("hip_roll", ROLL_SERVO, 0, 0, "+x", "+z")],
            f"{side}_hip_roll_link": [horn_at("horn", ROLL_SERVO, 0, 0, "+x", "+z"), part("hip_roll_bracket", "sheet"),
                                      servo_at("hip_pitch", 0, 0, 0, outward, "+z")],
            f"{side}_thigh": [horn_at("horns", 0, 0, 0, outward), part("fork", "sheet"), part("leg_strut", "sheet"), part("leg_core", "dark"),
                              part("thigh_cover", "cover"), part("thigh_stripe", "red"), servo_at("knee", 0, 0, -65, outward, "+z")],
            f"{side}_shank": [horn_at("horns", 0, 0, 0, outward), part("fork", "sheet"), part("leg_strut", "sheet"), part("leg_core", "dark"),
                              part("shank_cover", "cover"), part("shank_stripe", "red"), servo_at("ankle_pitch", 0, 0, -65, outward, "+z")],
            f"{side}_ankle_link": [horn_at("horns", 0, 0, 0, outward), part("ankle_bracket", "sheet"),
                                   servo_at("ankle_roll", ANKLE_SERVO, 0, 0, "+x", "-z")],
            f"{side}_foot": [horn_at("horns", ANKLE_SERVO, 0, 0, "+x", "+z"), part("foot_bracket", "sheet"), part("foot_sensor", "steel"),
                             part("foot_sole", "rubber"), part("foot_cover", "cover"), part("foot_stripe", "red")],
            f"{side}_shoulder_link": [horn_at("horn", 0, sign * (SHOULDER_SERVO - 70.0), 0, outward), part("shoulder_bracket", "sheet", rotation=mirrored),
                                      part("shoulder_cover", "cover", rotation=mirrored), part("shoulder_stripe", "red", rotation=mirrored),
                                      servo_at("shoulder_roll", 0, 0, 0, "+x", inward)],
            f"{side}_upper_arm": [horn_at("horns", 0, 0, 0, "+x", "+z"), part("fork", "sheet", rotation=QUARTER_TURN), part("arm_strut", "sheet"),
                                  part("upper_arm_cover", "cover"), part("upper_arm_stripe", "red"), servo_at("elbow", 0, 0, -70, outward, "+z")],
            f"{side}_forearm": [horn_at("horns", 0, 0, 0, outward), part("fork", "sheet"), part("forearm_cover", "cover"), part("forearm_stripe", "red"),
                                part("hand", "rubber")],
        }
    return {link: labelled(visuals) for link, visuals in links.items()}


def number(value):
    return f"{value:.6f}".rstrip("0").rstrip(".").replace("-0", "0") if abs(value) < 5e-7 else f"{value:.6f}".rstrip("0").rstrip(".")


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
    return (f'      <visual name="{name}">\n'
            f"        <pose>{pose(position, rotation)}</pose>\n"
            f"        <geometry><mesh><uri>meshes/{file}.stl</uri><scale>0.001 0.001 0.001</scale></mesh></geometry>\n"
            f"        <material><diffuse>{red_green_blue} 1</diffuse></material>\n"
            "      </visual>\n")


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
