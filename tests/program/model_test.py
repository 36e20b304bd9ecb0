"""Output, files and refusals of `koboshi model set` and `model get`."""

import pathlib
import re
import subprocess
import tempfile
import unittest

import program as support

PROGRAM = None
ROBOT = support.ROOT / "robots" / "koboshi" / "robot.sdf"


class ModelEdit(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="koboshi_model_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "meshes").symlink_to(ROBOT.parent / "meshes")
        self.file = self.folder / "robot.sdf"
        self.first = ROBOT.read_text()
        self.file.write_text(self.first)

    def test_sets_values_and_no_other_byte(self):
        result = PROGRAM.run("model", "set", self.file, "left_shank.mass=0.06", "left_knee.axis=0 1 0")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", "left_shank.mass = 0.06, taken as kg\n"))
        head, tail = self.first.split('<link name="left_shank">')
        self.assertEqual(self.file.read_text(),
                         head + '<link name="left_shank">' + tail.replace("<mass>0.05<", "<mass>0.06<", 1))
        result = PROGRAM.run("model", "set", self.file, "left_shank.mass=50 g")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(self.file.read_text(), self.first)

    def test_prints_a_difference_that_patch_applies(self):
        arguments = (self.file, "left_hip_roll.upper=80 deg", "left_foot.friction=0.6", "head.helmet.zoom=0.001 0.001 0.002",
                     "left_knee.position=1 0 0 mm", "--mirror")
        refused = PROGRAM.run("model", "set", *arguments, "--dry-run")
        self.assertEqual(refused.returncode, 2)  # the head has no other side
        arguments = [argument for argument in arguments if "helmet" not in str(argument)]
        result = PROGRAM.run("model", "set", *arguments, "--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.file.read_text(), self.first)
        self.assertEqual(len(re.findall(r"^\+ ", result.stdout, re.MULTILINE)), 6, result.stdout)
        patched = self.folder / "patched.sdf"
        patched.write_text(self.first)
        subprocess.run(["patch", "--silent", patched], input=result.stdout, text=True, check=True)
        written = self.folder / "written.sdf"
        self.assertEqual(PROGRAM.run("model", "set", *arguments, "-o", written).returncode, 0)
        self.assertEqual(self.file.read_text(), self.first)
        self.assertEqual(written.read_text(), patched.read_text())

    def test_gets_values(self):
        result = PROGRAM.run("model", "get", self.file, "left_shank.mass", "left_foot.friction", "left_knee.offset_rad")
        self.assertEqual((result.returncode, result.stdout), (0, "0.05\n0.8\n0\n"))
        result = PROGRAM.run("model", "get", self.file, "left_knee")
        self.assertRegex(result.stdout, r"(?m)^left_knee\.upper +2\.617994 +a number from -1000 to 1000 in rad$")
        self.assertIn("link left_shank\n", PROGRAM.run("model", "get", self.file).stdout)

    def test_refuses_bad_input_in_one_line_and_writes_nothing(self):
        bad = ("left_shank.mass", "=1", "left_shank.mass=-1", "left_shank.mass=heavy", "left_shank.mass=60 mm", "left_shank.mass=",
               "left_shnk.mass=1", "left_shank.weight=1", "trunk.bias=1", "left_knee.axis=0 1 1", "left_knee.axis=0 1",
               "left_knee.lower=3", "left_knee.node_id=18", "left_knee.servo=nothing", "trunk.ixx=1", "head.helmet.stl=no.stl",
               "left_foot.mu=11", "krs_2552.stribeck.exponent=1", "left_knee.relative_to=nobody")
        for word in bad:
            others = (("--dry-run",), ("-o", self.folder / "out.sdf")) if word == bad[2] else ()
            for arguments in ((), *others):
                with self.subTest(word, arguments=arguments):
                    result = PROGRAM.run("model", "set", self.file, "left_foot.friction=0.7", word, *arguments)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertEqual(result.stdout, "")
                    self.assertRegex(result.stderr, r"\A\S+\.sdf(:\d+)?: found [^\n]+, expected [^\n]+\n\Z")
                    self.assertEqual(self.file.read_text(), self.first)
                    self.assertFalse((self.folder / "out.sdf").exists())

    def test_asks_for_the_unit_of_an_implausible_number(self):
        questions = {"left_shank.mass=45": "45 kg for left_shank, .*; did you mean 45 g[?]",
                     "left_shank.mass=2000": "left_shank.mass = 2000, .*; did you mean 2000 g[?]",
                     "left_knee.upper=140": "140 rad for upper of left_knee, .*; did you mean 140 deg[?]",
                     "left_knee.speed=300": "300 rad/s for the speed of left_knee, .*; did you mean 300 deg/s[?]",
                     "left_shank.position=0 0 -65": "0 0 -65 m for the position of left_shank, .*; did you mean 0 0 -65 mm[?]",
                     "left_foot.size=110 70 12": "left_foot[.a-z]*size = 110 70 12, .*; did you mean 110 70 12 mm[?]",
                     "left_shank.rotation=0 90 0": "0 90 0 rad for the rotation of left_shank, .*; did you mean 0 90 0 deg[?]",
                     "left_shank.ixx=121": "121 kg m.2 for ixx of left_shank, .*; did you mean 121 g cm.2[?]",
                     "krs_2552.full_voltage_error_rad=7": "7 rad for full_voltage_error_rad of krs_2552, .*; did you mean 7 deg[?]",
                     "krs_2552.coulomb_friction_Nm=27.5": "27.5 N m for coulomb_friction_Nm of krs_2552, .*stall torque.*",
                     "krs_2552.rotor_inertia_kg_m2=1.16": "1.16 kg m.2 for rotor_inertia_kg_m2 of krs_2552, .*",
                     "krs_2552.supply_V=430": "430 V for supply_V of krs_2552, expected at most 120 V .*",
                     "battery.open_circuit_V=435": "435 V for the battery, expected at most 120 V .*",
                     "trunk.gyro.bias=20": "20 rad/s for the bias of imu of trunk, .*; did you mean 20 deg/s[?]",
                     "trunk.accelerometer.bias=490": "490 m/s.2 for the bias of imu of trunk, .*"}
        for word, question in questions.items():
            with self.subTest(word):
                result = PROGRAM.run("model", "set", self.file, word)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, rf"\A{self.file}:\d+: found {question}\n\Z")
                self.assertEqual(self.file.read_text(), self.first)
        # The same rule holds for the file itself.
        self.file.write_text(self.first.replace("<mass>0.05<", "<mass>45<", 1))
        result = PROGRAM.run("model", "check", self.file)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stdout, r"robot.sdf:\d+: error.R030.: found 45 kg for .*_shank, .*; did you mean 45 g[?]\n")

    def test_keeps_mode_and_hard_links(self):
        self.file.chmod(0o600)
        (self.folder / "link.sdf").hardlink_to(self.file)
        self.assertEqual(PROGRAM.run("model", "set", self.file, "left_shank.mass=60 g").returncode, 0)
        self.assertEqual(self.file.stat().st_mode & 0o777, 0o600)
        self.assertEqual((self.folder / "link.sdf").read_text(), self.file.read_text())
        self.assertNotEqual(self.file.read_text(), self.first)

    def in_element(self, tag, name, pattern, value):
        """The file with one change in the element of this name."""
        head, rest = self.first.split(f'<{tag} name="{name}"', 1)
        changed = re.sub(pattern, value, rest, count=1, flags=re.DOTALL)
        self.assertNotEqual(changed, rest, name)
        return f'{head}<{tag} name="{name}"{changed}'

    def test_check_accepts_legs_whose_axes_do_not_meet(self):
        (self.folder / "motions").symlink_to(ROBOT.parent / "motions")
        for name, text in {
            "an anchor off by 20 um": self.in_element("link", "left_thigh", r">0 0 0 0 0 0<", ">0 0.00002 0 0 0 0<"),
            "an axis off by 2.7e-6": self.in_element("joint", "left_hip_pitch", "0 1 0", "0 1 0.0000027"),
            "a knee aside": self.in_element("link", "left_shank", ">0 0 -0.065 ", ">0 0.0005 -0.065 "),
        }.items():
            with self.subTest(name):
                self.file.write_text(text)
                self.assertNotIn("error[R028]", PROGRAM.run("model", "check", self.file).stdout)

    def test_check_tells_what_the_firmware_cannot_run(self):
        cases = {
            "a renamed joint": (self.first.replace('"left_knee"', '"left_genou"'), "no joint left_knee beside right_knee"),
            "a roll axis that yaws": (re.sub(r'(<joint name="(?:left|right)_hip_roll".*?<xyz>)1 0 0<', r"\g<1>0 0 1<", self.first,
                                             flags=re.DOTALL),
                                      "the axis of left_hip_roll, 90 degrees from the base's x"),
            "no inertial unit": (re.sub(r'<sensor name="imu".*?</sensor>', "", self.first, flags=re.DOTALL), "no inertial unit"),
            "no ankle sensor": (re.sub(r'<sensor name="left_ankle".*?</sensor>', "", self.first, flags=re.DOTALL),
                                "a sensor in one ankle only"),
            "a heavy link": (self.in_element("link", "trunk", r"<mass>[^<]*<(.*?)<size>[^<]*<", r"<mass>32.2<\1<size>0.3 0.2 0.2<"),
                             "a mass of 32.2 kg in link trunk"),
        }
        (self.folder / "motions").symlink_to(ROBOT.parent / "motions")
        for name, (text, found) in cases.items():
            with self.subTest(name):
                self.file.write_text(text)
                result = PROGRAM.run("model", "check", self.file)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(f"error[R028]: found {found}", result.stdout)
                # The run refuses it with the same words.
                refused = PROGRAM.run("run", "squat", "--robot", self.folder, "--out", self.folder / "run")
                self.assertEqual(refused.returncode, 2)
                # The scenario names the joint, too.
                self.assertIn("left_knee" if name == "a renamed joint" else f": found {found}", refused.stderr)

    def test_refuses_files_that_are_no_robot(self):
        for text in ("", "<sdf>", "<a/>", "steps: []"):
            self.file.write_text(text)
            with self.subTest(text):
                result = PROGRAM.run("model", "set", self.file, "left_shank.mass=1")
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, r"\A\S+\.sdf(:\d+)?: found [^\n]+, expected [^\n]+\n\Z")
        self.assertEqual(PROGRAM.run("model", "get", pathlib.Path("nobody.sdf")).returncode, 2)


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
