"""Closed triangle meshes of plates, lofts and turned parts.

A solid is an array of triangles (n, 3, 3) in millimetres, corners counter-clockwise as seen from outside. Each function
returns a closed surface: every edge belongs to two triangles, which run through it in opposite directions. Parts that are
welded or screwed together are solids that overlap; join() lists them without cutting them.
"""

import struct

import numpy as np


def join(*solids):
    return np.concatenate([s for s in solids if len(s)])


def move(solid, x=0.0, y=0.0, z=0.0):
    return solid + np.array([x, y, z])


def turn(solid, rotation):
    return solid @ np.asarray(rotation, dtype=float).T


def mirror_y(solid):
    """The mirror image on the other side of the plane y = 0; exchanges two corners to keep the outside outside."""
    return (solid * np.array([1.0, -1.0, 1.0]))[:, ::-1, :]


def both_sides(solid):
    return join(solid, mirror_y(solid))


# --- outlines: arrays (n, 2), counter-clockwise, without collinear corners


def circle(radius, centre=(0.0, 0.0), corners=20, phase=0.0):
    angles = phase + 2 * np.pi * (np.arange(corners) + 0.5) / corners
    return np.stack([centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)], axis=1)


def hull(*points):
    """The convex hull of outlines."""
    cloud = sorted({(round(float(x), 6), round(float(y), 6)) for outline in points for x, y in outline})

    def chain(ordered):
        kept = []
        for p in ordered:
            while len(kept) > 1 and cross2(kept[-2], kept[-1], p) <= 1e-6:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return np.array(chain(cloud) + chain(cloud[::-1]))


def cross2(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def rectangle(x0, x1, y0, y1, radius=0.0, steps=3):
    """A rectangle with rounded corners of `steps` facets."""
    if radius == 0:
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float)
    corners = []
    for quadrant, (x, y) in enumerate(((x1, y1), (x0, y1), (x0, y0), (x1, y0))):
        centre = (x - radius if x == x1 else x + radius, y - radius if y == y1 else y + radius)
        for i in range(steps + 1):
            a = np.pi / 2 * (quadrant + i / steps)
            corners.append((centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a)))
    return np.array(corners)


def superellipse(half_width, half_height, exponent=2.5, centre=(0.0, 0.0), corners=40):
    angles = 2 * np.pi * (np.arange(corners) + 0.5) / corners
    c, s = np.cos(angles), np.sin(angles)
    return np.stack(
        [
            centre[0] + half_width * np.sign(c) * np.abs(c) ** (2 / exponent),
            centre[1] + half_height * np.sign(s) * np.abs(s) ** (2 / exponent),
        ],
        axis=1,
    )


def arc_band(inner, outer, start, end, steps, centre=(0.0, 0.0)):
    """A sector of a ring; angles in degrees."""
    angles = np.radians(np.linspace(start, end, steps + 1))
    rim = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([outer * rim, inner * rim[::-1]]) + np.asarray(centre, dtype=float)


def inset(outline, distance):
    """The outline moved inwards by `distance`, with mitred corners; negative: outwards."""
    ahead, behind = np.roll(outline, -1, axis=0) - outline, outline - np.roll(outline, 1, axis=0)
    normals = []
    for edge in (behind, ahead):
        unit = edge / np.linalg.norm(edge, axis=1, keepdims=True)
        normals.append(np.stack([-unit[:, 1], unit[:, 0]], axis=1))
    bisector = normals[0] + normals[1]
    return outline + distance * 2 * bisector / np.sum(bisector * bisector, axis=1, keepdims=True)


# --- triangulation


def with_bridges(outline, holes):
    """Indices of one ring through the outline and its holes, and all points."""
    points = [tuple(p) for p in outline]
    ring = list(range(len(points)))
    rings = []
    for hole in holes:
        first = len(points)
        points += [tuple(p) for p in hole[::-1]]
        rings.append(list(range(first, len(points))))
    rings.sort(key=lambda r: -max(points[i][0] for i in r))
    edges = [(r[i], r[(i + 1) % len(r)]) for r in [ring, *rings] for i in range(len(r))]
    bridges = []

    def crosses(a, b):
        pa, pb = points[a], points[b]
        for c, d in edges + bridges:
            if {a, b} & {c, d}:
                continue
            pc, pd = points[c], points[d]
            if cross2(pa, pb, pc) * cross2(pa, pb, pd) <= 0 and cross2(pc, pd, pa) * cross2(pc, pd, pb) <= 0:
                return True
        return False

    def inside(place, target):
        before, here, after = (points[ring[(place + k) % len(ring)]] for k in (-1, 0, 1))
        left_of_in, left_of_out = cross2(before, here, target) > 0, cross2(here, after, target) > 0
        return (left_of_in and left_of_out) if cross2(before, here, after) > 0 else (left_of_in or left_of_out)

    for hole in rings:
        start = max(range(len(hole)), key=lambda i: points[hole[i]][0])
        hole = hole[start:] + hole[:start]
        target = points[hole[0]]
        order = sorted(
            range(len(ring)), key=lambda i: (points[ring[i]][0] - target[0]) ** 2 + (points[ring[i]][1] - target[1]) ** 2
        )
        place = next(i for i in order if inside(i, target) and not crosses(ring[i], hole[0]))
        bridges.append((ring[place], hole[0]))
        ring = ring[: place + 1] + hole + [hole[0]] + ring[place:]
    return ring, np.array(points)


