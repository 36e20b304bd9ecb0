"""The trunk, neck and head of the default robot in their links' frames, in millimetres."""

import numpy as np

from meshes.joints import bend, HORN_RADIUS, PLATE_IN, PLATE_OUT, screw, SHEET, TAB, TAB_OUT
from meshes.solids import (
    ALONG_X,
    ALONG_Y,
    arc_band,
    block,
    both_sides,
    circle,
    curve,
    disc,
    hull,
    join,
    loft_x,
    move,
    plate_x,
    plate_y,
    plate_z,
    rectangle,
    rounded,
    superellipse,
    tapered,
    tube,
    turn,
    turned,
)

EMBLEM = 107.0  # height of the middle of the chest's emblem
TILT_SERVO = 18.0
FACE = (0.0, 26.0)  # y and z of the middle of the face, and of the head
EYE = (9.4, 27.2)


def trunk_frame():
    """Sheet metal: side plates, decks and the pelvis."""
    side = hull(rectangle(-15.0, 11.0, 50.5, 60), rectangle(-12.0, 10.0, 60, 117.5))
    windows = [rectangle(-8.5, 6.5, 56, 68, 2.5, 2), rectangle(-8.0, 6.0, 73, 92, 2.5, 2)]
    sides = both_sides(plate_y(side, 20.5, 22.0, windows, 0.2))
    deck = plate_z(
        rectangle(-24.0, 12.0, -40.0, 40.0, 4.0, 2), 50.0, 51.5, [circle(3, (-18, 14), 10), circle(3, (-18, -14), 10)], 0.2
    )
    cheek = plate_y(
        hull(rectangle(-23.0, 9.5, 44, 49.5), rectangle(-18.0, 6.0, 33, 36, 1.5, 2)),
        38.8,
        40.3,
        [circle(3.2, (-7.0, 42), 14)],
        0.2,
    )
    edge = plate_x(arc_band(0.5, 0.5 + SHEET, 0, 90, 4, (38.3, 49.5)), -23.0, 9.5)
    rivets = join(*[move(turn(screw(1.2, 0.8), ALONG_Y), x, 40.1, 46) for x in (-17.5, 4.0)])
    shoulder = plate_z(
        rectangle(-14.0, 10.0, -44.0, 44.0, 3.0, 2),
        129.2,
        130.7,
        [circle(3.0, (0, 33.7), 12), circle(3.0, (0, -33.7), 12)],
        0.2,
    )
    lower = both_sides(plate_z(rectangle(-10.0, 9.0, 21.0, 43.5, 2.0, 2), 96.0, 97.5, (), 0.2))
    collar = turned([(0, 130.0), (15.0, 130.0), (15.0, 134.5), (14.0, 135.5), (11.0, 135.5), (11.0, 134.0), (0, 134.0)], 28)
    return join(sides, deck, both_sides(join(cheek, edge, rivets)), shoulder, lower, collar)


def trunk_core():
    """The pelvis between the yaw servos, the belly with its ribs, the boards, cables to legs and arms."""
    pelvis = block(-22.0, 9.0, -20.0, 20.0, 32.0, 50.3, 2.0, 1.0)
    ribs = join(
        *[
            tapered(
                (z, -14.0, 13.5, -24.0, 24.0, 4.0),
                (z + 0.9, -15.5, 15.0, -25.5, 25.5, 5.0),
                (z + 3.3, -15.5, 15.0, -25.5, 25.5, 5.0),
                (z + 4.2, -14.0, 13.5, -24.0, 24.0, 4.0),
            )
            for z in (51.0, 55.0, 59.0, 63.0, 67.0)
        ]
    )
    boards = block(-9.0, 9.0, -19.5, 19.5, 70.0, 117.0, 1.0, 0.5)
    cable = join(
        tube(curve((-22, 20, 66), (-27, 24, 60), (-25, 29, 54), (-21.8, 30, 46), steps=3), 1.5),
        tube(curve((-22, 16, 66), (-26.5, 20, 59), (-24.5, 25, 53), (-21.8, 26.5, 44), steps=3), 1.5),
        tube(curve((-20, 28, 112), (-17, 35, 112), (-11, 38, 106), (-4, 36, 100), steps=3), 1.5),
    )
    return join(pelvis, ribs, boards, both_sides(cable))


