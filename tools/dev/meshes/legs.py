"""The legs of the default robot: brackets, covers and feet in their links' frames, in millimetres."""

import numpy as np

from meshes.joints import bend, HORN_RADIUS, PLATE_IN, PLATE_OUT, screw, SHEET, strut, TAB, TAB_OUT
from meshes.solids import (
    ALONG_Y,
    arc_band,
    block,
    both_sides,
    circle,
    curve,
    disc,
    hull,
    join,
    move,
    plate_x,
    plate_y,
    plate_z,
    rectangle,
    rounded,
    tapered,
    tube,
    turn,
    turned,
)

YAW_SERVO = 39.8  # height of the middle of the hip yaw servo above the hips
YAW_PLATE = YAW_SERVO - TAB_OUT
ROLL_SERVO = -22.7  # x of the middle of the hip roll servo
ANKLE_SERVO = -24.5  # x of the middle of the ankle roll servo


def hip_yaw_bracket():
    outline = hull(circle(HORN_RADIUS), rectangle(-34.7, -12.6, -8.7, 8.7))
    holes = [circle(2.0, (-26, -4.5), 10), circle(2.0, (-26, 4.5), 10), circle(2.6, corners=12)]
    top = plate_z(outline, YAW_PLATE, YAW_PLATE + SHEET, holes, 0.2)
    tab = plate_y(
        hull(rectangle(-34.7, -12.6, YAW_PLATE - 2, YAW_PLATE - 0.3), rectangle(-32, -15, 2, 5, 1, 2)),
        8.9,
        8.9 + SHEET,
        [circle(3.4, (-23.6, 13), 12)],
        0.2,
    )
    corner = np.array([[1, 0], [0, -1]]) @ bend().T
    corner = corner.T[::-1] + np.array([8.4, YAW_PLATE - 0.5])
    tabs = join(tab, plate_x(corner, -34.7, -12.6))
    rivets = join(*[move(turn(screw(1.3, 0.8), ALONG_Y), x, 10.2, z) for x in (-29.5, -17.5) for z in (5.5, 19.5)])
    pad = block(-32, -15, -6.5, 6.5, 22.0, YAW_PLATE + 0.2, 1, 0.3)
    return join(top, both_sides(join(tabs, rivets)), pad)


def hip_roll_bracket():
    x0 = ROLL_SERVO + TAB
    back = plate_x(hull(circle(HORN_RADIUS), rectangle(-9.9, 9.9, 9, 21)), x0, x0 + SHEET, (), 0.2)
    tab = plate_y(
        hull(rectangle(x0 + 2, x0 + 3, 9, 21), rectangle(2, 5, 10, 20, 1.5, 2)),
        PLATE_IN,
        PLATE_OUT,
        [circle(2.2, (-2.0, 15.0), 10)],
        0.2,
    )
    edge = arc_band(0.5, 0.5 + SHEET, 90, 180, 4, (x0 + 2.0, 9.9))
    rivets = join(*[move(turn(screw(1.1, 0.6), ALONG_Y), 2.6, PLATE_OUT - 0.2, z) for z in (12.4, 17.6)])
    return join(back, both_sides(join(tab, plate_z(edge, 9, 21), rivets)))


def thigh_cover():
    front = rounded(
        (-56.0, 7.5, 10.0, -6.5, 6.5, 1.0),
        (-54.5, 6.0, 11.0, -8.0, 8.0, 1.8),
        (-40.0, 4.5, 12.4, -10.2, 10.2, 2.6),
        (-26.0, 4.5, 12.4, -10.2, 10.2, 2.6),
        (-19.5, 5.0, 11.2, -8.6, 8.6, 2.2),
        (-17.5, 6.0, 9.8, -7.0, 7.0, 1.2),
    )
    side = tapered_side(-24.5, -43.0)
    return join(front, both_sides(side))


def tapered_side(top, bottom):
    outline = hull(rectangle(-4.0, 6.0, bottom, top), rectangle(-6.5, 6.8, bottom + 5, top - 3))
    return plate_y(outline, PLATE_OUT - 0.2, PLATE_OUT + 1.7, (), 0.7)


def thigh_stripe():
    return tapered(
        (-49.0, 10.0, 12.35, -1.2, 1.2, 0.4),
        (-40.0, 10.0, 12.95, -2.4, 2.4, 0.6),
        (-27.0, 10.0, 12.95, -2.4, 2.4, 0.6),
        (-21.0, 9.0, 12.05, -2.0, 2.0, 0.4),
    )


def shank_cover():
    front = rounded(
        (-56.5, 7.0, 10.0, -6.0, 6.0, 1.0),
        (-54.5, 5.5, 11.2, -8.0, 8.0, 2.0),
        (-38.0, 4.5, 13.2, -11.6, 11.6, 3.0),
        (-24.0, 4.5, 13.6, -12.0, 12.0, 3.0),
        (-15.5, 5.5, 12.2, -9.5, 9.5, 2.4),
        (-12.5, 7.0, 10.8, -7.5, 7.5, 1.4),
    )
    return join(front, both_sides(tapered_side(-25.0, -42.0)))


def shank_stripe():
    return join(
        tapered(
            (-22.0, 9.0, 14.1, -8.6, 8.6, 1.2),
            (-20.5, 9.0, 14.2, -9.4, 9.4, 1.4),
            (-16.4, 9.0, 13.2, -8.0, 8.0, 1.2),
            (-15.0, 9.0, 12.6, -7.0, 7.0, 1.0),
        ),
        tapered((-48.0, 9.0, 12.7, -1.0, 1.0, 0.4), (-38.0, 9.0, 13.8, -1.8, 1.8, 0.5), (-26.0, 9.0, 14.1, -2.0, 2.0, 0.5)),
    )


