"""`koboshi model import` of damaged files: it reads them or names the fault in one line, in time, and writes nowhere else.

The test plays a few mutants. For a campaign by hand, with another seed: mutated_imports_test.py PROGRAM 2000 7
"""

import random
import resource
import shutil
import struct
import sys
import unittest

import program as support

PROGRAM = None
COUNT = 24
SEED = 20261128
MAX_PROCESSOR_S = 5.0
TOKENS = [b"0", b"-1", b"1e300", b"nan", b"inf", b"1e-300", b"", b"<", b"\"", b"/>", b"fixed", b"continuous", b"body", b"l3", b"../../x",
          b"package://x/y.stl", b"/etc/passwd", b"-0.0", b"1e5", b"\xff"]
OUTPUTS = {"robot.sdf", "import.yaml", "import.md", "meshes", "robot.png", "boxes.png"}

# Joints of a side, parents before children: name, parent, axis, place, box, its height above the joint.
LEG = [("1", "body", "0 0 1", (0.0, 0.04, -0.03), (0.03, 0.03, 0.03), 0.0), ("2", "1", "1 0 0", (0, 0, 0), (0.03, 0.03, 0.03), 0.0),
       ("3", "2", "0 1 0", (0, 0, 0), (0.03, 0.03, 0.06), -0.04), ("4", "3", "0 1 0", (0, 0, -0.08), (0.03, 0.03, 0.06), -0.04),
       ("5", "4", "0 1 0", (0, 0, -0.08), (0.03, 0.03, 0.03), 0.0), ("6", "5", "1 0 0", (0, 0, 0), (0.1, 0.05, 0.01), -0.035)]
ARM = [("a", "body", "0 1 0", (0.0, 0.09, 0.13), (0.02, 0.02, 0.02), 0.0), ("b", "a", "1 0 0", (0, 0, 0), (0.02, 0.02, 0.06), -0.04),
       ("c", "b", "0 1 0", (0, 0, -0.08), (0.02, 0.02, 0.06), -0.04)]


def joints():
    for side, sign in (("l", 1.0), ("r", -1.0)):
        for name, parent, axis, (x, y, z), size, up in LEG + ARM:
            yield side + name, parent if parent == "body" else side + parent, axis, f"{x} {sign * y} {z}", size, up


def urdf():
    def link(name, size, up, extra=""):
        shape = f'<origin xyz="0 0 {up}"/><geometry><box size="{size[0]} {size[1]} {size[2]}"/></geometry>'
        return (f'<link name="{name}"><inertial><origin xyz="0 0 {up}"/><mass value="0.08"/><inertia ixx="3e-5" iyy="3e-5" izz="3e-5" '
                f'ixy="0" ixz="0" iyz="0"/></inertial><visual>{shape}</visual>{extra}<collision>{shape}</collision></link>\n')
    meshes = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in ("part.stl", "part.obj"))
    text = '<?xml version="1.0"?>\n<robot name="kit">\n' + link("body", (0.1, 0.12, 0.14), 0.07, meshes)
    for name, parent, axis, place, size, up in joints():
        text += link(name, size, up)
        text += (f'<joint name="j_{name}" type="revolute"><parent link="{parent}"/><child link="{name}"/><origin xyz="{place}"/>'
                 f'<axis xyz="{axis}"/><limit lower="-1.5" upper="1.5" effort="5" velocity="6"/></joint>\n')
    return text + "</robot>\n"


def mjcf():
    def body(name):
        inner = "".join(body(child) for child, parent, *_ in joints() if parent == name)
        if name == "body":
            return f'<body name="body" pos="0 0 0.3"><freejoint/><geom type="box" size="0.05 0.06 0.07" pos="0 0 0.07" mass="0.6"/>\n{inner}</body>\n'
        _, _, axis, place, size, up = next(joint for joint in joints() if joint[0] == name)
        return (f'<body name="{name}" pos="{place}"><joint name="j_{name}" axis="{axis}" range="-85 85"/>'
                f'<geom type="box" size="{size[0] / 2} {size[1] / 2} {size[2] / 2}" pos="0 0 {up}" mass="0.08"/>\n{inner}</body>\n')
    return f'<mujoco model="kit"><compiler angle="degree"/><worldbody>\n{body("body")}</worldbody></mujoco>\n'


