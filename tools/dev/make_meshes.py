#!/usr/bin/env python3
"""Makes the shells that the viewer draws over the default robot's boxes: robots/koboshi/meshes/*.stl.

Each shell is a few rounded boxes, in millimetres about the centre of the collision box that it dresses; the same file
serves the left and the right side. The results are committed: run this again only to change how the robot looks.

    tools/dev/make_meshes.py [FOLDER]
"""

import math
import pathlib
import struct
import sys

ARC_STEPS = 3  # facets of a quarter circle


def rounded_box(size, centre=(0, 0, 0), radius=4, taper=(1, 1)):
    """Triangles of a box with rounded edges; `taper` scales x and y at its lower end, 1 at its upper."""
    radius = min(radius, min(size) / 2)

    def quarter_angles(start):
        return [start + math.pi / 2 * i / ARC_STEPS for i in range(ARC_STEPS + 1)]

    def vertex(longitude, latitude, signs):
        normal = (math.cos(latitude) * math.cos(longitude), math.cos(latitude) * math.sin(longitude), math.sin(latitude))
        x, y, z = (sign * (s / 2 - radius) + radius * n for sign, s, n in zip(signs, size, normal))
        depth = 0.5 - z / size[2]
        x *= 1 + (taper[0] - 1) * depth
        y *= 1 + (taper[1] - 1) * depth
        return (x + centre[0], y + centre[1], z + centre[2])

    rings = []
    for latitude_start, sign_z in ((-math.pi / 2, -1), (0, 1)):
        for latitude in quarter_angles(latitude_start):
            ring = []
            for quadrant, (sign_x, sign_y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
                for longitude in quarter_angles(quadrant * math.pi / 2):
                    ring.append(vertex(longitude, latitude, (sign_x, sign_y, sign_z)))
            rings.append(ring)

    triangles = []
    for below, above in zip(rings, rings[1:]):
        for i in range(len(below)):
            j = (i + 1) % len(below)
            triangles += [(below[i], below[j], above[j]), (below[i], above[j], above[i])]
    for ring, outward in ((rings[0], False), (rings[-1], True)):
        for i in range(1, len(ring) - 1):
            triangles.append((ring[0], ring[i], ring[i + 1]) if outward else (ring[0], ring[i + 1], ring[i]))
    return [t for t in triangles if area(t) > 1e-6]


def cross(t):
    u, v = ([t[k][i] - t[0][i] for i in range(3)] for k in (1, 2))
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def area(t):
    return math.hypot(*cross(t)) / 2


def write_stl(path, triangles):
    with open(path, "wb") as stl:
        stl.write(b"koboshi shell, millimetres".ljust(80, b"\0"))
        stl.write(struct.pack("<I", len(triangles)))
        for t in triangles:
            normal = cross(t)
            length = math.hypot(*normal)
            stl.write(struct.pack("<12fH", *(n / length for n in normal), *(c for v in t for c in v), 0))


def shells():
    return {
        "trunk": rounded_box((58, 80, 68), (0, 0, 19), 11, taper=(0.85, 0.8))
        + rounded_box((42, 58, 42), (0, 0, -31), 9)
        + rounded_box((8, 48, 34), (28, 0, 24), 4, taper=(1, 0.7))
        + rounded_box((12, 52, 46), (-26, 0, 16), 5),
        "head": rounded_box((48, 58, 46), (0, 0, 1), 17, taper=(0.9, 0.85))
        + rounded_box((10, 44, 14), (20, 0, 4), 5)
        + rounded_box((18, 8, 18), (-2, 27, 2), 4)
        + rounded_box((18, 8, 18), (-2, -27, 2), 4),
        "thigh": rounded_box((18, 28, 50), (0, 0, 0), 5, taper=(0.9, 0.8))
        + rounded_box((5, 20, 30), (8, 0, 4), 2.5, taper=(1, 0.6)),
        "shank": rounded_box((18, 28, 46), (0, 0, 0), 5, taper=(0.85, 0.75))
        + rounded_box((5, 18, 34), (8, 0, 2), 2.5, taper=(1, 0.6)),
        "foot": rounded_box((100, 56, 12), (0, 0, -2), 5)
        + rounded_box((38, 48, 12), (27, 0, 1), 5)
        + rounded_box((44, 42, 12), (-18, 0, 2), 5),
        "upper_arm": rounded_box((24, 24, 56), (0, 0, 0), 8, taper=(0.8, 0.8)),
        "forearm": rounded_box((20, 20, 58), (0, 0, 13), 7, taper=(0.75, 0.75))
        + rounded_box((16, 6, 30), (0, 6, -27), 3)
        + rounded_box((16, 6, 30), (0, -6, -27), 3),
    }


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else root / "robots" / "koboshi" / "meshes"
    folder.mkdir(parents=True, exist_ok=True)
    for name, triangles in shells().items():
        write_stl(folder / f"{name}.stl", triangles)


if __name__ == "__main__":
    main()
