"""The manual pages and the completion for bash contain every command and option of `--help`."""

import os
import re
import subprocess
import unittest

import program as support
from help_test import helps

PROGRAM = None
OPTION = re.compile(r"^  (-\S+?)(?:,(-\S+))?(?: |$)", re.MULTILINE)


def plain(page):
    """Returns the text of a manual page without its requests and escapes."""
    text = re.sub(r"\\f[BIR]|\\&|\\:", "", page)
    return text.replace("\\-", "-").replace("\\e", "\\")


class Manual(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        import help_test
        help_test.PROGRAM = PROGRAM
        cls.folder = support.temporary_folder(cls)
        cls.helps = dict(helps())
        result = cls.write("manual")
        assert result.returncode == 0, result.stderr
        cls.pages = {page.stem: page.read_text() for page in (cls.folder / "manual" / "man" / "man1").iterdir()}
        cls.completion = cls.folder / "manual" / "bash-completion" / "completions" / "koboshi"

    @classmethod
    def write(cls, folder, epoch="1700000000"):
        environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
        return subprocess.run([PROGRAM.path, "manual", "write", "--folder", folder], cwd=cls.folder, env=environment,
                              capture_output=True, text=True, check=False)

    def test_has_a_page_for_each_command(self):
        wanted = {"-".join(("koboshi", *path)) for path in self.helps} - {"koboshi-studio"}
        self.assertEqual(wanted, set(self.pages) - {"koboshi-studio"})
        self.assertIn("koboshi-studio", self.pages)

    def test_has_all_options_and_texts(self):
        for path, text in self.helps.items():
            if path == ("studio",):
                continue
            page = plain(self.pages["-".join(("koboshi", *path))])
            with self.subTest(path):
                for names in OPTION.findall(text):
                    for name in filter(None, names):
                        self.assertRegex(page, rf"(?m)^(\S+, )?{re.escape(name)}(,| |$)")
                for line in re.findall(r"^  koboshi .*", text, re.MULTILINE):
                    self.assertIn(line.strip(), page)

    def test_is_valid(self):
        for name, page in self.pages.items():
            result = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", "-"], input=page, text=True,
                                    capture_output=True, check=False, env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80"})
            with self.subTest(name):
                self.assertEqual("", result.stderr)
                self.assertRegex(page, r'^\.TH "KOBOSHI\S*" 1 "2023\\-11\\-14" "koboshi ')

    def test_is_the_same_each_time(self):
        self.assertEqual(0, self.write("again").returncode)
        again = {page.stem: page.read_text() for page in (self.folder / "again" / "man" / "man1").iterdir()}
        self.assertEqual(self.pages, again)

    def test_refuses_a_date_that_is_none(self):
        result = self.write("bad", "yesterday")
        self.assertEqual((2, "SOURCE_DATE_EPOCH: found yesterday, expected seconds since 1970\n"), (result.returncode, result.stderr))

    def complete(self, *words):
        """Returns what bash offers for the last word."""
        script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }; _koboshi\n'
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        result = subprocess.run(["bash", "-c", script, self.completion, PROGRAM.path, *words], cwd=self.folder, capture_output=True,
                                text=True, check=False)
        self.assertEqual("", result.stderr)
        return result.stdout.split()

    def test_completes_commands_options_values_and_names(self):
        self.assertEqual(["run"], self.complete("ru"))
        self.assertEqual(["dump"], self.complete("can", "du"))
        self.assertEqual(["--stepper"], self.complete("run", "walk", "--step"))
        self.assertEqual(["lumped"], self.complete("run", "--stepper", "l"))
        self.assertEqual(["walk"], self.complete("run", "wal"))
        self.assertEqual(["squat", "squat_deep"], self.complete("motion", "check", "squ"))
        self.assertEqual(["koboshi"], self.complete("motion", "check", "--robot", "kob"))
        self.assertEqual(["controller", "cells"], self.complete("dictionary", "eds", "c"))
        self.assertEqual([], self.complete("run", "--seed", ""))

    def test_completion_has_all_commands_and_options(self):
        text = self.completion.read_text()
        for path, help_text in self.helps.items():
            case = re.search(rf'^        "{re.escape("".join(" " + word for word in path))}"\) (.*\n.*)', text, re.MULTILINE)
            with self.subTest(path):
                self.assertIsNotNone(case)
                for names in OPTION.findall(help_text) if path != ("studio",) else ():
                    for name in filter(None, names):
                        self.assertIn(name, case[1].replace("'", " ").split())

    def test_names_an_unknown_command(self):
        result = PROGRAM.run("manual", "page", "rnu")
        self.assertEqual((2, "COMMAND: found rnu, expected a command of koboshi, such as run or can dump\n"),
                         (result.returncode, result.stderr))


if __name__ == "__main__":
    PROGRAM = support.take_program_argument()
    unittest.main()
