"""koboshi servo: measurements of servos on a test bench, and servo types from data sheets."""

import csv
import math
import pathlib
import re
import tempfile
import unittest
import xml.etree.ElementTree

import program as support

PROGRAM = None
LIBRARY = support.ROOT / "robots" / "servos" / "bam.xml"
ROBOT = support.ROOT / "robots" / "koboshi" / "robot.sdf"
FIGURES = ("backlash", "friction_load", "friction_speed", "sine", "step", "torque_speed")
SHEET = {"--stall-torque-Nm": "1.373", "--no-load-speed-rad-per-s": "7.48", "--voltage-V": "7.5", "--ratio": "276"}


def sheet_arguments(changes=None):
    sheet = SHEET | (changes or {})
    return [word for pair in sheet.items() for word in pair]


def columns(file):
    with open(file, newline="") as text:
        rows = list(csv.DictReader(text))
    return {name: [float(row[name]) for row in rows if row[name]] for name in rows[0]}


class Catalogue(unittest.TestCase):
    def test_mx_106_is_the_identified_servo(self):
        def values(library, name):
            types = xml.etree.ElementTree.parse(LIBRARY.with_name(library)).getroot()
            found, = [servo for servo in types if servo.get("name") == name]
            return [(value.tag, value.text, value.attrib) for value in found]
        self.assertEqual(values("catalogue.xml", "mx_106"), values("bam.xml", "mx_106_m6"))

    def test_mx_106_is_a_name_for_the_import(self):
        with tempfile.TemporaryDirectory(prefix="koboshi_servo_") as folder:
            # The servo is looked up after the joints are known: the default robot's own model will do.
            urdf = pathlib.Path(folder, "robot.urdf")
            exported = PROGRAM.run("model", "export", ROBOT, "--urdf", urdf)
            self.assertEqual(exported.returncode, 0, exported.stderr)
            text = re.sub(r"<koboshi.*?</koboshi>", "", urdf.read_text(), flags=re.DOTALL)
            urdf.write_text(text)
            result = PROGRAM.run("model", "import", urdf, "-o", pathlib.Path(folder, "out"), "--servo", "mx_106")
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertIn("mx_106", pathlib.Path(folder, "out", "robot.sdf").read_text())


class Plot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.out = cls.folder / "mx"
        cls.result = PROGRAM.run("servo", "plot", LIBRARY, "--type", "mx_106_m6", "--out", cls.out)

    def test_writes_each_figure_and_its_table(self):
        self.assertEqual(self.result.returncode, 0, self.result.stderr)
        names = sorted(file.name for file in (self.out / "mx_106_m6").iterdir())
        self.assertEqual(names, sorted(f"{name}.{kind}" for name in FIGURES for kind in ("csv", "png", "svg")))
        self.assertEqual([folder.name for folder in self.out.iterdir()], ["mx_106_m6"])
        for name in FIGURES:
            self.assertGreater((self.out / "mx_106_m6" / f"{name}.png").stat().st_size, 5000, name)

    def test_drives_less_load_than_its_motor_alone(self):
        table = columns(self.out / "mx_106_m6" / "torque_speed.csv")
        stall = 2.21 * 0.9625 * 15 / 2.034
        self.assertLess(table["speed_rad_per_s"][0], 0.9625 * 15 / 2.21)
        self.assertGreater(table["speed_rad_per_s"][0], 0.8 * 0.9625 * 15 / 2.21)
        self.assertLess(max(table["load_Nm"]), 0.95 * stall)  # the gear friction grows with the load
        self.assertGreater(max(table["load_Nm"]), 0.4 * stall)
        for fast, slow in zip(table["speed_rad_per_s"], table["speed_rad_per_s"][1:]):
            self.assertGreaterEqual(fast, slow)

    def test_is_harder_to_drive_back_than_to_hold(self):
        table = columns(self.out / "mx_106_m6" / "friction_load.csv")
        for motor, lifts, back in zip(table["motor_Nm"], table["lifts_Nm"], table["driven_back_Nm"]):
            self.assertLess(lifts, motor)
            self.assertGreater(back, motor)

    def test_repeats_to_the_byte(self):
        again = self.folder / "again"
        PROGRAM.run("servo", "plot", LIBRARY, "--type", "mx_106_m6", "--out", again)
        for name in FIGURES:
            self.assertEqual((self.out / "mx_106_m6" / f"{name}.csv").read_bytes(),
                             (again / "mx_106_m6" / f"{name}.csv").read_bytes(), name)

    def test_reads_robots_too(self):
        result = PROGRAM.run("servo", "plot", ROBOT, "--out", self.folder / "robot")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "robot" / "krs_2552" / "step.png").is_file())

    def test_refuses_in_one_line(self):
        out = self.folder / "nothing"
        file = self.folder / "letter.txt"
        file.write_text("dear reader")
        bad = self.folder / "bad.xml"
        bad.write_text(LIBRARY.read_text().replace('exponent="1.836"', 'exponent="99"'))
        line = 1 + LIBRARY.read_text().split("\n").index(
            next(text for text in LIBRARY.read_text().split("\n") if 'exponent="1.836"' in text))
        for expected, arguments in (
                ("--type: found tail, expected ", [LIBRARY, "--type", "tail", "--out", out]),
                ("nothing.xml: found no such file, and no robot of this name in .*, expected ", ["nothing.xml", "--out", out]),
                (f"{re.escape(str(bad))}:{line}: found exponent = 99, expected a number from 0.1 to 20", [bad, "--out", out]),
                (f"{re.escape(str(file))}: found a file, expected a folder", [LIBRARY, "--out", file])):
            result = PROGRAM.run("servo", "plot", *arguments)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertRegex(result.stderr, f"^{expected}")
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertFalse(out.exists())


