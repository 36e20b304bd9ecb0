"""Runs the commands of a documentation page, compares its code with the files that it quotes, and checks its links.

A block of ```console is run from the repository's root: each line that begins with "$ " is a command, a trailing backslash
continues it, other lines are output and not compared. ```console not-run is only parsed. A block of ```cpp PATH, ```cmake PATH,
```ld PATH or ```python PATH must occur in that file word for word; a block of ```python without a path is only parsed.
build/release is replaced by this test's build folder, and runs/ by a temporary folder.
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / sys.argv[1]
BUILD_FOLDER = sys.argv[2]

BLOCK = re.compile(r"^```(?P<language>\w+)(?: +(?P<info>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?<!!)\[[^\]]*\]\((?!https?:)([^)#]+)[^)]*\)")


def blocks(text, language):
    return [(match["info"], match["text"]) for match in BLOCK.finditer(text) if match["language"] == language]


def commands(text):
    """Returns the commands of a page in order, each as one line."""
    runnable = "".join(block for info, block in blocks(text, "console") if info != "not-run")
    lines = re.sub(r"\\\n\s*", " ", runnable).splitlines()
    return [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]


class Page(unittest.TestCase):
    text = PAGE.read_text()

    def test_commands_succeed(self):
        runs = self.enterContext(tempfile.TemporaryDirectory())
        for command in commands(self.text):
            with self.subTest(command=command):
                script = "set -euo pipefail; " + command.replace("build/release", BUILD_FOLDER).replace("runs/", f"{runs}/")
                result = subprocess.run(["bash", "-c", script], cwd=ROOT, stdin=subprocess.DEVNULL, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                self.assertEqual(result.returncode, 0, result.stdout)

    def test_code_stands_in_its_file(self):
        # Of other languages, blocks without a file are the reader's own build or script.
        other = [block for language in ("cmake", "ld", "python") for block in blocks(self.text, language) if block[0]]
        for path, code in blocks(self.text, "cpp") + other:
            with self.subTest(path=path):
                self.assertIsNotNone(path, "a block of code names no file")
                self.assertIn(code, (ROOT / path).read_text())

    def test_links_lead_somewhere(self):
        for target in LINK.findall(self.text):
            with self.subTest(link=target):
                self.assertTrue((PAGE.parent / target).exists())


class Reader(unittest.TestCase):
    def test_takes_commands_apart(self):
        text = "```console\n$ one \\\n    two\noutput\n$ three\n```\n```console not-run\n$ four\n```\n```yaml\n$ five\n```\n"
        self.assertEqual(commands(text), ["one  two", "three"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
