"""Proves on the compiled firmware: no heap, no float, no exceptions, no RTTI, no mutable globals.

Each file in fixture/ breaks one of these rules and says how it must be found:
  // Expect: compiler TEXT   does not compile with the firmware's flags, and the compiler says TEXT
  // Expect: object TEXT     compiles, and the proof of its object says TEXT
  // Expect: nothing         breaks none
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import object_file

FIXTURES = sorted((pathlib.Path(__file__).parent / "fixture").glob("*.cc"))
EXPECTATION = re.compile(r"^// Expect: (compiler|object|nothing) ?(.*)$", re.MULTILINE)

options = argparse.Namespace()


def compile_fixture(source, folder):
    target = pathlib.Path(folder) / "fixture.o"
    command = [options.compiler, *options.flags, "-c", source, "-o", target]
    return target, subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})


def violations(paths):
    return object_file.symbol_violations(paths) + [line for path in paths for line in object_file.float_violations(path)]


class Firmware(unittest.TestCase):
    maxDiff = None

    def test_breaks_no_rule(self):
        self.assertEqual(violations(options.archives), [])

    def test_is_seen_at_all(self):
        self.assertGreater(len(options.archives), 0)
        for archive in options.archives:
            entries = [entry for unit in object_file.debug_entries(archive) for entry in unit.values()]
            self.assertTrue(any(entry.tag in object_file.HOLDERS for entry in entries), f"{archive}: no debug information")
            self.assertGreater(len(object_file.symbols(archive)), 0)


class Violation(unittest.TestCase):
    def test_is_found(self):
        for source in FIXTURES:
            kind, text = EXPECTATION.search(source.read_text()).groups()
            with self.subTest(fixture=source.name), tempfile.TemporaryDirectory() as folder:
                target, compilation = compile_fixture(source, folder)
                if kind == "compiler":
                    self.assertNotEqual(compilation.returncode, 0)
                    self.assertIn(text, compilation.stderr)
                    continue
                self.assertEqual(compilation.returncode, 0, compilation.stderr)
                found = violations([target])
                if kind == "nothing":
                    self.assertEqual(found, [])
                else:
                    self.assertIn(text, "\n".join(found))

    def test_has_a_fixture_for_each_rule(self):
        self.assertGreaterEqual(len(FIXTURES), 10)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--archives", nargs="+", required=True)
    parser.add_argument("--flags", nargs=argparse.REMAINDER, required=True)
    parser.parse_args(namespace=options)
    unittest.main(argv=sys.argv[:1], verbosity=2)