def chest_cover():
    chest = rounded(
        (76.0, 10.0, 22.0, -22.0, 22.0, 4.0),
        (78.0, 9.0, 25.0, -26.0, 26.0, 5.0),
        (90.0, 9.3, 30.0, -36.5, 36.5, 7.0),
        (96.0, 9.3, 31.0, -38.5, 38.5, 7.5),
        (120.0, 9.3, 31.0, -39.0, 39.0, 8.0),
        (128.0, 9.3, 28.5, -37.0, 37.0, 8.0),
        (133.0, 9.3, 23.0, -32.0, 32.0, 6.0),
        (134.5, 9.6, 19.0, -29.0, 29.0, 4.0),
        steps=6,
    )
    abdomen = rounded(
        (56.5, 13.0, 18.5, -13.0, 13.0, 2.5),
        (58.0, 12.5, 20.0, -15.0, 15.0, 3.5),
        (72.5, 12.5, 23.5, -21.0, 21.0, 4.0),
        (74.5, 12.5, 22.0, -19.5, 19.5, 3.5),
    )
    skirt = rounded(
        (33.0, 9.5, 15.5, -27.0, 27.0, 2.5),
        (35.0, 8.8, 18.0, -31.0, 31.0, 4.0),
        (49.0, 8.8, 21.0, -38.5, 38.5, 5.0),
        (53.0, 9.0, 19.5, -37.5, 37.5, 4.5),
        (54.0, 10.0, 17.5, -35.5, 35.5, 3.0),
        steps=4,
    )
    top = tapered(
        (130.3, -14.0, 9.6, -22.0, 22.0, 3.0), (133.0, -14.0, 9.6, -21.0, 21.0, 3.0), (134.5, -12.0, 9.6, -18.0, 18.0, 2.0)
    )
    return join(chest, abdomen, skirt, top)


def chest_stripe():
    disc_ = move(turn(turned([(0, 29.5), (8.6, 29.5), (8.6, 31.8), (7.6, 32.3), (0, 32.3)], 28), ALONG_X), 0, 0, EMBLEM)
    shoulders = both_sides(
        plate_x(
            hull(rectangle(17.5, 34.5, 113.5, 117.0, 0.8, 2), rectangle(23.0, 35.5, 117, 121.0, 0.8, 2)), 30.0, 31.5, (), 0.3
        )
    )
    buckle = tapered(
        (38.5, 16.0, 20.0, -5.0, 5.0, 1.0),
        (40.0, 16.0, 21.0, -6.5, 6.5, 1.4),
        (48.0, 16.0, 22.2, -8.0, 8.0, 1.6),
        (49.5, 16.0, 21.6, -7.0, 7.0, 1.2),
    )
    battery = tapered(
        (70.0, -33.6, -28.0, -20.0, 20.0, 2.0),
        (71.2, -34.6, -28.0, -21.5, 21.5, 2.6),
        (91.8, -34.6, -28.0, -21.5, 21.5, 2.6),
        (93.0, -33.6, -28.0, -20.0, 20.0, 2.0),
    )
    return join(disc_, shoulders, buckle, battery)


def chest_gold():
    """The ring of the emblem, and in it the weighted doll that rises again: a drop with its face."""
    ring = turned([(0, 29.0), (10.6, 29.0), (10.6, 32.0), (10.0, 32.6), (9.0, 32.6), (8.5, 32.0), (8.5, 30.5), (0, 30.5)], 32)
    body = hull(circle(4.6, (0, EMBLEM - 1.6), 24), circle(2.6, (0, EMBLEM + 3.0), 16))
    return join(move(turn(ring, ALONG_X), 0, 0, EMBLEM), plate_x(body, 32.0, 32.9, [circle(2.3, (0, EMBLEM + 1.2), 16)], 0.2))


