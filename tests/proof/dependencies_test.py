"""Checks the #include lines of the sources against the dependency rules of docs/design/architecture.md."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Each folder of the root may include those before it, within the rules below.
FOLDERS = ("base", "mechanics", "hal", "firmware", "sim_board", "simulation", "bus", "view", "tools", "lab", "studio", "cli", "tests")
MOST_SOURCES = 32  # in a folder
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)

# Standard headers that do not use heap, floating point, streams or exceptions.
FIRMWARE_STANDARD = set("""
    algorithm array bit cassert climits compare concepts cstddef cstdint cstring initializer_list iterator limits numeric
    optional ratio span string_view tuple type_traits utility version""".split())
STANDARD = FIRMWARE_STANDARD | set("""
    any atomic barrier bitset cctype cerrno cfenv cfloat charconv chrono cinttypes clocale cmath codecvt complex
    condition_variable coroutine csetjmp csignal cstdarg cstdio cstdlib ctime cuchar cwchar cwctype deque exception
    execution filesystem format forward_list fstream functional future iomanip ios iosfwd iostream istream latch list
    locale map memory memory_resource mutex new numbers ostream queue random ranges regex scoped_allocator semaphore set
    shared_mutex source_location sstream stack stdexcept stop_token streambuf string strstream syncstream system_error
    thread typeindex typeinfo unordered_map unordered_set valarray variant vector""".split())
ANY = None  # headers of any library

# Rules by path prefix: the first matching prefix selects the part of a file. Each rule lists the permitted prefixes of
# project headers and the permitted headers in angle brackets.
RULES = [
    (r"hal/port/", (r"hal/port/",), FIRMWARE_STANDARD),
    (r"hal/lockstep/", (r"hal/(port|lockstep)/",), FIRMWARE_STANDARD),
    (r"hal/stm32/", (r"hal/(port|stm32)/",), FIRMWARE_STANDARD | {"atomic"}),
    (r"hal/fake/", (r"hal/(port|stm32|fake)/",), STANDARD),
    (r"hal/", (r"hal/",), ANY),
    (r"firmware/programs/", (r"hal/", r"firmware/(?!\w+/host/)"), FIRMWARE_STANDARD),
    (r"firmware/\w+/host/", (r"hal/port/", r"firmware/"), STANDARD),
    (r"firmware/storage/", (r"hal/port/", r"firmware/(storage|fixed)/(?!host/)"), FIRMWARE_STANDARD),
    (r"firmware/canopen/", (r"hal/port/", r"firmware/(canopen|storage|fixed)/(?!host/)"), FIRMWARE_STANDARD),
    (r"firmware/", (r"hal/port/", r"firmware/(?!\w+/host/)"), FIRMWARE_STANDARD),
    (r"base/", (r"base/",), ANY),
    (r"mechanics/", (r"mechanics/",), ANY),
    (r"sim_board/can/transport/", (r"base/", r"hal/(port|linux)/", r"firmware/canopen/", r"sim_board/"), ANY),
    (r"sim_board/servo/", (r"sim_board/(random|description|servo|state|world)/",), ANY),
    (r"sim_board/", (r"(base|mechanics)/", r"hal/(port|lockstep)/", r"firmware/(canopen|storage)/", r"sim_board/"), ANY),
    (r"simulation/", (r"(base|mechanics)/", r"hal/", r"firmware/", r"sim_board/", r"simulation/"), ANY),
    (r"bus/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus)/",), ANY),
    (r"view/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus|view)/",), ANY),
    (r"tools/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus|view|tools)/",), ANY),
    (r"lab/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus|view|tools|lab)/",), ANY),
    (r"studio/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus|view|tools|studio)/",), ANY),
    (r"cli/", (r"(base|mechanics|hal|firmware|sim_board|simulation|bus|view|tools|lab|cli)/",), ANY),
    (r"tests/", (r"",), ANY),
]


def violations(path, text):
    """Returns a line `PATH: includes HEADER ...` for each include that the file at this path of the project may not have."""
    allowed, libraries = next((allowed, libraries) for prefix, allowed, libraries in RULES if re.match(prefix, path))
    found = []
    for bracket, header in INCLUDE.findall(text):
        if bracket == "<":
            if libraries is not ANY and header not in libraries:
                found.append(f"{path}: includes <{header}>, which is not among the headers allowed there")
        elif header == pathlib.PurePath(path).stem + ".moc":
            continue  # Qt generates it in the build folder
        elif not any(re.match(prefix, header) for prefix in allowed):
            found.append(f'{path}: includes "{header}", which it may not know')
        elif not (ROOT / header).is_file():
            found.append(f'{path}: includes "{header}", which is no file from the project\'s root')
    return found


def sources():
    return [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")) if path.suffix in {".h", ".cc"}]


def included_folders(files):
    """Maps each folder to the other folders that its files include. `files`: pairs of a path and its text."""
    folders = {}
    for path, text in files:
        folder = str(pathlib.PurePosixPath(path).parent)
        included = {str(pathlib.PurePosixPath(header).parent) for bracket, header in INCLUDE.findall(text) if bracket != "<"}
        folders.setdefault(folder, set()).update(included - {folder, "."})
    return folders


def circle(folders):
    """Returns folders of which each includes the next, and the last the first; empty if there are none."""
    left = dict(folders)
    while True:  # folders that include none of those left are in no circle
        ends = [folder for folder, included in left.items() if not any(other in left for other in included)]
        if not ends:
            break
        for folder in ends:
            del left[folder]
    path = []
    folder = min(left, default=None)
    while folder is not None and folder not in path:
        path.append(folder)
        folder = min(other for other in left[folder] if other in left)
    return path[path.index(folder):] if path else []


def listed_folders(text):
    """The folders below the root that the list of docs/design/architecture.md names."""
    block = re.search(r"^## Folders\n+```\n(.*?)^```", text, re.MULTILINE | re.DOTALL).group(1)
    found, root = set(), None
    for line in block.splitlines():
        if name := re.match(r"(\w+)/ ", line):
            root = name.group(1)
            line = line[name.end():]
        if name := re.match(r" *(\w+)/ ", line):
            found.add(f"{root}/{name.group(1)}")
    return found


class Sources(unittest.TestCase):
    maxDiff = None

    def test_have_no_circle_of_folders(self):
        files = [(path.relative_to(ROOT).as_posix(), path.read_text()) for path in sources()]
        self.assertEqual(circle(included_folders(file for file in files if not file[0].startswith("tests/"))), [])

    def test_are_few_in_every_folder(self):
        counts = {}
        for path in sources():
            counts[path.parent] = counts.get(path.parent, 0) + 1
        full = {folder.relative_to(ROOT).as_posix(): n for folder, n in counts.items() if n > MOST_SOURCES}
        self.assertEqual(full, {})

    def test_are_in_the_folders_of_the_architecture(self):
        listed = listed_folders((ROOT / "docs/design/architecture.md").read_text())
        second = {"/".join(path.relative_to(ROOT).parts[:2]) for path in sources() if len(path.relative_to(ROOT).parts) > 2}
        there = {folder for folder in second if not folder.startswith(("tests/", "cli/"))}
        self.assertEqual({folder for folder in listed if not folder.startswith(("tests/", "tools/dev"))}, there)

    def test_include_only_what_they_may_know(self):
        found = [line for path in sources() for line in violations(path.relative_to(ROOT).as_posix(), path.read_text())]
        self.assertEqual(found, [])

    def test_are_found_in_every_folder(self):
        seen = {path.relative_to(ROOT).parts[0] for path in sources()}
        self.assertEqual(seen, set(FOLDERS))


class Checker(unittest.TestCase):
    FORBIDDEN = [
        ("hal/port/x.h", '#include "firmware/fixed/quantity.h"'),
        ("hal/port/x.h", "#include <vector>"),
        ("hal/fake/x.h", '#include "firmware/fixed/quantity.h"'),
        ("hal/fake/x.h", "#include <ode/ode.h>"),
        ("hal/stm32/x.h", '#include "hal/fake/can_registers.h"'),
        ("hal/stm32/x.h", "#include <vector>"),
        ("hal/stm32/x.cc", '#include "firmware/app/controller.h"'),
        ("hal/linux/x.cc", '#include "sim_board/can/node.h"'),
        ("hal/cortex_m/x.cc", '#include "firmware/app/controller.h"'),
        ("hal/lockstep/x.h", '#include "hal/fake/board.h"'),
        ("firmware/app/x.cc", '#include "hal/fake/board.h"'),
        ("firmware/app/x.cc", '#include "hal/lockstep/batch.h"'),
        ("firmware/programs/mps2/x.cc", '#include "sim_board/can/node.h"'),
        ("firmware/app/x.cc", '#include "sim_board/can/node.h"'),
        ("firmware/app/x.cc", '#include "firmware/fixed/host/convert.h"'),
        ("firmware/storage/x.cc", '#include "firmware/canopen/node/node.h"'),
        ("firmware/storage/x.cc", '#include "firmware/robot/model.h"'),
        ("firmware/canopen/x.cc", '#include "firmware/robot/model.h"'),
        ("firmware/canopen/x.cc", '#include "firmware/fixed/host/convert.h"'),
        ("firmware/app/x.cc", "#include <Eigen/Dense>"),
        ("firmware/app/x.cc", "#include <iostream>"),
        ("firmware/app/x.cc", "#include <cmath>"),
        ("firmware/app/x.cc", "  #  include  <string>"),
        ("firmware/fixed/host/x.h", '#include "sim_board/can/node.h"'),
        ("firmware/fixed/host/x.h", "#include <Eigen/Dense>"),
        ("sim_board/board/x.cc", '#include "firmware/fixed/quantity.h"'),
        ("sim_board/board/x.cc", '#include "hal/fake/board.h"'),
        ("sim_board/board/x.cc", '#include "hal/linux/socketcan.h"'),
        ("sim_board/can/x.cc", '#include "hal/linux/timer.h"'),
        ("sim_board/servo/x.cc", '#include "sim_board/can/node.h"'),
        ("sim_board/servo/x.cc", '#include "sim_board/drive/drive.h"'),
        ("sim_board/servo/x.cc", '#include "firmware/canopen/cia402.h"'),
        ("sim_board/board/x.cc", '#include "cli/run.h"'),
        ("sim_board/board/x.cc", '#include "tests/support/model.h"'),
        ("sim_board/board/x.cc", '#include "board.h"'),
        ("sim_board/board/x.cc", '#include "sim_board/board/no_such_file.h"'),
        ("cli/x.cc", '#include "tests/support/model.h"'),
    ]
    ALLOWED = [
        ("hal/port/x.h", '#include "hal/port/can.h"\n#include <array>'),
        ("hal/fake/x.h", '#include "hal/port/can.h"\n#include <vector>'),
        ("firmware/app/x.cc", '#include "firmware/fixed/quantity.h"\n#include "hal/port/board.h"\n#include <span>'),
        ("firmware/app/x.cc", '// #include <vector>'),
        ("firmware/storage/x.cc", '#include "firmware/fixed/contract.h"\n#include "hal/port/storage.h"'),
        ("firmware/canopen/x.cc", '#include "firmware/storage/item_store.h"'),
        ("sim_board/storage/x.cc", '#include "firmware/storage/item_store.h"'),
        ("sim_board/world/x.cc", '#include "hal/port/can.h"\n#include <ode/ode.h>\n#include <vector>'),
        ("cli/x.cc", '#include "firmware/fixed/quantity.h"\n#include "sim_board/can/node.h"'),
        ("tests/unit/x.cc", '#include "sim_board/can/node.h"\n#include <gtest/gtest.h>'),
    ]

    def test_finds_a_circle(self):
        self.assertEqual(circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}), ["b", "c"])
        self.assertEqual(circle({"a": {"b", "c"}, "b": {"c"}, "c": set()}), [])

    def test_finds_every_violation(self):
        for path, text in self.FORBIDDEN:
            with self.subTest(path=path, text=text):
                self.assertEqual(len(violations(path, text)), 1)

    def test_accepts_what_is_allowed(self):
        for path, text in self.ALLOWED:
            with self.subTest(path=path, text=text):
                self.assertEqual(violations(path, text), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