def triangulate(outline, holes=()):
    """Index triples into the outline's points followed by those of the holes, each hole reversed."""
    ring, points = with_bridges(outline, holes)
    triangles = []
    while len(ring) > 3:
        best, best_shape = None, 1e-9
        for i in range(len(ring)):
            a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
            pa, pb, pc = points[a], points[b], points[c]
            twice = cross2(pa, pb, pc)
            sides = np.sum((pb - pa) ** 2) + np.sum((pc - pb) ** 2) + np.sum((pa - pc) ** 2)
            shape = twice / sides  # how near to an equilateral triangle
            if shape <= best_shape:
                continue
            others = points[[k for k in ring if k not in (a, b, c)]]
            within = np.ones(len(others), dtype=bool)
            for p, q in ((pa, pb), (pb, pc), (pc, pa)):
                within &= (q[0] - p[0]) * (others[:, 1] - p[1]) - (q[1] - p[1]) * (others[:, 0] - p[0]) >= -1e-9
            if not within.any():
                best, best_shape = i, shape
        if best is None:
            raise ValueError("an outline that crosses itself or a hole")
        triangles.append((ring[best - 1], ring[best], ring[(best + 1) % len(ring)]))
        ring.pop(best)
    return triangles + [tuple(ring)]


# --- solids


def wall(lower, upper):
    """Triangles between two rings of as many points."""
    below, above = np.asarray(lower), np.asarray(upper)
    right_below, right_above = np.roll(below, -1, axis=0), np.roll(above, -1, axis=0)
    return np.concatenate([np.stack([below, right_below, right_above], axis=1), np.stack([below, right_above, above], axis=1)])


def at_height(outline, z):
    return np.column_stack([outline, np.full(len(outline), float(z))])


def plate(outline, z0, z1, holes=(), bevel=0.0):
    """A plate across z with straight holes; its outer edges are bevelled by `bevel`."""
    outer = np.asarray(outline, dtype=float)
    small = inset(outer, bevel) if bevel else outer
    heights = [(small, z0), (outer, z0 + bevel), (outer, z1 - bevel), (small, z1)] if bevel else [(outer, z0), (outer, z1)]
    rings = [at_height(o, z) for o, z in heights]
    triangles = [wall(a, b) for a, b in zip(rings, rings[1:])]
    for hole in holes:
        triangles.append(wall(at_height(hole[::-1], z0), at_height(hole[::-1], z1)))
    corners = np.concatenate([small, *[hole[::-1] for hole in holes]])
    cap = np.array(triangulate(small, holes))
    triangles += [at_height(corners, z1)[cap], at_height(corners, z0)[cap[:, ::-1]]]
    return np.concatenate(triangles)


def plate_z(outline_xy, z0, z1, holes=(), bevel=0.0):
    return plate(outline_xy, z0, z1, holes, bevel)


def plate_x(outline_yz, x0, x1, holes=(), bevel=0.0):
    return plate(outline_yz, x0, x1, holes, bevel)[:, :, [2, 0, 1]]


def plate_y(outline_xz, y0, y1, holes=(), bevel=0.0):
    solid = plate(outline_xz, -y1, -y0, holes, bevel)
    return np.stack([solid[:, :, 0], -solid[:, :, 2], solid[:, :, 1]], axis=2)


def loft(sections):
    """A solid through (z, outline) sections of as many points, from the lowest up; the ends must be convex."""
    rings = [at_height(outline, z) for z, outline in sections]
    triangles = [wall(a, b) for a, b in zip(rings, rings[1:])]
    for ring, step in ((rings[0], -1), (rings[-1], 1)):
        low, high, cap = 0, len(ring) - 1, []
        while high - low > 1:  # a zigzag has fewer needles than a fan
            cap.append((low, low + 1, high))
            low += 1
            if high - low > 1:
                cap.append((low, high - 1, high))
                high -= 1
        triangles.append(ring[np.array(cap)[:, ::step]])
    return np.concatenate(triangles)


