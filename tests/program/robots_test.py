"""The robots of this project beside Koboshi: their files are what the script writes, pass the check, stand and walk."""

import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import unittest

import program as support

PROGRAM = None
ROBOTS = support.ROOT / "robots"
NAMES = ("chibi", "hanpo", "noppo")


class Robots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)

    def test_are_what_the_script_writes(self):
        result = subprocess.run([sys.executable, ROBOTS / "make_robots.py", "--check"], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_pass_the_model_check(self):
        joints = {"chibi": 17, "hanpo": 20, "noppo": 23}
        for name in NAMES:
            with self.subTest(name):
                result = PROGRAM.run("model", "check", ROBOTS / name / "robot.sdf")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.assertNotRegex(result.stdout + result.stderr, r"(error|warning)\[")
                self.assertEqual((ROBOTS / name / "robot.sdf").read_text().count("<joint "), joints[name])

    def test_are_checked_together_whatever_is_found_in_one(self):
        broken = self.folder / "broken.sdf"
        broken.write_text((ROBOTS / "hanpo" / "robot.sdf").read_text().replace("<mass>", "<mass>-", 1))
        result = PROGRAM.run("model", "check", ROBOTS / "chibi", broken, "noppo")
        self.assertEqual(result.returncode, 1, result.stderr)
        headings = [line for line in result.stdout.splitlines() if line.endswith("robot.sdf:") or line.endswith("broken.sdf:")]
        self.assertEqual([pathlib.Path(line).name for line in headings], ["robot.sdf:", "broken.sdf:", "robot.sdf:"], result.stdout)
        self.assertRegex(result.stdout, r"broken\.sdf:\d+: error\[R011\]: ")
        self.assertEqual(set(re.findall("(.*):[0-9]+: error", result.stdout)), {str(broken)}, result.stdout)
        self.assertRegex(result.stdout, "(?m)^chibi: 18 links, 17 joints")
        self.assertRegex(result.stdout, "(?m)^noppo: 24 links, 23 joints")
        result = PROGRAM.run("model", "check", "--json", ROBOTS / "chibi", "nosuch.sdf", "noppo")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, r"\Anosuch\.sdf: found no such file, .*\n\Z")
        self.assertEqual([robot["robot"] for robot in json.loads(result.stdout)], ["chibi", "noppo"])

    def test_walk_with_the_values_of_bring_up(self):
        for name in NAMES:
            with self.subTest(name):
                result = PROGRAM.run("run", ROBOTS / name / "go.yaml", "--stepper", "lumped", "--record", "no", "--duration", 8,
                                     "--out", self.folder / name)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.assertIn("walks; did not fall; 0 faults", result.stdout)

    def test_of_which_there_is_only_the_file_runs_without_what_its_folder_lacks(self):
        bare = self.folder / "bare"
        bare.mkdir()
        # Another name: a copy under its own name takes the motions of its namesake.
        text = (ROBOTS / "koboshi" / "robot.sdf").read_text()
        (bare / "robot.sdf").write_text(text.replace('<model name="koboshi"', '<model name="bare"'))
        shutil.copytree(ROBOTS / "koboshi" / "meshes", bare / "meshes")
        result = PROGRAM.run("run", "go", "--robot", bare, "--stepper", "lumped", "--record", "no", "--duration", 5,
                             "--out", self.folder / "bare_run")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        warnings = [line for line in result.stderr.splitlines() if "leaves out" in line]
        self.assertEqual(len(warnings), 1, result.stderr)
        self.assertIn("bare lacks, and the run leaves out: motion stand, parameter file standing; koboshi bring-up ", warnings[0])
        self.assertIn("stands; did not fall; 1 command refused; 0 faults", result.stdout)  # to walk, without a gait
        summary = json.loads((self.folder / "bare_run" / "summary.json").read_text())
        self.assertEqual(summary["lost_abilities"], ["stand", "standing"])
        result = PROGRAM.run("run", "go", "--robot", bare, "--set", "parameter_file=standign", "--out", self.folder / "refused")
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertIn("standign", result.stderr)

    def test_says_how_long_a_scenario_lasts_that_does_not_end_soon(self):
        for robot in ((), ("--robot", ROBOTS / "noppo")):
            with self.subTest(robot):
                command = [PROGRAM.path, "run", "board", *robot, "--record", "no", "--out", self.folder / "board"]
                with subprocess.Popen(command, cwd=support.ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as run:
                    self.assertEqual(run.stderr.readline(), "koboshi: warning: the scenario lasts 86400 s, 24.0 h of simulated time; "
                                                            "--duration sets another time\n")
                    run.send_signal(signal.SIGINT)
                    run.stderr.read()
                self.assertIn(run.returncode, (130, -signal.SIGINT))  # the signal may come before its handler


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
