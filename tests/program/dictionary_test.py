"""`koboshi dictionary` prints the same text that it writes, and that the repository contains."""

import unittest

import program as support

PROGRAM = None
KEPT = support.ROOT / "docs" / "reference"
PRINTED = {
    "controller.eds": ("eds", "controller"),
    "drive.eds": ("eds", "drive"),
    "inertial.eds": ("eds", "inertial"),
    "ankle.eds": ("eds", "ankle"),
    "cells.eds": ("eds", "cells"),
    "switch.eds": ("eds", "switch"),
    "bus.yml": ("bus",),
    "koboshi.dbc": ("dbc",),
    "object-dictionary.md": ("page",),
    "parameters.md": ("parameters",),
}


class Dictionary(unittest.TestCase):
    def test_writes_what_the_repository_keeps(self):
        folder = support.temporary_folder(type(self))
        result = PROGRAM.run("dictionary", "write", "--folder", folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({file.name for file in folder.iterdir()}, set(PRINTED))
        for name in PRINTED:
            self.assertTrue((folder / name).read_bytes() == (KEPT / name).read_bytes(), name)

    def test_prints_each(self):
        for name, arguments in PRINTED.items():
            result = PROGRAM.run("dictionary", *arguments)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertTrue(result.stdout == (KEPT / name).read_text(), name)

    def test_knows_no_other_kind(self):
        result = PROGRAM.run("dictionary", "eds", "toaster")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stdout, "")


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
