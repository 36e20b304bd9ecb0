#!/usr/bin/env python3
"""The default robot's meshes: closed surfaces that hold together in every pose, and the output of tools/dev/make_meshes.py."""

import functools
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROBOT = ROOT / "robots" / "koboshi"
MAX_TRIANGLES = 60_000
TOLERANCE_mm = 0.002
TOLERANCE_RATIO = 1e-6
SIDES = {"left": 1, "right": -1}


@functools.cache
def triangles_of(file):
    """Corners (n, 3, 3) of a binary STL file, in its own unit."""
    data = file.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count, file
    rows = np.frombuffer(
        data, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")], count=count, offset=84
    )
    return rows["corners"].astype(float)


@functools.cache
def shells_of(file):
    """The connected surfaces of a file, and the indices of their corners among each one's distinct vertices."""
    corners = triangles_of(file)
    vertices, indices = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    indices = indices.reshape(-1, 3)
    label = np.arange(len(vertices))
    while True:  # every vertex takes the least label of its triangles
        least = label[indices].min(axis=1)
        before = label.copy()
        np.minimum.at(label, indices, least[:, None])
        label = label[label]
        if np.array_equal(before, label):
            break
    of_triangle = label[indices[:, 0]]
    return [(corners[of_triangle == each], indices[of_triangle == each]) for each in np.unique(of_triangle)]


def volume_of(corners):
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0


def area_of(corners):
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2.0


def numbers(element, default):
    return np.array([float(word) for word in (element.text if element is not None else default).split()])


