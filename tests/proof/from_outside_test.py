"""Configures tests/proof/foreign, an external project that takes `koboshi::firmware_app` by add_subdirectory. The project
inherits the language standard and the include folder, not our warnings, and the configuration needs only a compiler."""

import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOREIGN = ROOT / "tests/proof/foreign"
COMPILER = sys.argv[1]
WITHOUT_GTEST = "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON"  # makes find_package(GTest REQUIRED) an error


def configure(source, build, *options):
    environment = {name: value for name, value in os.environ.items() if name not in ("CXXFLAGS", "CXX")}
    return subprocess.run(["cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={COMPILER}", WITHOUT_GTEST,
                           *options], env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


class ForeignProject(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        result = configure(FOREIGN, cls.folder.name, f"-DKOBOSHI={ROOT}", "-DBUILD_TESTING=ON")
        if result.returncode != 0:
            raise AssertionError(result.stdout)
        units = json.loads((pathlib.Path(cls.folder.name) / "compile_commands.json").read_text())
        cls.commands = {pathlib.Path(unit["file"]).resolve(): shlex.split(unit["command"]) for unit in units}

    def consumer(self):
        return self.commands[FOREIGN / "consumer.cc"]

    def compile_consumer(self, *flags):
        command = self.consumer()
        command = command[:command.index("-o")] + [*flags, "-fsyntax-only", str(FOREIGN / "consumer.cc")]
        return subprocess.run(command, cwd=self.folder.name, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def test_gets_no_warnings_of_ours(self):
        self.assertEqual([word for word in self.consumer() if word.startswith(("-W", "-f", "-m"))], [])

    def test_gets_the_language_standard(self):
        self.assertIn("-std=gnu++20", self.consumer())

    def test_compiles_and_may_warn(self):
        result = self.compile_consumer("-Wall")
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("unused variable", result.stdout)

    def test_may_be_strict_with_itself(self):
        # -Weffc++ warns about nearly every header, so no warning means that the compiler treats them as system headers.
        strict = ("-Werror", "-Wextra", "-Wpedantic", "-Wshadow", "-Wold-style-cast", "-Wuseless-cast", "-Weffc++")
        result = self.compile_consumer(*strict)
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_compiles_our_sources_as_we_do(self):
        ours = [command for path, command in self.commands.items() if (ROOT / "firmware") in path.parents]
        self.assertGreater(len(ours), 30)
        for command in ours:
            for flag in ("-Wconversion", "-fno-exceptions", "-ffp-contract=off"):
                self.assertIn(flag, command)
            self.assertNotIn("-Werror", command)  # GCC 12 has false alarms at -O3

    def test_gets_firmware_and_ports_alone(self):
        folders = {path.relative_to(ROOT).parts[0] for path in self.commands if ROOT in path.parents and FOREIGN not in path.parents}
        self.assertEqual(folders, {"firmware", "hal"})


class OwnProject(unittest.TestCase):
    def test_without_tests_needs_no_test_library(self):
        with tempfile.TemporaryDirectory() as folder:
            result = configure(ROOT, folder, "-DBUILD_TESTING=OFF", "-DKOBOSHI_SIMULATION=OFF")
            self.assertEqual(result.returncode, 0, result.stdout)

    def test_warnings_are_errors_in_our_presets_alone(self):
        for preset, error in (((), False), (("--preset", "firmware"), True)):
            with self.subTest(preset), tempfile.TemporaryDirectory() as folder:
                result = configure(ROOT, folder, "-DBUILD_TESTING=OFF", "-DKOBOSHI_SIMULATION=OFF", *preset)
                self.assertEqual(result.returncode, 0, result.stdout)
                units = json.loads((pathlib.Path(folder) / "compile_commands.json").read_text())
                self.assertEqual({"-Werror" in shlex.split(unit["command"]) for unit in units}, {error})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
