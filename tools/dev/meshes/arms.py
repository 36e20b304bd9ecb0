"""The arms of the default robot: brackets, covers and hands in their links' frames, in millimetres."""

import numpy as np

from meshes.joints import HORN_RADIUS, SHEET, strut
from meshes.solids import (
    arc_band,
    both_sides,
    circle,
    hull,
    join,
    move,
    plate_x,
    plate_y,
    plate_z,
    rectangle,
    tapered,
    turn,
    turned,
)


def shoulder_bracket():
    """The left side's part; the servo lies towards the trunk."""
    y0 = -24.0
    end = plate_y(hull(circle(HORN_RADIUS), rectangle(-7.5, 7.5, -8.4, 8.4)), y0, y0 + SHEET, (), 0.2)
    tab = plate_z(
        hull(rectangle(-7.5, 7.5, y0 + 2, y0 + 3), rectangle(-5.5, 5.5, -9, -6, 1.5, 2)),
        8.9,
        8.9 + SHEET,
        [circle(3.0, (0, -14.5), 12)],
        0.2,
    )
    edge = plate_x(arc_band(0.5, 0.5 + SHEET, 90, 180, 4, (y0 + 2.0, 8.4)), -7.5, 7.5)
    upper = join(tab, edge)
    return join(end, upper, turn(upper, np.diag([-1, 1, -1])))


def shoulder_cover():
    return tapered(
        (10.0, -9.5, 9.5, -23.0, 6.0, 3.0),
        (11.0, -11.0, 11.0, -24.0, 7.0, 3.5),
        (14.0, -11.0, 11.0, -23.5, 6.5, 4.0),
        (16.0, -9.2, 9.2, -21.0, 4.0, 3.5),
        (16.8, -7.4, 7.4, -18.5, 1.5, 3.0),
        steps=4,
    )


def shoulder_stripe():
    return move(turned([(0, 15.5), (5.2, 15.5), (5.2, 17.0), (4.6, 17.4), (0, 17.4)], 20), 0, -8.5)


def upper_arm_cover():
    return tapered(
        (-47.5, -7.6, 7.6, -10.8, 10.8, 2.5),
        (-46.5, -8.6, 8.6, -12.2, 12.2, 3.0),
        (-34.0, -10.2, 10.2, -13.2, 13.2, 3.5),
        (-25.0, -10.2, 10.2, -13.2, 13.2, 3.5),
        (-22.0, -9.0, 9.0, -12.2, 12.2, 3.0),
        (-21.2, -8.0, 8.0, -11.2, 11.2, 2.5),
    )


def upper_arm_stripe():
    return both_sides(
        plate_y(hull(rectangle(-4.6, 4.6, -36, -28, 1.5, 2), rectangle(-3.0, 3.0, -41, -28, 1.0, 2)), 12.9, 13.8, (), 0.3)
    )


def forearm_cover():
    return tapered(
        (-60.5, -6.4, 6.4, -6.4, 6.4, 2.5),
        (-59.5, -7.2, 7.2, -7.2, 7.2, 3.0),
        (-40.0, -9.4, 9.4, -9.8, 9.8, 4.0),
        (-27.0, -10.0, 10.0, -11.0, 11.0, 4.0),
        (-22.2, -9.2, 9.2, -11.0, 11.0, 3.5),
        (-20.8, -8.0, 8.0, -9.8, 9.8, 3.0),
        steps=4,
    )


def forearm_stripe():
    return tapered(
        (-55.4, -7.4, 7.4, -7.4, 7.4, 3.0),
        (-54.9, -7.9, 7.9, -8.0, 8.0, 3.3),
        (-51.4, -8.3, 8.3, -8.5, 8.5, 3.5),
        (-50.9, -8.0, 8.0, -8.2, 8.2, 3.2),
        steps=4,
    )


def hand():
    """A gripper: a palm, two fingers at the front that bend inwards, a thumb behind them."""
    wrist = turned(
        [
            (0, -66.5),
            (4.4, -66.5),
            (5.0, -66.0),
            (5.0, -64.0),
            (4.3, -63.4),
            (4.3, -62.8),
            (5.0, -62.2),
            (5.0, -60.0),
            (0, -60.0),
        ],
        16,
    )
    palm = tapered(
        (-76.0, -6.0, 6.0, -7.5, 7.5, 1.5),
        (-75.0, -7.0, 7.0, -8.5, 8.5, 2.0),
        (-69.0, -7.0, 7.0, -8.5, 8.5, 2.0),
        (-66.0, -5.0, 5.0, -6.0, 6.0, 2.0),
    )

    def finger(x0, x1, reach):
        return tapered(
            (-95.0, x0 + 1.0, x1 - 1.0, 0.8, 3.2, 0.8),
            (-93.0, x0 + 0.4, x1 - 0.4, 0.6, 5.0, 1.0),
            (-86.0, x0, x1, reach, reach + 4.2, 1.2),
            (-80.0, x0, x1, reach - 0.4, reach + 4.2, 1.2),
            (-74.0, x0 + 0.4, x1 - 0.4, 2.6, 7.4, 1.2),
            steps=2,
        )

    return join(wrist, palm, both_sides(join(finger(0.6, 6.4, 4.6), finger(-6.4, -0.6, 4.6))))


PARTS = {
    "shoulder_bracket": shoulder_bracket,
    "shoulder_cover": shoulder_cover,
    "shoulder_stripe": shoulder_stripe,
    "upper_arm_cover": upper_arm_cover,
    "upper_arm_stripe": upper_arm_stripe,
    "forearm_cover": forearm_cover,
    "forearm_stripe": forearm_stripe,
    "hand": hand,
    "arm_strut": lambda: strut(-20.4, -60.0),
}