def chest_dark():
    """Vents, and what the backpack carries."""
    vents = both_sides(
        join(
            *[
                plate_x(
                    np.array([[16.0 + s, z], [30.0 + s, z + 1.6], [30.0 + s, z + 3.4], [16.0 + s, z + 1.8]]),
                    29.2,
                    31.3,
                    (),
                    0.2,
                )
                for s, z in ((0, 91.5), (0.6, 95.2), (1.2, 98.9))
            ]
        )
    )
    pack = tapered(
        (63.0, -25.0, -10.0, -24.0, 24.0, 3.0),
        (65.0, -28.0, -9.6, -27.0, 27.0, 4.0),
        (72.0, -30.0, -9.6, -30.0, 30.0, 5.0),
        (118.0, -30.0, -9.6, -30.0, 30.0, 5.0),
        (128.0, -26.0, -9.6, -27.0, 27.0, 4.0),
        (130.0, -24.0, -10.0, -25.0, 25.0, 3.0),
    )
    fins = join(*[block(-31.2, -29.0, -17.0, 17.0, z, z + 1.6, 0.5, 0.3, 1) for z in (101.0, 104.2, 107.4, 110.6)])
    switch = join(
        block(-32.0, -29.0, 20.0, 26.0, 106.0, 114.0, 0.8, 0.4), block(-31.6, -29.0, -26.5, -20.0, 104.0, 113.0, 0.8, 0.4)
    )
    return join(vents, pack, fins, switch)


def neck_bracket():
    """A plate on the pan servo's horn, and two tabs beside the tilt servo, which lies above it."""
    base = plate_z(
        hull(circle(HORN_RADIUS), rectangle(-20.5, -8.5, -9.9, 9.9)), -SHEET, 0.0, [circle(2.6, (-14.5, 0), 12)], 0.2
    )
    tab = plate_y(
        hull(rectangle(-20.5, -8.5, 0.4, 2.0), rectangle(-20.0, -9.5, 20, 25, 2.0, 2)),
        PLATE_IN,
        PLATE_OUT,
        [circle(2.6, (-14.5, 8.0), 12)],
        0.2,
    )
    edge = plate_x(bend() + np.array([PLATE_OUT - 2.0, 0.5]), -20.5, -8.5)
    rivets = join(*[move(turn(screw(1.1, 0.6), ALONG_Y), x, PLATE_OUT - 0.2, 18.0) for x in (-17.5, -12.5)])
    pillar = block(-7.0, 5.0, -5.5, 5.5, -0.3, 9.4, 1.5, 0.4)
    return join(base, both_sides(join(tab, edge, rivets)), pillar)


def head_frame():
    tab = plate_y(hull(circle(HORN_RADIUS), rectangle(-8.5, 8.5, 12, 16)), TAB, TAB_OUT, [circle(3.4, corners=16)], 0.2)
    ear = turned([(0, 25.0), (8.5, 25.0), (8.5, 29.4), (7.5, 30.4), (5.6, 30.4), (5.2, 29.6), (0, 29.6)], 24)
    return both_sides(join(tab, move(turn(ear, ALONG_Y), -3.0, 0, FACE[1])))


def head_outline(scale, corners=52):
    return superellipse(27.6 * scale, 21.6 * scale, 2.6, (0.0, FACE[1] + 2.0), corners)