def stl():
    corners = [(0, 0, 0), (0.03, 0, 0), (0, 0.03, 0), (0, 0, 0.03)]
    triangles = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *corners[a], *corners[b], *corners[c], 0) for a, b, c in triangles)
    return bytes(80) + struct.pack("<I", len(triangles)) + body


OBJ = b"v 0 0 0\nv 0.03 0 0\nv 0 0.03 0\nv 0 0 0.03\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def mutated(text, draw):
    data = bytearray(text)
    for _ in range(draw.randint(1, 3)):
        at = draw.randrange(len(data))
        kind = draw.randrange(10)
        if kind == 0:
            data[at] = draw.randrange(256)
        elif kind == 1:
            del data[at:at + draw.randint(1, 40)]
        elif kind == 2:
            begin = draw.randrange(len(data))
            data[at:at] = data[begin:begin + draw.randint(1, 200)]
        elif kind <= 5:
            digits = [i for i in range(at, min(at + 200, len(data))) if 0x30 <= data[i] <= 0x39]
            if digits:
                data[digits[0]] = draw.choice(b"0123456789")
        else:
            begin = data.find(b'"', at)
            end = data.find(b'"', begin + 1)
            if 0 <= begin < end:
                data[begin + 1:end] = draw.choice(TOKENS)
        if not data:
            data = bytearray(b" ")
    return bytes(data)


def processor_s():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class MutatedImports(unittest.TestCase):
    def test_are_read_or_refused(self):
        folder = support.temporary_folder(type(self))
        robot = support.ROOT / "robots" / "koboshi"
        whole = {"kit.urdf": urdf().encode(), "kit.sdf": (robot / "robot.sdf").read_bytes(), "kit.xml": mjcf().encode(),
                 "part.stl": stl(), "part.obj": OBJ}
        source = folder / "source"
        source.mkdir()
        (source / "meshes").symlink_to(robot / "meshes")
        (folder / "servos").symlink_to(robot.parent / "servos")
        robots = ["kit.urdf", "kit.sdf"]
        if b"mujoco" in PROGRAM.run("run", "--help").stdout.encode():
            robots.append("kit.xml")
        draw = random.Random(SEED)
        read, slowest_s = 0, 0.0
        for count in range(COUNT):
            victim = draw.choice(robots + ["part.stl", "part.obj"])
            for name, text in whole.items():
                (source / name).write_bytes(mutated(text, draw) if name == victim else text)
            before = sorted(str(path) for path in folder.rglob("*"))
            out = folder / "out"
            start_s = processor_s()
            result = PROGRAM.run("model", "import", source / (victim if victim in robots else "kit.urdf"), "-o", out)
            took_s = processor_s() - start_s
            slowest_s = max(slowest_s, took_s)
            with self.subTest(mutant=count, victim=victim):
                self.assertIn(result.returncode, (0, 2), result.stderr)
                self.assertLess(took_s, MAX_PROCESSOR_S)
                if result.returncode == 2:
                    self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                    self.assertFalse(out.exists())
                else:
                    read += 1
                    self.assertLessEqual({path.name for path in out.iterdir()}, OUTPUTS)
                    shutil.rmtree(out)
                self.assertEqual(sorted(str(path) for path in folder.rglob("*")), before)
        print(f"{COUNT} mutants, {read} read, {COUNT - read} refused, at most {slowest_s:.2f} s of processor time", file=sys.stderr)
        self.assertGreater(read, COUNT // 10)
        self.assertLess(read, COUNT)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        COUNT, SEED = int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else SEED
        del sys.argv[2:]
    PROGRAM = support.take_program_argument()
    unittest.main()