class FromDatasheet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def test_makes_a_type_that_stalls_and_turns_as_the_sheet_says(self):
        result = PROGRAM.run("servo", "from-datasheet", *sheet_arguments(), "--name", "krs")
        self.assertEqual(result.returncode, 0, result.stderr)
        number = {name: float(value) for name, value in re.findall(r"<(\w+)>([^<]+)</", result.stdout)}
        kt, resistance, volt = (number[name] for name in ("torque_constant_Nm_per_A", "resistance_ohm", "supply_V"))
        coulomb, viscous = number["coulomb_friction_Nm"], number["viscous_friction_Nm_s"]
        self.assertAlmostEqual(kt * volt / resistance - coulomb, 1.373, delta=0.002)
        speed = (kt * volt / resistance - coulomb) / (kt * kt / resistance + viscous)
        self.assertAlmostEqual(speed, 7.48, delta=0.01)
        # Within 10 % of the identified servo of the same type.
        self.assertAlmostEqual(kt / 1.0027, 1.0, delta=0.1)
        self.assertAlmostEqual(resistance / 5.477, 1.0, delta=0.1)
        self.assertIn("Assumed", result.stdout)

    def test_what_it_prints_can_be_plotted(self):
        file = self.folder / "krs.xml"
        file.write_text(PROGRAM.run("servo", "from-datasheet", *sheet_arguments(), "--name", "krs").stdout)
        result = PROGRAM.run("servo", "plot", file, "--out", self.folder / "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        table = columns(self.folder / "out" / "krs" / "torque_speed.csv")
        self.assertAlmostEqual(table["speed_rad_per_s"][0], 7.48, delta=0.02)
        self.assertTrue(math.isclose(max(table["load_Nm"]), 1.373, rel_tol=0.05))

    def test_refuses_in_one_line(self):
        for expected, changes in (
                (r"--ratio: found 0, expected a number from 1 to 1e\+05", {"--ratio": "0"}),
                ("--voltage-V: found -7.5, expected ", {"--voltage-V": "-7.5"}),
                (r"servo type:\d+: found <resistance_ohm> = .*, expected a number from", {"--stall-torque-Nm": "0.001"}),
                ("--name: found a<b, expected ", {"--name": "a<b"})):
            result = PROGRAM.run("servo", "from-datasheet", *sheet_arguments(changes))
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertRegex(result.stderr, f"^{expected}")
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertEqual(result.stdout, "")


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