def about(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Visual:
    def __init__(self, element):
        pose, mesh = numbers(element.find("pose"), "0 0 0 0 0 0"), element.find("geometry/mesh")
        self.name = element.get("name")
        self.file = ROBOT / mesh.find("uri").text
        self.scale = numbers(mesh.find("scale"), "1 1 1")
        self.rotation = about((0, 0, 1), pose[5]) @ about((0, 1, 0), pose[4]) @ about((1, 0, 0), pose[3])
        self.position = pose[:3]

    def shells(self):
        """In the link's frame, in millimetres."""
        return [1000 * (corners * self.scale @ self.rotation.T + self.position) for corners, _ in shells_of(self.file)]


MODEL = xml.parse(ROBOT / "robot.sdf").getroot().find("model")
LINKS = {link.get("name"): [Visual(each) for each in link.findall("visual")] for link in MODEL.findall("link")}


def spans(shells, origin, direction):
    """The intervals of a line within closed surfaces."""
    found = []
    for shell in shells:
        a, ab, ac = shell[:, 0], shell[:, 1] - shell[:, 0], shell[:, 2] - shell[:, 0]
        p = np.cross(direction, ac)
        determinant = np.sum(ab * p, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = origin - a
            u = np.sum(s * p, axis=1) / determinant
            q = np.cross(s, ab)
            v = np.sum(q * direction, axis=1) / determinant
            t = np.sum(q * ac, axis=1) / determinant
            crossings = np.sort(t[(np.abs(determinant) > 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1)])
        assert len(crossings) % 2 == 0, "a line enters a closed surface as often as it leaves it"
        found += list(zip(crossings[::2], crossings[1::2]))
    return found


def cross_each_other(one, other):
    """Whether an edge of one surface passes through a triangle of the other."""
    for edges_of, faces in ((one, other), (other, one)):
        low, high = faces.min(axis=(0, 1)), faces.max(axis=(0, 1))
        start, end = edges_of.reshape(-1, 3), np.roll(edges_of, -1, axis=1).reshape(-1, 3)
        near = np.all((np.maximum(start, end) >= low) & (np.minimum(start, end) <= high), axis=1)
        start, along = start[near][:, None], (end - start)[near][:, None]
        low, high = edges_of.min(axis=(0, 1)), edges_of.max(axis=(0, 1))
        faces = faces[np.all((faces.max(axis=1) >= low) & (faces.min(axis=1) <= high), axis=1)]
        a, ab, ac = faces[:, 0], faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
        p = np.cross(along, ac)
        with np.errstate(divide="ignore", invalid="ignore"):
            determinant = np.sum(ab * p, axis=2)
            s = start - a
            u = np.sum(s * p, axis=2) / determinant
            q = np.cross(s, np.broadcast_to(ab, s.shape))
            v = np.sum(q * along, axis=2) / determinant
            t = np.sum(q * ac, axis=2) / determinant
            if np.any((np.abs(determinant) > 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)):
                return True
    return False


class Meshes(unittest.TestCase):
    def test_files_are_what_the_generator_makes(self):
        with tempfile.TemporaryDirectory() as folder:
            made = pathlib.Path(folder)
            shutil.copy(ROBOT / "robot.sdf", made)
            subprocess.run([sys.executable, "-B", ROOT / "tools/dev/make_meshes.py", made], check=True)
            self.assertEqual((made / "robot.sdf").read_text(), (ROBOT / "robot.sdf").read_text())
            names = sorted(file.name for file in (made / "meshes").iterdir())
            self.assertEqual(names, sorted(file.name for file in (ROBOT / "meshes").iterdir()))
            for name in names:
                with self.subTest(name):
                    self.compare(made / "meshes" / name, ROBOT / "meshes" / name)

    def compare(self, made, kept):
        """NumPy rounds differently from version to version and from processor to processor (with and without AVX-512), which
        divides some flat faces along other diagonals: the same number of triangles, vertices within TOLERANCE_mm, and volume and
        area within TOLERANCE_RATIO of the kept ones."""
        there, here = triangles_of(made), triangles_of(kept)
        self.assertEqual(len(there), len(here))
        for some, others in ((there, here), (here, there)):
            some, others = np.unique(some.reshape(-1, 3), axis=0), np.unique(others.reshape(-1, 3), axis=0)
            for vertex in some:
                self.assertLess(np.abs(others - vertex).max(axis=1).min(), TOLERANCE_mm)
        self.assertAlmostEqual(volume_of(there) / volume_of(here), 1.0, delta=TOLERANCE_RATIO)
        self.assertAlmostEqual(area_of(there) / area_of(here), 1.0, delta=TOLERANCE_RATIO)

    def test_surfaces_are_closed_and_face_outwards(self):
        for file in sorted((ROBOT / "meshes").glob("*.stl")):
            for corners, indices in shells_of(file):
                edges = np.concatenate([indices[:, [0, 1]], indices[:, [1, 2]], indices[:, [2, 0]]])
                there, count = np.unique(edges, axis=0, return_counts=True)
                back = np.unique(edges[:, ::-1], axis=0)
                self.assertTrue(
                    np.all(count == 1) and np.array_equal(there, back), f"{file.name}: an edge without one neighbour each way"
                )
                doubled_areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
                self.assertGreater(doubled_areas.min(), 1e-4, f"{file.name}: a triangle without area")
                volume = np.sum(np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]) / 6
                self.assertGreater(volume, 0.1, f"{file.name}: a surface turned inside out")

    def test_there_are_not_too_many_triangles(self):
        total = sum(len(triangles_of(visual.file)) for visuals in LINKS.values() for visual in visuals)
        self.assertLessEqual(total, MAX_TRIANGLES)
        self.assertEqual(
            {visual.file for visuals in LINKS.values() for visual in visuals}, set((ROBOT / "meshes").glob("*.stl"))
        )

    def test_links_overlap_on_the_axis_of_their_joint(self):
        """A rotation of the joint leaves points on its axis in place: links that overlap there touch at every angle."""
        places = {link.get("name"): numbers(link.find("pose"), "")[:3] for link in MODEL.findall("link")}
        for joint in MODEL.findall("joint"):
            parent, child = joint.find("parent").text, joint.find("child").text
            axis = numbers(joint.find("axis/xyz"), "")
            beside = 0.1 * np.roll(axis, 1) + 0.07 * np.roll(axis, 2)  # avoids vertices on the axis
            of_parent = spans([s for v in LINKS[parent] for s in v.shells()], 1000 * places[child] + beside, axis)
            of_child = spans([s for v in LINKS[child] for s in v.shells()], beside, axis)
            overlap = max(min(p[1], c[1]) - max(p[0], c[0]) for p in of_parent for c in of_child)
            self.assertGreater(overlap, 0.1, joint.get("name"))

    def test_a_link_is_one_piece(self):
        for name, visuals in LINKS.items():
            shells = [(visual.name, shell) for visual in visuals for shell in visual.shells()]
            boxes = [(shell.min(axis=(0, 1)), shell.max(axis=(0, 1))) for _, shell in shells]
            reached, waiting = {0}, [0]
            while waiting:
                here = waiting.pop()
                for other in set(range(len(shells))) - reached:
                    apart = np.any(boxes[here][0] > boxes[other][1]) or np.any(boxes[other][0] > boxes[here][1])
                    if not apart and cross_each_other(shells[here][1], shells[other][1]):
                        reached.add(other)
                        waiting.append(other)
            loose = [(shells[i][0], np.round((boxes[i][0] + boxes[i][1]) / 2, 1)) for i in set(range(len(shells))) - reached]
            self.assertEqual(loose, [], name)

    def test_covers_stay_near_the_collision_box(self):
        joints = ("servo", "label", "horn", "horns", "fork", "bracket", "strut", "frame")  # no box covers the joints
        for link in MODEL.findall("link"):
            box = link.find("collision")
            if box is None:
                continue
            middle, half = numbers(box.find("pose"), "")[:3] * 1000, numbers(box.find("geometry/box/size"), "") * 500
            for visual in LINKS[link.get("name")]:
                if not visual.name.endswith(joints):
                    points = np.concatenate([shell.reshape(-1, 3) for shell in visual.shells()])
                    outside = np.linalg.norm(np.maximum(np.abs(points - middle) - half, 0), axis=1)
                    self.assertLess(outside.max(), 5.5, f"{link.get('name')}: {visual.name}, in millimetres")

    def test_soles_are_level_with_the_collision_box(self):
        for side in SIDES:
            box = next(link for link in MODEL.findall("link") if link.get("name") == f"{side}_foot").find("collision")
            middle, size = numbers(box.find("pose"), "")[:3] * 1000, numbers(box.find("geometry/box/size"), "") * 1000
            points = np.concatenate([shell.reshape(-1, 3) for visual in LINKS[f"{side}_foot"] for shell in visual.shells()])
            sole = np.concatenate(
                [
                    shell.reshape(-1, 3)
                    for visual in LINKS[f"{side}_foot"]
                    if visual.name == "foot_sole"
                    for shell in visual.shells()
                ]
            )
            self.assertAlmostEqual(points[:, 2].min(), middle[2] - size[2] / 2, places=4)
            np.testing.assert_allclose(sole[:, :2].min(axis=0), (middle - size / 2)[:2], atol=1e-4)
            np.testing.assert_allclose(sole[:, :2].max(axis=0), (middle + size / 2)[:2], atol=1e-4)


if __name__ == "__main__":
    unittest.main()