def leg_core(top, bottom):
    """Wiring between the plates."""
    cables = [
        tube(curve((x, y, bottom - 1.0), (x - 0.8, 1.2 * y, (top + bottom) / 2), (x, y, top + 1.5), steps=3), 1.2)
        for x, y in ((-3.2, -3.6), (-3.2, 3.6), (-1.0, -1.2))
    ]
    return join(block(-1.0, 5.2, -8.2, 8.2, bottom - 1.0, top + 0.5, 1.0, 0.6), *cables)


def ankle_bracket():
    arm = hull(circle(HORN_RADIUS), rectangle(-34.5, -30, -7.0, 5.5, 1.2, 2), circle(2.0, (-13, -3)))
    holes = [circle(3.4, corners=16), hull(circle(2.0, (-19.5, 0), 10), circle(2.0, (-26.0, 0), 10))]
    rivets = [move(turn(screw(1.2, 0.8), ALONG_Y), x, TAB_OUT - 0.2, z) for x, z in ((-15.8, 2.6), (-31.8, 3.0), (-31.8, -4.4))]
    posts = [move(turn(disc(2.6, 8.5, TAB + 0.2, 0.2, 10), ALONG_Y), x, 0, z) for x, z in ((-17.0, 0), (-31.5, 0))]
    return both_sides(join(plate_y(arm, TAB, TAB_OUT, holes, 0.2), *rivets, *posts))


def foot_bracket():
    front, foot = ANKLE_SERVO + TAB, -32.0
    tab = plate_x(
        hull(circle(HORN_RADIUS), rectangle(-10.5, 10.5, foot + 0.1, foot + 2)),
        front,
        front + SHEET,
        [circle(3.4, corners=16), hull(circle(2.4, (-3.0, -19), 10), circle(2.4, (3.0, -19), 10), circle(1.6, (0, -14), 10))],
        0.2,
    )
    corner = bend() + np.array([front - 0.5, 0.5 + foot])  # in x and z
    edge = plate_y(corner, -10.5, 10.5)
    half = join(tab, edge)
    half = move(half, -ANKLE_SERVO)
    halves = join(half, turn(half, np.diag([-1, -1, 1])))
    across = plate_z(
        rectangle(-12.0, 12.0, -10.5, 10.5), foot - SHEET, foot, [circle(2.0, (8, 6), 8), circle(2.0, (-8, -6), 8)]
    )
    screws = join(*[move(screw(1.6, 1.4), x, y, foot - 0.3) for x, y in ((-8, 6), (8, -6))])
    deck = plate_z(
        rectangle(-37.0, 61.0, -27.0, 27.0, 8.0, 4), -37.8, -36.0, [circle(4, (0, 18), 14), circle(4, (0, -18), 14)], 0.4
    )
    return join(move(join(halves, across, screws), ANKLE_SERVO), deck)


def foot_sensor():
    """The six-axis sensor between bracket and deck."""
    return join(
        move(
            turned(
                [
                    (0, -36.3),
                    (11.0, -36.3),
                    (11.0, -35.6),
                    (9.5, -35.2),
                    (9.5, -34.6),
                    (11.0, -34.2),
                    (11.0, -33.4),
                    (0, -33.4),
                ],
                24,
            ),
            ANKLE_SERVO,
        ),
        tube(curve((ANKLE_SERVO, -9, -35), (-17, -15, -34), (-8, -12, -33), (-4, -10, -35.9), steps=4), 1.0),
    )


def foot_sole():
    return plate_z(rectangle(-38.0, 62.0, -28.0, 28.0, 9.0, 5), -40.0, -37.6, (), 0.6)


def foot_cover():
    toe = rounded(
        (-36.4, 5.0, 60.5, -26.5, 26.5, 8.0),
        (-34.0, 5.0, 61.0, -27.0, 27.0, 8.0),
        (-31.0, 6.5, 58.5, -26.0, 26.0, 8.0),
        (-25.2, 12.0, 44.0, -20.0, 20.0, 7.0),
        (-24.0, 14.0, 41.5, -18.0, 18.0, 6.0),
        steps=5,
    )
    rail = tapered(
        (-36.4, -37.0, 7.0, 17.5, 26.8, 4.0),
        (-33.0, -36.6, 7.0, 17.5, 26.6, 4.0),
        (-29.5, -33.0, 7.0, 18.5, 24.5, 2.5),
        (-28.7, -31.0, 7.0, 19.5, 23.5, 1.5),
    )
    return join(toe, both_sides(rail))


def foot_stripe():
    band = tapered(
        (-31.5, 50.0, 59.3, -10.0, 10.0, 1.5),
        (-30.6, 49.0, 58.1, -10.0, 10.0, 1.5),
        (-25.2, 36.0, 45.6, -8.0, 8.0, 1.5),
        (-23.6, 33.0, 41.8, -7.0, 7.0, 1.5),
        (-23.3, 33.6, 41.0, -6.4, 6.4, 1.2),
    )
    return band


PARTS = {
    "hip_yaw_bracket": hip_yaw_bracket,
    "hip_roll_bracket": hip_roll_bracket,
    "thigh_cover": thigh_cover,
    "thigh_stripe": thigh_stripe,
    "shank_cover": shank_cover,
    "shank_stripe": shank_stripe,
    "ankle_bracket": ankle_bracket,
    "foot_bracket": foot_bracket,
    "foot_sensor": foot_sensor,
    "foot_sole": foot_sole,
    "foot_cover": foot_cover,
    "foot_stripe": foot_stripe,
    "leg_strut": lambda: strut(-20.4, -55.0),
    "leg_core": lambda: leg_core(-21.3, -42.7),
}