def loft_x(sections):
    """As loft(), along x through outlines in y and z."""
    return loft(sections)[:, :, [2, 0, 1]]


def tapered(*sections, steps=3):
    """A loft along z through rounded rectangles (z, x0, x1, y0, y1, radius)."""
    return loft([(z, rectangle(x0, x1, y0, y1, radius, steps)) for z, x0, x1, y0, y1, radius in sections])


def rounded(*sections, steps=3, between=2):
    """As tapered(), with `between` - 1 more sections between every two that follow one another on a smooth curve."""
    path = curve(*sections, steps=between)
    return tapered(*path, steps=steps)


def block(x0, x1, y0, y1, z0, z1, radius=1.0, bevel=0.5, steps=2):
    """A box with rounded edges along z and bevelled ends."""
    outline = rectangle(x0, x1, y0, y1, radius, steps)
    small = rectangle(x0 + bevel, x1 - bevel, y0 + bevel, y1 - bevel, max(radius - bevel / 2, 0.1), steps)
    return loft([(z0, small), (z0 + bevel, outline), (z1 - bevel, outline), (z1, small)])


def turned(profile, corners=16, phase=0.0):
    """A part turned about z from (radius, z) pairs, from the lower end on the axis, outside, to the upper end."""
    rings = []
    for radius, z in profile:
        rings.append(at_height(circle(radius, corners=corners, phase=phase), z) if radius else np.array([[0.0, 0.0, z]]))
    triangles = []
    for low, high in zip(rings, rings[1:]):
        if len(low) == 1:
            triangles.append(np.stack([np.repeat(low, len(high), axis=0), np.roll(high, -1, axis=0), high], axis=1))
        elif len(high) == 1:
            triangles.append(np.stack([low, np.roll(low, -1, axis=0), np.repeat(high, len(low), axis=0)], axis=1))
        else:
            triangles.append(wall(low, high))
    return np.concatenate(triangles)


def disc(radius, z0, z1, bevel=0.3, corners=16):
    return turned(
        [(0, z0), (radius - bevel, z0), (radius, z0 + bevel), (radius, z1 - bevel), (radius - bevel, z1), (0, z1)], corners
    )


def tube(path, radius, corners=6):
    """A cable of round section along points; its rings keep one orientation as far as the path allows."""
    path = np.asarray(path, dtype=float)
    forward = np.gradient(path, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    side = np.cross(forward[0], [0.3, 0.5, 0.8])
    rings = []
    for point, direction in zip(path, forward):
        side = side - direction * (side @ direction)
        side /= np.linalg.norm(side)
        up = np.cross(direction, side)
        flat = circle(radius, corners=corners)
        rings.append(point + flat[:, :1] * side + flat[:, 1:] * up)
    triangles = [wall(a, b) for a, b in zip(rings, rings[1:])]
    for ring, step in ((rings[0], -1), (rings[-1], 1)):
        triangles.append(ring[np.array([(0, i, i + 1) for i in range(1, corners - 1)])[:, ::step]])
    return np.concatenate(triangles)


def curve(*points, steps=5):
    """A smooth path through points (Catmull and Rom)."""
    p = np.array([points[0], *points, points[-1]], dtype=float)
    path = []
    for i in range(1, len(p) - 2):
        for t in np.arange(steps) / steps:
            path.append(
                0.5
                * (
                    2 * p[i]
                    + (p[i + 1] - p[i - 1]) * t
                    + (2 * p[i - 1] - 5 * p[i] + 4 * p[i + 1] - p[i + 2]) * t**2
                    + (3 * p[i] - p[i - 1] - 3 * p[i + 1] + p[i + 2]) * t**3
                )
            )
    return np.array(path + [p[-2]])


# Axes: local z becomes x or y.
ALONG_X = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
ALONG_Y = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
DOWN = np.diag([1, -1, -1])


def stl_bytes(solid):
    """Binary STL, coordinates rounded to a micrometre so that every machine writes the same bytes."""
    corners = (np.round(solid, 3) + 0.0).astype("<f4")  # + 0.0: no negative zeros
    exact = corners.astype(float)
    normals = np.cross(exact[:, 1] - exact[:, 0], exact[:, 2] - exact[:, 0])
    normals = np.round(normals / np.linalg.norm(normals, axis=1, keepdims=True), 3) + 0.0
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    rows["normal"], rows["corners"] = normals, corners
    return b"koboshi, millimetres".ljust(80, b"\0") + struct.pack("<I", len(rows)) + rows.tobytes()
