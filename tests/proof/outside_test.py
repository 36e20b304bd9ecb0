"""Builds and runs tests/proof/outside, an external project with its own board and behaviour. It uses find_package with an
installed and then moved prefix or, with the argument `Folder`, add_subdirectory, which compiles the libraries again: without
optimisation, which must give the bytes of the optimised program.

Usage: outside_test.py BUILD_FOLDER COMPILER Installed | Folder
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUTSIDE = ROOT / "tests/proof/outside"
BUILD_FOLDER, COMPILER, WAY = sys.argv[1:4]


def call(*command):
    environment = {name: value for name, value in os.environ.items() if name not in ("CXXFLAGS", "CXX")}
    result = subprocess.run(command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: status {result.returncode}\n{result.stdout}")
    return result.stdout


class Project:
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))

    def build(self, *options):
        build = self.folder / self.id()
        call("cmake", "-S", OUTSIDE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_CXX_COMPILER={COMPILER}",
             *options)
        call("cmake", "--build", build)
        return build

    def run_programs(self, build, scenarios):
        self.assertIn("state", call(build / "own_board"))
        self.assertIn("stands", call(build / "own_behaviour", scenarios / "go.yaml"))


class Installed(Project, unittest.TestCase):
    def test_by_find_package(self):
        first, prefix = self.folder / "first", self.folder / "moved"
        call("cmake", "--install", BUILD_FOLDER, "--prefix", first)
        shutil.move(first, prefix)
        for path in prefix.rglob("*.cmake"):
            self.assertNotIn(str(ROOT), path.read_text(), path)
            self.assertNotIn("-Werror", path.read_text(), path)
        build = self.build(f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
        self.run_programs(build, prefix / "share/koboshi/scenarios")

    def test_a_component_that_is_missing_is_named(self):
        prefix = self.folder / "firmware_only"
        call("cmake", "--install", BUILD_FOLDER, "--prefix", prefix, "--component", "firmware")
        with self.assertRaisesRegex(AssertionError, "no component simulation of koboshi is installed here, only: firmware"):
            self.build(f"-DCMAKE_PREFIX_PATH={prefix}")


class Folder(Project, unittest.TestCase):
    def test_by_add_subdirectory(self):
        # Without debug information, which would take a third of the time.
        build = self.build(f"-DKOBOSHI_FOLDER={ROOT}", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_BUILD_TYPE=Debug",
                           "-DCMAKE_CXX_FLAGS_DEBUG=-D_GLIBCXX_ASSERTIONS")
        self.run_programs(build, ROOT / "scenarios")
        self.assert_bytes_of_the_program(build / "own_recorder")

    def assert_bytes_of_the_program(self, recorder):
        scenario, seconds = ROOT / "scenarios/squat.yaml", "7"  # boot, standing and the first half of a squat
        optimised, unoptimised = self.folder / "optimised", self.folder / "unoptimised"
        call(pathlib.Path(BUILD_FOLDER) / "bin/koboshi", "run", scenario, "--duration", seconds, "--out", optimised)
        unoptimised.mkdir()
        call(recorder, scenario, seconds, unoptimised)
        for name in ("summary.json", "can.log", "trace.csv"):
            self.assertEqual((optimised / name).read_bytes(), (unoptimised / name).read_bytes(), name)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], WAY], verbosity=2)
