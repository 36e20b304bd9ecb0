"""Proves these properties of the linked Cortex-M4 image: no heap, float, exceptions, run-time types, dynamic initialisers or recursion;
calls through pointers only as in tools/target/indirect_calls.txt; a sufficient stack.

Each file in fixture/ is linked in place of the firmware's program. It breaks one rule and states how the test must detect this:
  // Expect: link TEXT      does not link, and the linker says TEXT
  // Expect: image TEXT     links, and the proof of the image says TEXT
  // Expect: nothing        breaks none
  // List: LINE             its replacement for indirect_calls.txt

Usage: image_test.py BUILD_FOLDER, which contains a built image and provides the compiler flags for the fixtures
"""

import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

import image_rules
from image_rules import call_graph, describe, target_image

BUILD = pathlib.Path(sys.argv[1]).resolve()
SOURCES = pathlib.Path(__file__).resolve().parents[2]
FIXTURES = sorted((pathlib.Path(__file__).parent / "fixture").glob("*.cc"))
EXPECTATION = re.compile(r"^// Expect: (link|image|nothing) ?(.*)$", re.MULTILINE)
PROGRAM = "firmware/programs/mps2/main.cc"
INTERRUPTS = pathlib.Path(__file__).parent / "interrupts.cc"
QEMU = ("qemu-system-arm -M mps2-an386 -icount shift=6,sleep=off -display none -monitor none -nodefaults -nic none "
        "-semihosting-config enable=on,target=native -kernel").split()


def run(command, **options):
    return subprocess.run(command, cwd=BUILD, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}, **options)


def compile_command(source, target):
    """Returns the compile command of the board's program for another source."""
    commands = json.loads((BUILD / "compile_commands.json").read_text())
    (command,) = [entry["command"] for entry in commands if entry["file"].endswith(PROGRAM)]
    words = shlex.split(command)
    words[words.index("-o") + 1], words[words.index("-c") + 1] = str(target), str(source)
    return [*words, "-w"]  # fixtures contain unusual code on purpose


def link_command(target, program=None):
    """Returns the link command of the image with another file in place of the program's object."""
    lines = run(["ninja", "-t", "commands", "bin/koboshi.elf"], check=True).stdout.splitlines()
    words = [word for word in shlex.split(lines[-1]) if word not in (":", "&&")]
    words[words.index("-o") + 1] = str(target)
    words = [f"-Wl,-Map={target}.map" if word.startswith("-Wl,-Map=") else word for word in words]
    return [str(program) if program and word.endswith("/main.cc.obj") else word for word in words]


def link(folder, program=None):
    """Links an image, and again with its relocations kept. Returns both files and the linker's error output."""
    elf, relocatable = pathlib.Path(folder) / "image.elf", pathlib.Path(folder) / "relocatable.elf"
    result = run(link_command(elf, program))
    if result.returncode == 0:
        run([*link_command(relocatable, program), "-Wl,--emit-relocs"], check=True)
    return elf, relocatable, result.stderr if result.returncode else None


def compile_program(source, folder):
    program = pathlib.Path(folder) / "program.o"
    compilation = run(compile_command(source, program))
    if compilation.returncode:
        raise ValueError(compilation.stderr)
    return program


def link_fixture(source, folder):
    return link(folder, compile_program(source, folder))


def load_fixture(elf, folder):
    board = [path for path in target_image.ci_files(BUILD) if path.name != "main.cc.ci"]
    return target_image.Image(elf, [*board, *pathlib.Path(folder).glob("*.ci")])


def own_list(source, folder):
    path = pathlib.Path(folder) / "list.txt"
    path.write_text("\n".join(re.findall(r"^// List: (.*)$", source.read_text(), re.MULTILINE)))
    return call_graph.read_list(path)


