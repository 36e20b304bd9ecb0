"""Runs the commands of a documentation page, and compares its output, its numbers and its code with what they come from.

A block of ```console is run from the repository's root: each line that begins with "$ " is a command, a trailing backslash
continues it. The lines between a command and the next one are its output: they must occur in the command's output one after the
other, in which a line "..." stands for any lines, and "..." within a line for any text. ```console not-run is only parsed; the commands of ```console fails must end
with status 1. A block of ```cpp PATH, ```cmake PATH, ```ld PATH or ```python PATH must occur in that file word for word; a block
of ```python without a path is only parsed. A block of ```yaml runs/FILE is what the reader writes into that file at this point.
build/release is replaced by this test's build folder, and runs/ by a temporary folder.

A comment of the page, which the reader does not see, computes what its sentences quote, from the runs of the page's commands:

    <!-- quoted
    "at 6.84 s" = run("fell").time_of_largest("right_load_N", 6.7, 7)
    "fall predicted" in run("fell").verdict
    holds not run("fell").events("push")
    -->

The text in quotation marks must occur in the page. With =, its first number must be the value of the expression, rounded to the
digits of the page; with `in`, the expression's value must contain the text. run("fell") is recorded_run.Run of runs/fell, and
output("COMMAND") what a command prints, in which number_after(TEXT, output) is the first number after a text; degrees() converts rad.
"""

import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import recorded_run

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / sys.argv[1]
BUILD_FOLDER = sys.argv[2]

