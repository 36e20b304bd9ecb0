"""Checks docs/design/ways.md: each file that it names exists and has the function beside it, and its numbers of rooms are right."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/design/ways.md"

ROW = re.compile(r"^\| [BF] \| `([^`]+)` \| `([^`]+)` \| ", re.MULTILINE)
ROOMS = re.compile(r"^(\d+) rooms, (\d+) before\.", re.MULTILINE)
BEFORE = re.compile(r"^Before: ([^.]+)\.$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"`((?:base|mechanics|hal|firmware|sim_board|simulation|tests)/[\w./]+)`")


def has_function(text, name):
    """Whether a source defines this function, or this type: `Class::function` at the beginning of a line or within the class."""
    *scopes, own = name.split("::")
    qualified = re.escape(name)
    if re.search(rf"^[\w\[][^\n;={{(]*(?<![\w:]){qualified}\(", text, re.MULTILINE):
        return True
    if re.search(rf"^(?:class|struct) {re.escape(own)}\b[^;]*{{", text, re.MULTILINE):
        return True
    within = not scopes or re.search(rf"^(?:class|struct) {re.escape(scopes[-1])}\b[^;]*{{", text, re.MULTILINE)
    return bool(within and re.search(rf"^  (?!return\b)[\w\[][^\n;={{(]*(?<![\w:.>]){re.escape(own)}\(", text, re.MULTILINE))


def ways(page):
    """Yields title and text of each way of the page."""
    for section in re.split(r"^## ", page, flags=re.MULTILINE)[1:]:
        if ROW.search(section):
            yield section.split("\n", 1)[0], section


class Page(unittest.TestCase):
    text = PAGE.read_text()

    def test_names_functions_that_exist(self):
        wrong = []
        for path, function in ROW.findall(self.text):
            if not (ROOT / path).is_file():
                wrong.append(f"{path}: no such file")
            elif not has_function((ROOT / path).read_text(), function):
                wrong.append(f"{path}: does not define {function}")
        self.assertEqual(wrong, [])

    def test_names_files_and_folders_that_exist(self):
        self.assertEqual([path for path in NAMED.findall(self.text) if not (ROOT / path).exists()], [])

    def test_counts_the_rooms(self):
        titles = []
        for title, section in ways(self.text):
            titles.append(title)
            now, before = map(int, ROOMS.search(section).groups())
            self.assertEqual(now, len({path.rpartition(".")[0] for path, _ in ROW.findall(section)}), title)
            self.assertEqual(before, len(set(BEFORE.search(section).group(1).replace("\n", " ").split(", "))), title)
        self.assertEqual(len(titles), 3)


class Checker(unittest.TestCase):
    SOURCE = ("void Sample::take(int value) {\n  other(value);\n}\n\nclass Box {\n public:\n  void put(int value) { call(value); }\n};\n"
              "\nstruct Values {\n  int x;\n};\n")

    def test_finds_functions_and_types(self):
        for name in ("Sample::take", "Box::put", "put", "Values"):
            self.assertTrue(has_function(self.SOURCE, name), name)

    def test_does_not_take_a_call_for_a_function(self):
        for name in ("Sample::other", "other", "call", "Box::take", "Missing::put", "Value"):
            self.assertFalse(has_function(self.SOURCE, name), name)


if __name__ == "__main__":
    unittest.main()