def helmet():
    sections = [
        (-25.0, 0.2),
        (-24.6, 0.38),
        (-23.7, 0.52),
        (-22.2, 0.64),
        (-20.0, 0.75),
        (-17.0, 0.84),
        (-13.0, 0.92),
        (-8.0, 0.975),
        (-2.0, 1.0),
        (8.0, 1.0),
        (15.0, 0.975),
        (17.5, 0.955),
    ]
    shell = loft_x([(x, head_outline(s)) for x, s in sections])
    rim = plate_x(head_outline(0.955), 17.0, 23.0, [face_outline(0.0)], 1.6)
    crest = loft_x(
        [
            (-21.0, superellipse(1.6, 1.6, 2.5, (0, 42.5), 12)),
            (-14.0, superellipse(2.6, 2.6, 2.5, (0, 46.6), 12)),
            (0.0, superellipse(3.2, 2.6, 2.5, (0, 49.0), 12)),
            (14.0, superellipse(3.2, 2.6, 2.5, (0, 48.2), 12)),
            (21.0, superellipse(2.4, 1.8, 2.5, (0, 46.2), 12)),
        ]
    )
    return join(shell, rim, crest)


def face_outline(grow):
    return superellipse(21.6 + grow, 14.6 + grow, 3.0, (0.0, FACE[1]), 36)


def face_plate():
    """The face, and a glint in each eye."""
    glints = [move(turn(disc(1.1, 20.0, 22.3, 0.2, 10), ALONG_X), 0, y + 1.7, EYE[1] + 1.7) for y in (EYE[0], -EYE[0])]
    return join(plate_x(face_outline(0.5), 16.5, 19.6), *glints)


def face_dark():
    """Eyes' rims, a daruma's brows, mouth and the camera in the forehead."""
    eye = move(
        turn(turned([(0, 19.0), (6.6, 19.0), (6.6, 20.8), (6.0, 21.4), (4.9, 21.4), (4.5, 20.6), (0, 20.6)], 24), ALONG_X),
        0,
        *EYE
    )
    mouth = plate_x(hull(circle(0.9, (-4.5, 15.6), 8), circle(0.9, (4.5, 15.6), 8)), 19.2, 20.3)
    camera = move(
        turn(turned([(0, 21.0), (2.6, 21.0), (2.6, 23.8), (2.1, 24.2), (1.5, 24.2), (1.3, 23.4), (0, 23.4)], 14), ALONG_X),
        0,
        0,
        43.6,
    )
    ears = both_sides(
        move(turn(turned([(0, 29.0), (4.6, 29.0), (4.6, 30.2), (4.0, 30.6), (0, 30.6)], 18), ALONG_Y), -3.0, 0, FACE[1])
    )
    mast = move(turned([(0, 0.0), (1.5, 0.0), (1.5, 5.0), (0.7, 6.0), (0.6, 19.0), (0, 19.0)], 8), -3.0, 28.0, FACE[1] + 7.5)
    brow = plate_x(arc_band(7.8, 10.4, 48, 132, 10, EYE), 19.2, 20.8)
    return join(both_sides(join(eye, brow)), mouth, camera, ears, mast)


def face_lens():
    return both_sides(
        move(turn(turned([(0, 20.2), (4.7, 20.2), (4.4, 21.0), (3.2, 21.6), (1.6, 21.9), (0, 22.0)], 20), ALONG_X), 0, *EYE)
    )


def face_gold():
    """A daruma's whiskers; the tip of the antenna."""
    whisker = join(*[plate_x(arc_band(r, r + 1.2, -88 - s, -40 + s, 7, EYE), 19.2, 20.4) for r, s in ((8.2, 0), (10.4, 6))])
    tip = move(turned([(0, -1.8), (1.2, -1.4), (1.8, 0.0), (1.2, 1.4), (0, 1.8)], 10), -3.0, 28.0, FACE[1] + 27.0)
    return join(both_sides(whisker), tip)


PARTS = {
    "trunk_frame": trunk_frame,
    "trunk_core": trunk_core,
    "chest_cover": chest_cover,
    "chest_stripe": chest_stripe,
    "chest_gold": chest_gold,
    "chest_dark": chest_dark,
    "neck_bracket": neck_bracket,
    "head_frame": head_frame,
    "helmet": helmet,
    "face_plate": face_plate,
    "face_dark": face_dark,
    "face_lens": face_lens,
    "face_gold": face_gold,
}
