"""Runs the koboshi program for the tests in this folder."""

import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SQUAT = ROOT / "scenarios" / "squat.yaml"
WALK = ROOT / "scenarios" / "walk.yaml"


class Program:
    def __init__(self, path):
        self.path = path

    def run(self, *arguments, cwd=ROOT):
        command = [self.path, *map(str, arguments)]
        return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=600, check=False)

    def run_scenario(self, scenario, out, *arguments):
        """Runs a scenario that must succeed and returns its folder."""
        result = self.run("run", scenario, "--out", out, *arguments)
        if result.returncode != 0:
            raise AssertionError(f"koboshi run {scenario} ended with {result.returncode}: {result.stderr}")
        return out


def limited_statuswords(run_folder):
    """Counts the drives' statuswords (TPDO 1 of nodes 16 to 35) in a run's can.log that have bit 11, internal limit active."""
    count = 0
    with open(run_folder / "can.log", encoding="ascii") as log:
        for line in log:
            identifier, _, data = line.split()[2].partition("#")
            if 0x190 <= int(identifier, 16) <= 0x1A3 and int(data[2:4], 16) & 0x08:
                count += 1
    return count


def temporary_folder(test_class):
    """Returns a temporary folder that is removed after the class's tests."""
    folder = tempfile.TemporaryDirectory(prefix=f"koboshi_{test_class.__name__.lower()}_")
    test_class.addClassCleanup(folder.cleanup)
    return pathlib.Path(folder.name)


def take_program_argument():
    """Removes the first argument, the path of the program, from those that unittest parses, and returns it."""
    return Program(pathlib.Path(sys.argv.pop(1)).resolve())