class Image(unittest.TestCase):
    maxDiff = None

    def test_breaks_no_rule(self):
        with tempfile.TemporaryDirectory() as folder:
            elf, relocatable, complaint = link(folder)
            self.assertIsNone(complaint)
            image = target_image.Image.of_build(BUILD)
            self.assertEqual(target_image.words(image.elf, ".text"), target_image.words(relocatable, ".text"))
            self.assertEqual(image_rules.violations(image, call_graph.read_list(describe.LIST), relocatable), [])

    def test_is_seen_at_all(self):
        image = target_image.Image.of_build(BUILD)
        self.assertGreater(len(image.functions), 100)
        self.assertGreater(sum(function.plain for function in image.functions.values()), 100)
        self.assertGreater(sum(len(function.indirect_calls) for function in image.functions.values()), 20)
        self.assertGreater(len(describe.handlers(image)), 1)

    def test_is_described_to_the_byte(self):
        image = target_image.Image.of_build(BUILD)
        folders = target_image.bytes_by_folder(f"{image.elf}.map").values()
        for key, names in (("flash_bytes", target_image.FLASH_SECTIONS), ("ram_bytes", target_image.RAM_SECTIONS)):
            self.assertEqual(sum(folder[key] for folder in folders), target_image.total_bytes(image.elf, names))

    def test_has_bytes_from_each_folder_of_the_firmware(self):
        found = target_image.bytes_by_folder(BUILD / "bin/koboshi.elf.map")
        # Code in a subfolder counts for the folder that defines the library: canopen/sdo counts for canopen.
        made = [file.parent for file in (SOURCES / "firmware").rglob("CMakeLists.txt") if any(file.parent.glob("*.cc"))]
        self.assertGreater(len(made), 10)
        for folder in {str(folder.relative_to(SOURCES)) for folder in made}:
            with self.subTest(folder=folder):
                self.assertGreater(found.get(folder, {"flash_bytes": 0})["flash_bytes"], 500)  # the smallest,
                                                                                               # recovery/, has 800

    def test_does_not_depend_on_where_it_is_built(self):
        self.assertNotIn(str(SOURCES).encode(), (BUILD / "bin/koboshi.elf").read_bytes())
        self.assertNotIn(str(BUILD).encode(), (BUILD / "bin/koboshi.elf").read_bytes())

    def test_keeps_its_budget(self):
        description = json.loads((BUILD / "bin/koboshi.elf.json").read_text())
        self.assertLessEqual(description["flash_bytes"], 256 * 1024)  # motions are in storage, not in the image
        self.assertLessEqual(description["ram_bytes"], 64 * 1024)
        self.assertLessEqual(description["stack_bytes"], 4 * 1024)
        self.assertGreater(description["flash_bytes"], 16 * 1024)  # less would mean that the image lacks the firmware
        self.assertGreater(description["stack_bytes"], 300)


class Board(unittest.TestCase):
    def link(self, program, folder):
        """Links a program that has vectors of its own, in place of the board's."""
        elf = pathlib.Path(folder) / "image.elf"
        words = [word for word in link_command(elf, program) if not word.endswith("/interrupts.cc.obj")]
        return elf, run(words)

    def test_installs_handlers_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            elf, result = self.link(compile_program(INTERRUPTS, folder), folder)
            self.assertEqual(result.returncode, 0, result.stderr)
            output = subprocess.run([*QEMU, elf], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60).stdout
            self.assertEqual(output, "both handlers ran\n")

    def test_does_not_link_without_vectors(self):
        with tempfile.TemporaryDirectory() as folder:
            _, result = self.link(None, folder)
            self.assertIn("no vectors in .vectors.interrupts", result.stderr)


class Violation(unittest.TestCase):
    def test_is_found(self):
        for source in FIXTURES:
            kind, text = EXPECTATION.search(source.read_text()).groups()
            with self.subTest(fixture=source.name), tempfile.TemporaryDirectory() as folder:
                elf, relocatable, complaint = link_fixture(source, folder)
                if kind == "link":
                    self.assertIn(text, complaint or "it links")
                    continue
                self.assertIsNone(complaint)
                found = image_rules.violations(load_fixture(elf, folder), own_list(source, folder), relocatable)
                if kind == "nothing":
                    self.assertEqual(found, [])
                else:
                    self.assertIn(text, "\n".join(found))

    def test_has_a_fixture_for_each_rule(self):
        expected = "\n".join(source.read_text() for source in FIXTURES)
        rules = [rule for rule, _ in image_rules.FORBIDDEN_SYMBOLS] + ["recursion", "indirect", "stack"]
        for rule in rules:
            with self.subTest(rule=rule):
                self.assertIn(f"// Expect: image {rule}", expected)


class Stack(unittest.TestCase):
    def test_is_as_deep_as_it_was_reckoned(self):
        """The program of clean.cc takes its deepest call path and reports how much of the painted stack it has used."""
        source = pathlib.Path(__file__).parent / "fixture/clean.cc"
        with tempfile.TemporaryDirectory() as folder:
            elf, _, complaint = link_fixture(source, folder)
            self.assertIsNone(complaint)
            image = load_fixture(elf, folder)
            graph = call_graph.CallGraph(image, own_list(source, folder))
            reckoned = describe.entry_points(image, graph)["reset_handler"]["stack_bytes"]
            qemu = ["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=6,sleep=off", "-display", "none", "-monitor", "none",
                    "-nodefaults", "-nic", "none", "-semihosting-config", "enable=on,target=native", "-kernel", str(elf)]
            painted = int(run(qemu, timeout=60, stdin=subprocess.DEVNULL).stdout)
        self.assertEqual(painted, reckoned)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
