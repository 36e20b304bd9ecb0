"""`koboshi model reference`: the committed page and schemas are the program's, and the schemas refuse bad files."""

import re
import subprocess
import unittest

import program as support

PROGRAM = None
KEPT = support.ROOT / "docs" / "reference"
PRINTED = {"robot-file.md": "page", "robot.xsd": "xsd", "robot-koboshi.xsd": "koboshi-xsd"}
ROBOT = (support.ROOT / "robots" / "koboshi" / "robot.sdf").read_text()

# Faults: the text that is replaced, the new one, and a word of the validator's complaint.
BAD = {
    "an unknown element": ("<mass>0.36</mass>", "<mass>0.36</mass><weight>1</weight>", "weight"),
    "an unknown koboshi: element": ("<koboshi:battery ", "<koboshi:fuel/><koboshi:battery ", "fuel"),
    "an unknown attribute": (' sign="', ' sing="', "sing"),
    "a missing element of an unordered group": ("<mass>0.36</mass>", "", "Missing child"),
    "a missing element of a link": ("<inertial>", "<!--", "link_has_one_inertial"),
    "a missing element of a joint": ('<koboshi:servo type="krs_2552"/>', "", "joint_has_one_servo"),
    "a missing attribute": (' bits="12"', "", "bits"),
    "a second element of a link": ("<inertial>", "<pose>0 0 0 0 0 0</pose><inertial>", "link_has_at_most_one_pose"),
    "a second battery": ("<link name=\"trunk\">", '<koboshi:battery open_circuit_V="7" internal_resistance_ohm="0"/>'
                         '<link name="trunk">', "model_has_at_most_one_battery"),
    "a mass that is not positive": ("<mass>0.36</mass>", "<mass>-0.36</mass>", "-0.36"),
    "a number that is none": ("<mass>0.36</mass>", "<mass>NaN</mass>", "NaN"),
    "too few numbers": ("<pose>0 0 0.17 0 0 0</pose>", "<pose>0 0 0.17</pose>", "length"),
    "a number out of range in a list": ("<diffuse>0.76", "<diffuse>76", "76"),
    "a fraction for an integer": ('node_id="16"', 'node_id="16.5"', "16.5"),
    "an integer out of range": ('node_id="16"', 'node_id="128"', "128"),
    "a node id twice": ('node_id="16"', 'node_id="17"', "node_ids"),
    "another version": ('version="1.9"', 'version="1.4"', "1.4"),
    "another kind of joint": ('type="revolute"', 'type="prismatic"', "prismatic"),
    "another side": ('"left_ankle" type', '"west_ankle" type', "west_ankle"),
    "a link that is not there": ("<parent>trunk</parent>", "<parent>trunc</parent>", "parent_links"),
    "a name twice": ('<link name="head">', '<link name="neck">', "neck"),
    "a library without a file": ("<koboshi:battery ", "<koboshi:servo_types/><koboshi:battery ", "library_files"),
    "a text between elements": ("<inertial>", "mass: <inertial>", "Character content"),
}


def validate(file, schema="robot.xsd"):
    return subprocess.run(["xmllint", "--nonet", "--noout", "--schema", KEPT / schema, file], capture_output=True,
                          text=True, timeout=60, check=False)


class Reference(unittest.TestCase):
    def test_writes_what_the_repository_keeps(self):
        folder = support.temporary_folder(type(self))
        result = PROGRAM.run("model", "reference", "write", "--folder", folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({file.name for file in folder.iterdir()}, set(PRINTED))
        for name in PRINTED:
            self.assertTrue((folder / name).read_bytes() == (KEPT / name).read_bytes(), name)

    def test_prints_each(self):
        for name, argument in PRINTED.items():
            result = PROGRAM.run("model", "reference", argument)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertTrue(result.stdout == (KEPT / name).read_text(), name)

    def test_page_has_a_row_for_each_key_of_the_robot(self):
        page = (KEPT / "robot-file.md").read_text()
        named = {name for row in re.findall(r"^\| `([^`]+)`", page, re.MULTILINE) for name in re.split("[/@]", row)}
        text = re.sub(r"<!--.*?-->", "", ROBOT, flags=re.DOTALL)
        used = set(re.findall(r"<([a-zA-Z_:0-9]+)", text)) | set(re.findall(r' ([a-zA-Z_:0-9]+)="', text))
        self.assertGreater(len(used), 90)
        self.assertEqual(used - named - {"sdf", "model", "version", "xmlns:koboshi"}, set())


class Schema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.file = support.temporary_folder(cls) / "robot.sdf"

    def validate_text(self, text):
        self.file.write_text(text)
        return validate(self.file)

    def test_accepts_the_robots_and_libraries(self):
        robots = sorted((support.ROOT / "robots").glob("*/robot.sdf"))
        self.assertGreaterEqual(len(robots), 1)
        for robot in robots:
            result = validate(robot)
            self.assertEqual(result.returncode, 0, result.stderr)
        for library in sorted((support.ROOT / "robots" / "servos").glob("*.xml")):
            result = validate(library, "robot-koboshi.xsd")
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_accepts_any_order_and_imports(self):
        mass = "<mass>0.36</mass>"
        turned = ROBOT.replace(mass, "", 1).replace("<inertial>", "<inertial>" + mass, 1)
        turned = turned.replace("<koboshi:battery ", '<koboshi:servo_types file="../servos/bam.xml"/><koboshi:battery ', 1)
        result = self.validate_text(turned)
        self.assertEqual(result.returncode, 0, result.stderr)
        if PROGRAM is not None:  # the reader agrees
            (self.file.parent / "meshes").symlink_to(support.ROOT / "robots" / "koboshi" / "meshes")
            self.file.write_text(turned.replace("../servos", str(support.ROOT / "robots" / "servos")))
            result = PROGRAM.run("model", "check", self.file)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_refuses_planted_errors(self):
        for what, (before, after, complaint) in BAD.items():
            with self.subTest(what):
                self.assertIn(before, ROBOT)
                text = ROBOT.replace(before, after, 1)
                if after == "<!--":
                    text = text.replace("</inertial>", "-->", 1)
                result = self.validate_text(text)
                self.assertEqual(result.returncode, 3, result.stderr)  # does not validate
                self.assertIn(complaint, result.stderr)

    def test_names_the_line(self):
        before = ROBOT[:ROBOT.index("<mass>")]
        result = self.validate_text(ROBOT.replace("<mass>0.36<", "<mass>heavy<", 1))
        self.assertIn(f"robot.sdf:{before.count(chr(10)) + 1}: element mass", result.stderr)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
