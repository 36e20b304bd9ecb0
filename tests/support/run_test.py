"""run_test.py [--need=THING]... -- COMMAND [ARGUMENT...]: runs a test. Skips it where it cannot run, with a line "skipped: REASON" and
status 77, which CTest counts as skipped.

THING is a path if it has a slash, a module of Python if it is module:NAME, and otherwise a program. A COMMAND that ends in .py runs in
this process. If its unittest skips tests and none fails, the whole test counts as skipped.
"""

import importlib.util
import os
import pathlib
import runpy
import shutil
import sys
import unittest

SKIPPED = 77


def is_there(thing):
    if thing.startswith("module:"):
        return importlib.util.find_spec(thing.removeprefix("module:")) is not None
    return os.path.exists(thing) if "/" in thing else shutil.which(thing) is not None


class SkippingProgram(unittest.TestProgram):
    """Replaces unittest.main for the script and reports skipped tests by the exit status."""

    def runTests(self):
        self.exit = False
        super().runTests()
        for test, reason in self.result.skipped:
            print(f"skipped: {test}: {reason}", flush=True)
        sys.exit(SKIPPED if self.result.skipped and self.result.wasSuccessful() else not self.result.wasSuccessful())


def main():
    split = sys.argv.index("--")
    needs = [argument.removeprefix("--need=") for argument in sys.argv[1:split]]
    command = sys.argv[split + 1:]
    missing = [need for need in needs if not is_there(need)]
    if missing:
        print("skipped: there is no " + ", no ".join(missing))
        sys.exit(SKIPPED)
    if not command[0].endswith(".py"):
        os.execvp(command[0], command)
    sys.argv = command
    sys.path[0] = str(pathlib.Path(command[0]).resolve().parent)
    unittest.main = SkippingProgram
    runpy.run_path(command[0], run_name="__main__")


main()
