#!/usr/bin/python3
"""draw_robot.py ROBOT.sdf TRACE.csv OUT.png TIME_s...: draws the robot as it stood at these times of a run, side by side.

For pictures in the documentation; needs python3-numpy and python3-matplotlib. Reads just what robots/koboshi/robot.sdf uses: links
whose poses are translations relative to other links, hinges, boxes and binary STL meshes as visuals, with their colours.
"""

import csv
import pathlib
import struct
import sys
import xml.etree.ElementTree as xml

import matplotlib.image
import numpy as np

VIEW = np.radians([62.0, 14.0])  # azimuth from ahead to the robot's left, elevation
LIGHT = np.array([0.5, 0.6, 0.8]) / np.linalg.norm([0.5, 0.6, 0.8])
PIXELS_PER_M, TILE = 2600, (1150, 1000)  # oversampled twofold; height, width
BOX_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
BOX_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def numbers(element, default="0 0 0 0 0 0"):
    return np.array([float(word) for word in (element.text if element is not None else default).split()])


def turn(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def rpy(angles):
    r, p, y = angles
    return turn((0, 0, 1), y) @ turn((0, 1, 0), p) @ turn((1, 0, 0), r)


def box_triangles(size):
    corners = BOX_CORNERS * size
    return np.array([[corners[f[0]], corners[f[i]], corners[f[i + 1]]] for f in BOX_FACES for i in (1, 2)])


def stl_triangles(file, scale):
    data = file.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    rows = np.frombuffer(data, dtype=np.dtype("<12f4,<u2"), count=count, offset=84)
    return rows["f0"].reshape(count, 4, 3)[:, 1:, :].astype(float) * scale


class Robot:
    def __init__(self, file):
        model = xml.parse(file).getroot().find("model")
        self.links, self.joints = {}, []
        for link in model.findall("link"):
            pose = link.find("pose")
            shapes = []
            for visual in link.findall("visual"):
                at = numbers(visual.find("pose"))
                mesh, box = visual.find("geometry/mesh"), visual.find("geometry/box/size")
                if mesh is not None:
                    scale = numbers(mesh.find("scale"), "1 1 1")
                    shape = stl_triangles(pathlib.Path(file).parent / mesh.find("uri").text, scale)
                else:
                    shape = box_triangles(numbers(box))
                colour = numbers(visual.find("material/diffuse"), "0.8 0.8 0.8 1")[:3]
                shapes.append((colour, shape @ rpy(at[3:]).T + at[:3]))
            self.links[link.get("name")] = (numbers(pose)[:3], shapes)
        for joint in model.findall("joint"):
            axis = numbers(joint.find("axis/xyz"))
            self.joints.append((joint.get("name"), joint.find("parent").text, joint.find("child").text, axis))

    def triangles(self, row):
        base = np.array([float(row[f"true_base_{axis}_m"]) for axis in "xyz"])
        attitude = rpy([float(row[f"true_{name}_rad"]) for name in ("roll", "pitch", "yaw")])
        frames = {"trunk": (attitude, base)}
        waiting = list(self.joints)
        while waiting:
            name, parent, child, axis = waiting.pop(0)
            if parent not in frames:
                waiting.append((name, parent, child, axis))
                continue
            rotation, origin = frames[parent]
            angle = float(row[f"{name}_true_rad"])
            frames[child] = (rotation @ turn(axis, angle), origin + rotation @ self.links[child][0])
        for name, (rotation, origin) in frames.items():
            for colour, triangles in self.links[name][1]:
                yield colour, triangles @ rotation.T + origin


def draw_tile(shapes, middle_x):
    height, width = TILE
    image = np.ones((height, width, 3))
    depth = np.full((height, width), -np.inf)
    azimuth, elevation = VIEW
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    towards = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)])
    up = np.cross(towards, right)
    ground = np.array([[[-0.1, -0.11, 0], [0.14, -0.11, 0], [0.14, 0.11, 0]], [[-0.1, -0.11, 0], [0.14, 0.11, 0],
                                                                             [-0.1, 0.11, 0]]])
    ground[:, :, 0] += middle_x
    for colour, triangles in [((0.86, 0.87, 0.88), ground), *shapes]:
        for triangle in triangles:
            normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
            length = np.linalg.norm(normal)
            if length == 0 or normal @ towards <= 0:
                continue
            shade = 0.45 + 0.55 * max(0.0, normal @ LIGHT / length)
            local = triangle - [middle_x, 0, 0]
            u = width / 2 + PIXELS_PER_M * local @ right
            v = height * 0.93 - PIXELS_PER_M * local @ up
            w = local @ towards
            fill(image, depth, u, v, w, np.array(colour) * shade)
    return image.reshape(height // 2, 2, width // 2, 2, 3).mean(axis=(1, 3))


def fill(image, depth, u, v, w, colour):
    u0, u1 = max(int(u.min()), 0), min(int(u.max()) + 2, image.shape[1])
    v0, v1 = max(int(v.min()), 0), min(int(v.max()) + 2, image.shape[0])
    area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0])
    if u0 >= u1 or v0 >= v1 or area == 0:
        return
    x, y = np.meshgrid(np.arange(u0, u1) + 0.5, np.arange(v0, v1) + 0.5)
    b = ((x - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (y - v[0])) / area
    c = ((u[1] - u[0]) * (y - v[0]) - (x - u[0]) * (v[1] - v[0])) / area
    inside = (b >= 0) & (c >= 0) & (b + c <= 1)
    near = w[0] + b * (w[1] - w[0]) + c * (w[2] - w[0])
    window = depth[v0:v1, u0:u1]
    hit = inside & (near > window)
    window[hit] = near[hit]
    image[v0:v1, u0:u1][hit] = colour


def main(robot_file, trace_file, out, *times_s):
    robot = Robot(robot_file)
    with open(trace_file, newline="") as file:
        rows = list(csv.DictReader(file))
    tiles = []
    for time_s in map(float, times_s):
        row = min(rows, key=lambda each: abs(float(each["time_s"]) - time_s))
        tiles.append(draw_tile(list(robot.triangles(row)), float(row["true_base_x_m"])))
    matplotlib.image.imsave(out, np.clip(np.concatenate(tiles, axis=1), 0, 1))


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__.splitlines()[0])
    main(*sys.argv[1:])
