"""Short version of the physics validation, and the files and errors of `koboshi validate`."""

import csv
import json
import pathlib
import unittest

import program as support

PROGRAM = None
EXPERIMENTS = ["free-fall", "bounce", "slope", "pendulum", "tennis-racket", "momentum", "inverted-pendulum", "servo",
               "friction", "zmp", "convergence"]


class Validate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = support.temporary_folder(cls)
        cls.result = PROGRAM.run("validate", "--short", "--only", "free-fall", "--only", "momentum", "--out",
                                 cls.folder / "out")
        cls.summary = json.loads((cls.folder / "out" / "summary.json").read_text())

    def checks(self):
        return [check for experiment in self.summary["experiments"] for check in experiment["checks"]]

    def test_all_passed(self):
        self.assertTrue(all(check["passed"] for check in self.checks()), self.summary)
        self.assertEqual(self.result.returncode, 0, self.result.stdout)

    def test_only_the_named_experiments_took_place(self):
        self.assertEqual([experiment["experiment"] for experiment in self.summary["experiments"]],
                         ["free-fall", "momentum"])
        self.assertEqual((self.summary["stepper"], self.summary["step_s"]), ("world", 0.001))

    def test_help_names_every_experiment(self):
        text = PROGRAM.run("validate", "--help").stdout
        for name in EXPERIMENTS:
            self.assertRegex(text, rf"(?m)^  {name} ")

    def test_table_says_the_same_as_files(self):
        with open(self.folder / "out" / "checks.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["quantity"] for row in rows], [check["quantity"] for check in self.checks()])
        for row in rows:
            self.assertIn(row["quantity"], self.result.stdout)


class Results(unittest.TestCase):
    def setUp(self):
        self.folder = support.temporary_folder(type(self))

    def test_figures_and_page(self):
        page = self.folder / "page.md"
        result = PROGRAM.run("validate", "--only", "slope", "--out", self.folder / "out", "--page", page,
                             "--json", self.folder / "slope.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "out" / "slope.svg").exists())
        self.assertTrue((self.folder / "page" / "slope.png").exists())
        written_ns = {file.name: file.stat().st_mtime_ns for file in (self.folder / "out").iterdir()}
        self.assertEqual(written_ns["summary.json"], max(written_ns.values()))
        self.assertIn("](page/slope.png)", page.read_text())
        self.assertEqual((self.folder / "slope.json").read_bytes(), (self.folder / "out" / "summary.json").read_bytes())

    def test_another_stepper_is_named_and_judged(self):
        """Table, summary and exit status agree, whether the second engine passes or fails."""
        result = PROGRAM.run("validate", "--short", "--only", "slope", "--stepper", "mujoco", "--out", self.folder / "out")
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(summary["stepper"], "mujoco")
        self.assertEqual(result.returncode, 0 if summary["passed"] else 1)
        self.assertEqual("NO" in result.stdout, not summary["passed"])

    def test_bad_arguments(self):
        for bad in (["--stepper", "perfect"], ["--step-ms", "0.3"], ["--step-ms", "2"], ["--only", "magic"],
                    ["--short", "--page", str(self.folder / "page.md")], ["--json", str(self.folder / "no" / "a.json")],
                    ["--only", "zmp", "--scenario", "nothing.yaml"]):
            with self.subTest(bad):
                result = PROGRAM.run("validate", "--out", self.folder / "out", *bad)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
