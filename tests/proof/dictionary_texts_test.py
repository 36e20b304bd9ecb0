"""dictionary_texts_test.py ARCHIVE: the texts of the controller's table of objects cost no flash.

They stand beside the rows in the sources, and must be in no section of the compiled firmware."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLES = ("firmware/app/controller_objects.h", "firmware/app/object_texts.h", "firmware/canopen/described_object.h")
ARCHIVE = pathlib.Path(sys.argv.pop(1))


def texts():
    """Every literal that no symbol of the debug information can be."""
    sources = "\n".join(line for table in TABLES for line in (ROOT / table).read_text().splitlines()
                        if not line.lstrip().startswith(("//", "#")))
    return [text for text in re.findall(r'"([^"\n]+)"', sources) if " " in text]


class Texts(unittest.TestCase):
    def test_are_in_no_object(self):
        compiled = ARCHIVE.read_bytes()
        self.assertEqual([text for text in texts() if text.encode() in compiled], [])

    def test_are_found_where_they_are(self):
        self.assertGreater(len(texts()), 60)
        self.assertIn(b"Koboshi controller", ARCHIVE.read_bytes())  # a text of the node itself


if __name__ == "__main__":
    unittest.main()
