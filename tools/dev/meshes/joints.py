"""The parts of the default robot's joints, in millimetres: servo, horns, and the sheet metal between two joints.

A joint's child carries the horns on the shaft and the bracket on the horns, its parent the case of the servo.
"""

import numpy as np

from meshes.solids import (
    ALONG_Y,
    arc_band,
    block,
    both_sides,
    circle,
    disc,
    DOWN,
    hull,
    inset,
    join,
    loft,
    move,
    plate_x,
    plate_y,
    plate_z,
    rectangle,
    turn,
    turned,
)

# The servo, in its own frame: z along the shaft, the case towards +x. KONDO's KRS-2552 is 41 x 21 x 30.5; the boxes of the
# links leave room for 31.5 x 18 x 21.
SHAFT_END, FAR_END, HALF_WIDTH, HALF_CASE = 9.0, 22.5, 9.0, 10.5
HORN = 10.8  # the inner face of a horn, along the shaft from the case's middle; the boss on the case reaches 11
TAB = 12.3  # the inner face of the bracket on the horn
SHEET = 1.5  # thickness
TAB_OUT = TAB + SHEET
HORN_RADIUS = 7.6  # of brackets' round ends, too
PLATE_IN, PLATE_OUT = 10.4, 11.9  # plates that are screwed on the case's ends, within the tabs


def servo():
    outline = hull(
        circle(5.0, (5.0 - SHAFT_END, HALF_WIDTH - 5.0), 12),
        circle(5.0, (5.0 - SHAFT_END, 5.0 - HALF_WIDTH), 12),
        circle(2.5, (FAR_END - 2.5, HALF_WIDTH - 2.5), 8),
        circle(2.5, (FAR_END - 2.5, 2.5 - HALF_WIDTH), 8),
    )
    slabs = [tapered_slab(outline, z0, z1) for z0, z1 in ((-HALF_CASE, -6.0), (-6.1, 6.1), (6.0, HALF_CASE))]
    boss = [(0, 10.2), (6.6, 10.2), (6.6, 11.0), (0, 11.0)]
    screws = [move(screw(1.5, 0.9), x, y, 10.2) for x in (19.6,) for y in (6.2, -6.2)]
    ends = join(turned(boss, 12), *screws)
    plugs = join(block(22.0, 23.6, -6.5, -0.7, -3.0, 3.0, 0.4, 0.3, 1), block(22.0, 23.6, 0.7, 6.5, -3.0, 3.0, 0.4, 0.3, 1))
    return join(*slabs, ends, turn(ends, DOWN), plugs)


def servo_label():
    """The maker's stripe and two lines of print on both narrow sides of the case."""
    lines = [
        plate_y(rectangle(x0, x1, z0, z1), 8.8, 9.15)
        for x0, x1, z0, z1 in ((4.5, 17.5, 1.6, 4.0), (4.5, 14.0, -1.2, -0.1), (4.5, 11.0, -3.4, -2.3))
    ]
    return both_sides(join(*lines))


def tapered_slab(outline, z0, z1, bevel=0.45):
    small = inset(outline, bevel)
    return loft([(z0, small), (z0 + bevel, outline), (z1 - bevel, outline), (z1, small)])


def screw(radius, height, corners=6):
    return turned([(0, 0), (radius, 0), (radius - 0.15, height), (0, height)], corners)


def horn():
    """In the servo's frame: a disc on the boss, with four screws and a middle one through the bracket."""
    rim = turned([(0, HORN), (7.2, HORN), (7.2, TAB + 0.1), (0, TAB + 0.1)], 18)
    screws = [
        move(screw(1.25, 2.4), 4.9 * c, 4.9 * s, TAB)
        for c, s in ((0.7071, 0.7071), (-0.7071, 0.7071), (-0.7071, -0.7071), (0.7071, -0.7071))
    ]
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
    across = plate_z(
        rectangle(-half_depth, half_depth, -TAB_OUT + 1.8, TAB_OUT - 1.8), -foot - SHEET, -foot, [circle(4.0, corners=12)]
    )
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


PARTS = {"servo": servo, "servo_label": servo_label, "horn": horn, "horns": horns, "fork": fork}
