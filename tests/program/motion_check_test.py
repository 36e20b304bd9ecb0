"""Exit status, messages and files of `koboshi motion check`, `plot` and `preview`."""

import json
import unittest

import program as support

PROGRAM = None
MOTIONS = support.ROOT / "robots" / "koboshi" / "motions"
HEAD = ("version: 2\nrobot: koboshi\nname: test\nposes:\n"
        "  stand: {others: zero, hip_pitch: -15.9, knee: 43.72, ankle_pitch: -27.82, shoulder_roll: 8}\n")
BAD = HEAD + "  a: {left_kne: 3}\nsteps:\n  - {pose: a, time_s: 1}\n"
FALLS = HEAD + "  a: {from: stand, ankle_pitch: -55}\nsteps:\n  - {pose: stand, time_s: 1}\n  - {pose: a, time_s: 2}\n"


class MotionCheck(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def written(self, name, text):
        file = self.folder / name
        file.write_text(text)
        return file

    def test_a_stable_motion_has_status_0(self):
        result = PROGRAM.run("motion", "check", MOTIONS / "wave.yaml", "--steps")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"(?m)^stable: least margin \d+\.\d mm at \d+\.\d\d s, line \d+, pose \w+$")
        self.assertRegex(result.stdout, r"(?m)^ +0 +\d+ +pose \w+ ")

    def test_the_motion_that_sits_down_has_no_finding(self):
        """It is judged on its feet to its end, which is another pose than that of other motions."""
        result = PROGRAM.run("motion", "check", MOTIONS / "sit.yaml", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual(report["findings"], [])
        self.assertEqual(report["verdict"], "stable")
        other = self.written("crouch.yaml", (MOTIONS / "sit.yaml").read_text().replace("name: sit", "name: crouch"))
        report = json.loads(PROGRAM.run("motion", "check", other, "--json").stdout)
        self.assertEqual([finding["code"] for finding in report["findings"]], ["C013"])

    def test_a_motion_that_falls_has_status_1(self):
        result = PROGRAM.run("motion", "check", self.written("falls.yaml", FALLS))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertRegex(result.stdout, r"falls\.yaml:9:5: error\[C006\]: found the (ZMP|centre of mass) \d+ mm outside")
        self.assertRegex(result.stdout, r"(?m)^unstable: ")

    def test_json_holds_verdict_findings_and_steps(self):
        result = PROGRAM.run("motion", "check", self.written("json.yaml", FALLS), "--json")
        self.assertEqual(result.returncode, 1, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual(report["verdict"], "unstable")
        self.assertIn("C006", [finding["code"] for finding in report["findings"]])
        self.assertEqual([step["line"] for step in report["steps"][:2]], [8, 9])
        self.assertLess(report["least_margin_mm"], -2.0)

    def test_a_refused_motion_has_status_2_and_all_places(self):
        file = self.written("bad.yaml", BAD)
        for command in (["check"], ["plot", "-o", self.folder / "x.png"], ["preview", "-o", self.folder / "x.png"]):
            with self.subTest(command[0]):
                result = PROGRAM.run("motion", *command, file)
                self.assertEqual(result.returncode, 2)
                self.assertIn("bad.yaml:6:7: error[M010]", result.stderr)
                self.assertIn("^~~~~~~~", result.stderr)
                self.assertIn("did you mean `left_knee`?", result.stderr)
        self.assertFalse((self.folder / "x.png").exists())

    def test_plot_writes_the_file(self):
        for name, begin in (("plot.png", b"\x89PNG"), ("plot.svg", b"<?xml")):
            with self.subTest(name):
                out = self.folder / name
                result = PROGRAM.run("motion", "plot", MOTIONS / "wave.yaml", "-o", out)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertTrue(out.read_bytes().startswith(begin))

    def test_plot_refuses_another_extension(self):
        result = PROGRAM.run("motion", "plot", MOTIONS / "wave.yaml", "-o", self.folder / "plot.txt")
        self.assertEqual(result.returncode, 2)
        self.assertFalse((self.folder / "plot.txt").exists())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
