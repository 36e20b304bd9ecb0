"""dictionary_texts_test.py ARCHIVE: the texts of the controller's object dictionary take no flash.

The source holds them next to the rows, but no section of the compiled firmware may contain them."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLES = ("firmware/app/controller_objects.h", "firmware/app/object_texts.h", "firmware/canopen/described_object.h")
ARCHIVE = pathlib.Path(sys.argv.pop(1))


def texts():
    """Returns every literal with a space: no symbol of the debug information contains one."""
    sources = "\n".join(line for table in TABLES for line in (ROOT / table).read_text().splitlines()
                        if not line.lstrip().startswith(("//", "#")))
    return [text for text in re.findall(r'"([^"\n]+)"', sources) if " " in text]


class Texts(unittest.TestCase):
    def test_are_in_no_object(self):
        compiled = ARCHIVE.read_bytes()
        self.assertEqual([text for text in texts() if text.encode() in compiled], [])

    def test_are_found_where_they_are(self):
        self.assertGreater(len(texts()), 60)
        self.assertIn(b"Koboshi controller", ARCHIVE.read_bytes())  # a string that the node does use


if __name__ == "__main__":
    unittest.main()
