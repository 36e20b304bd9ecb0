"""run_test.py skips tests that cannot run but none that fail. report_gaps.py reports each skip and each file left behind."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest

HERE = pathlib.Path(__file__).parent
PASSING = "def test_passing(self): pass"
FAILING = "def test_failing(self): self.fail()"
SKIPPING = "def test_skipping(self): self.skipTest('no moon')"
SKIPPING_IN_PART = """
def test_in_part(self):
    with self.subTest(), self.assertRaises(ValueError): raise ValueError
    with self.subTest(): self.skipTest('no sun')
"""


def run(script, *arguments, **variables):
    result = subprocess.run([sys.executable, "-B", HERE / script, *map(str, arguments)], env=os.environ | {"KOBOSHI_SKIPS": "allowed"} | variables, text=True, check=False,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return result.returncode, result.stdout


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return self.folder / name


class RunTest(Folder):
    def run_unittest(self, *methods):
        script = self.write("some_test.py", "import sys, unittest\nimport neighbour\nclass Some(unittest.TestCase):\n"
                            + textwrap.indent("\n".join(methods), "    ") + "\nsys.argv.pop()\nunittest.main()\n")
        self.write("neighbour.py", "")
        return run("run_test.py", "--", script, "argument")

    def test_passes_and_fails_with_the_script(self):
        self.assertEqual(self.run_unittest(PASSING)[0], 0)
        self.assertEqual(self.run_unittest(PASSING, FAILING)[0], 1)

    def test_skips_with_the_script_and_gives_the_reason(self):
        for methods in ((SKIPPING,), (PASSING, SKIPPING)):
            status, output = self.run_unittest(*methods)
            self.assertEqual(status, 77)
            self.assertRegex(output, r"(?m)^skipped: .*test_skipping.*: no moon$")
        status, output = self.run_unittest(SKIPPING_IN_PART)
        self.assertEqual(status, 77)
        self.assertIn("no sun", output)

    def test_hides_no_failure_behind_a_skip(self):
        self.assertEqual(self.run_unittest(SKIPPING, FAILING)[0], 1)

    def test_skips_where_something_is_missing(self):
        there = ["--need=sh", "--need=module:unittest", f"--need={HERE}"]
        self.assertEqual(run("run_test.py", *there, "--", "sh", "-c", "exit 3")[0], 3)
        for missing in ("no_such_program", "module:no_such_module", "/no/such/path"):
            status, output = run("run_test.py", *there, f"--need={missing}", "--", "sh", "-c", "exit 3")
            self.assertEqual((status, output), (77, f"skipped: there is no {missing}\n"))


@unittest.skipUnless(shutil.which("ctest"), "no ctest")
class ReportGaps(Folder):
    PROJECT = """
        cmake_minimum_required(VERSION 3.25)
        project(some LANGUAGES NONE)
        enable_testing()
        add_test(NAME passing COMMAND true)
        add_test(NAME failing COMMAND false)
        add_test(NAME of_shell COMMAND sh -c "seq 2000; echo 'skipped: no <moon>'; exit 77")
        add_test(NAME "A.B/0  # GetParam() = 1" COMMAND printf "[ RUN      ] A.B\\na.cc:1: Skipped\\nno sun\\n\\n[  SKIPPED ] A.B (0 ms)\\n\
            [  SKIPPED ] 1 test, listed below:\\n[  SKIPPED ] A.B\\n")
        add_test(NAME of_program COMMAND printf "[  SKIPPED ] a.cc:1: Skipped\\nno earth\\n")
        add_test(NAME of_another COMMAND printf "[  SKIPPED ] a.cc:1: Skipped\\nno earth\\n")
        add_test(NAME silent COMMAND sh -c "exit 77")
        add_test(NAME disabled COMMAND true)
        add_test(NAME missing COMMAND no_such_program)
        set_tests_properties(of_shell silent PROPERTIES SKIP_RETURN_CODE 77)
        set_tests_properties("A.B/0  # GetParam() = 1" of_program of_another PROPERTIES SKIP_REGULAR_EXPRESSION "\\\\[  SKIPPED \\\\]")
        set_tests_properties(disabled PROPERTIES DISABLED ON)
        """

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.build = pathlib.Path(folder.name)
        (cls.build / "CMakeLists.txt").write_text(cls.PROJECT)
        subprocess.run(["cmake", "-G", "Ninja", "-S", cls.build, "-B", cls.build], check=True, capture_output=True)

    def setUp(self):
        super().setUp()
        (self.folder / "left").mkdir()

    def report(self, expression, **variables):
        report = self.folder / "report.xml"
        subprocess.run(["ctest", "--test-dir", self.build, "--output-junit", report, "-R", expression], check=False,
                       capture_output=True)
        return run("report_gaps.py", report, self.folder / "left", **variables)

    def test_tells_of_each_skip_and_its_reason(self):
        expected = ["Skipped: of_shell: no <moon>", "Skipped: A.B/0: no sun", "Skipped: of_program, of_another: no earth",
                    "Skipped: silent: no reason given", "Skipped: disabled: disabled"]
        status, output = self.report(".")
        self.assertEqual((status, output.splitlines()), (0, expected))
        status, output = self.report(".", KOBOSHI_SKIPS="forbidden")
        self.assertEqual((status, output.splitlines()), (1, [*expected, "Tests were skipped, and none may be"]))

    def test_is_silent_where_there_is_nothing_to_tell(self):
        self.assertEqual(self.report("^passing$", KOBOSHI_SKIPS="forbidden"), (0, ""))

    def test_fails_where_something_is_left(self):
        file = self.write("left/walk.yaml", "")
        status, output = self.report("^passing$")
        self.assertEqual((status, output.splitlines()), (1, [f"Left behind: {file}", "Tests remove what they write"]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
