"""Runs the commands of a documentation page, compares its code with the files that it quotes, and checks its links.

A block of ```console is run from the repository's root: each line that begins with "$ " is a command, a trailing backslash
continues it, other lines are output and not compared. ```console not-run is only parsed. A block of ```cpp PATH, ```cmake PATH,
```ld PATH or ```python PATH must occur in that file word for word; a block of ```python without a path is only parsed.
The commands of ```console fails must end with status 1. A block of ```yaml runs/FILE is what the reader writes into that file at this point. build/release is replaced by this test's
build folder, and runs/ by a temporary folder.
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
    """Returns the commands of a block or a page in order, each as one line."""
    runnable = "".join(block for info, block in blocks(text, "console") if info != "not-run")
    lines = re.sub(r"\\\n\s*", " ", runnable).splitlines()
    return [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]


def steps(text):
    """Returns the steps of a page in order: a file that the reader writes and its content, or a command and its status."""
    for match in BLOCK.finditer(text):
        if match["language"] == "yaml" and (match["info"] or "").startswith("runs/"):
            yield match["info"], match["text"]
        for command in commands(match[0]):
            yield command, 1 if match["info"] == "fails" else 0


class Page(unittest.TestCase):
    text = PAGE.read_text()

    def test_commands_succeed(self):
        runs = self.enterContext(tempfile.TemporaryDirectory())
        for command, outcome in steps(self.text):
            if isinstance(outcome, str):
                pathlib.Path(runs, command.removeprefix("runs/")).write_text(outcome)
                continue
            with self.subTest(command=command):
                script = "set -euo pipefail; " + command.replace("build/release", BUILD_FOLDER).replace("runs/", f"{runs}/")
                result = subprocess.run(["bash", "-c", script], cwd=ROOT, stdin=subprocess.DEVNULL, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                self.assertEqual(result.returncode, outcome, result.stdout)

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

    def test_writes_the_files_of_the_reader(self):
        text = "```yaml runs/a.yaml\nx: 1\n```\n```console\n$ use runs/a.yaml\n```\n```yaml\ny: 2\n```\n"
        self.assertEqual(list(steps(text)), [("runs/a.yaml", "x: 1\n"), ("use runs/a.yaml", 0)])

    def test_tells_commands_that_fail(self):
        self.assertEqual(list(steps("```console fails\n$ one\n```\n```console\n$ two\n```\n")), [("one", 1), ("two", 0)])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