BLOCK = re.compile(r"^```(?P<language>\w+)(?: +(?P<info>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r"^<!-- quoted\n(.*?)^-->$", re.MULTILINE | re.DOTALL)
QUOTATION = re.compile(r'(?:"(?P<text>[^"]+)" (?P<relation>=|in)|holds) (?P<expression>.+)')
NUMBER = re.compile(r"-?\d[\d,]*(?:\.(?P<decimals>\d+))?")
LINK = re.compile(r"(?<!!)\[[^\]]*\]\((?!https?:)([^)#]+)[^)]*\)")


def blocks(text, language):
    return [(match["info"], match["text"]) for match in BLOCK.finditer(text) if match["language"] == language]


def steps(text):
    """Returns the steps of a page in order: a file that the reader writes and its content, or a command, its status and its lines."""
    for match in BLOCK.finditer(text):
        if match["language"] == "yaml" and (match["info"] or "").startswith("runs/"):
            yield match["info"], match["text"], None
        if match["language"] != "console" or match["info"] == "not-run":
            continue
        for part in re.split(r"^\$ ", re.sub(r"\\\n\s*", " ", match["text"]), flags=re.MULTILINE)[1:]:
            command, *lines = part.splitlines()
            yield command, 1 if match["info"] == "fails" else 0, lines


def differing_line(expected, output):
    """Returns the first of the expected lines that the output does not have in its place, or None."""
    place, anywhere = 0, True
    for line in expected:
        if line == "...":
            anywhere = True
            continue
        pattern = ".*".join(re.escape(part) for part in line.split("..."))
        candidates = range(place, len(output)) if anywhere else range(place, min(place + 1, len(output)))
        found = next((i for i in candidates if re.fullmatch(pattern, output[i])), None)
        if found is None:
            return line
        place, anywhere = found + 1, False
    return None


def quotations(text):
    """Returns the lines of a page's comments about its quotations."""
    return [line for comment in QUOTED.findall(text) for line in comment.splitlines() if line]


def number_after(phrase, text):
    """Returns the first number after the first occurrence of a phrase."""
    return float(NUMBER.search(text, text.index(phrase) + len(phrase))[0].replace(",", ""))


def disagreement(line, page, names):
    """Returns what is wrong with a quotation, or None. `page` is the page without its comments."""
    parts = QUOTATION.fullmatch(line)
    if not parts:
        return f"found {line!r}, expected '\"TEXT\" = EXPRESSION', '\"TEXT\" in EXPRESSION' or 'holds EXPRESSION'"
    value = eval(parts["expression"], {**names})  # the project's own pages
    if not parts["relation"]:
        return None if value else f"{parts['expression']} does not hold"
    quoted = " ".join(parts["text"].split())
    if quoted not in " ".join(page.split()):
        return f"the page does not contain {quoted!r}"
    if parts["relation"] == "in":
        return None if quoted in str(value) else f"the page quotes {quoted!r}, the program says {value!r}"
    number = NUMBER.search(quoted)
    shown = f"{value:.{len(number['decimals'] or '')}f}"
    return None if float(shown) == float(number[0].replace(",", "")) else f"the page quotes {quoted!r}, the program says {shown}"


class Page(unittest.TestCase):
    text = PAGE.read_text()

    def runs(self):
        return self.enterContext(tempfile.TemporaryDirectory())

    def run_command(self, command, runs):
        """Returns status and output of a command of the page, with the page's names of the folders."""
        script = "set -euo pipefail; " + command.replace("build/release", BUILD_FOLDER).replace("runs/", f"{runs}/")
        result = subprocess.run(["bash", "-c", script], cwd=ROOT, stdin=subprocess.DEVNULL, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return result.returncode, result.stdout.replace(f"{runs}/", "runs/").replace(BUILD_FOLDER, "build/release")

    def test_commands_and_quotations(self):
        runs = self.runs()
        for command, outcome, lines in steps(self.text):
            if isinstance(outcome, str):
                pathlib.Path(runs, command.removeprefix("runs/")).write_text(outcome)
                continue
            with self.subTest(command=command):
                status, output = self.run_command(command, runs)
                self.assertEqual(status, outcome, output)
                line = differing_line(lines, output.splitlines())
                self.assertIsNone(line, f"the page shows a line that the command does not print there; its output:\n{output}")
        names = {"run": lambda name: recorded_run.Run(pathlib.Path(runs, name)), "number_after": number_after, "degrees": math.degrees,
                 "output": lambda command: self.run_command(command, runs)[1]}
        page = re.sub(r"<!--.*?-->", "", self.text, flags=re.DOTALL)
        for line in quotations(self.text):
            with self.subTest(quotation=line):
                self.assertIsNone(disagreement(line, page, names))

    def test_code_stands_in_its_file(self):
        # Blocks of other languages without a file are the reader's own build or script.
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
        self.assertEqual(list(steps(text)), [("one  two", 0, ["output"]), ("three", 0, [])])

    def test_writes_the_files_of_the_reader(self):
        text = "```yaml runs/a.yaml\nx: 1\n```\n```console\n$ use runs/a.yaml\n```\n```yaml\ny: 2\n```\n"
        self.assertEqual(list(steps(text)), [("runs/a.yaml", "x: 1\n", None), ("use runs/a.yaml", 0, [])])

    def test_tells_commands_that_fail(self):
        self.assertEqual(list(steps("```console fails\n$ one\n```\n```console\n$ two\n```\n")), [("one", 1, []), ("two", 0, [])])

    def test_compares_output(self):
        output = ["a", "b", "c", "d"]
        for lines in ([], ["b"], ["a", "b"], ["a", "...", "d"], ["...", "d"], ["b", "..."], ["a...", "b"]):
            self.assertIsNone(differing_line(lines, output), lines)
        for lines, line in ((["e"], "e"), (["a", "c"], "c"), (["c", "...", "a"], "a"), (["d", "a"], "a")):
            self.assertEqual(differing_line(lines, output), line)

    def test_finds_numbers_in_messages(self):
        self.assertEqual(number_after("at most", "at most once, at 7: -1,200.5 m"), 7.0)

    def test_compares_quotations(self):
        page = "It slips by 1,234.50 mm and says: cut off\nat once."
        names = {"slip": 1234.503, "text": "cut off at once", "yes": True}
        for line in ('"1,234.50 mm" = slip', '"says: cut off at" in "says: " + text', "holds yes", '"1,234.50 mm" = -slip + 2 * slip'):
            self.assertIsNone(disagreement(line, page, names), line)
        for line, reason in (('"1,234.50 mm" = slip + 0.01', "the program says 1234.51"), ('"7 mm" = slip', "does not contain"),
                             ('"It slips" in text', "the program says 'cut off"), ("holds not yes", "does not hold"), ("what", "expected")):
            self.assertIn(reason, disagreement(line, page, names) or "nothing")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
