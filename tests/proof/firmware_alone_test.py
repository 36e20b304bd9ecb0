"""The preset `firmware` needs neither headers nor libraries of the simulation."""

import re
import subprocess
import sys
import unittest

FOREIGN = re.compile(r"\b(ode|eigen3|Eigen|(lib)?fyaml|tinyxml2|fmt|spdlog|nlohmann|CLI11?|xxhash)\b|sim_board/")

build_folder = sys.argv[1]


def ninja(*arguments):
    return subprocess.run(["ninja", "-C", build_folder, *arguments], check=True, capture_output=True, text=True).stdout


class FirmwarePreset(unittest.TestCase):
    def test_reads_no_header_of_the_simulation(self):
        headers = {line.strip() for line in ninja("-t", "deps").splitlines() if line.startswith("    ")}
        self.assertTrue(any(header.endswith("hal/port/board.h") for header in headers), "no dependencies recorded")
        self.assertEqual(sorted(filter(FOREIGN.search, headers)), [])

    def test_links_no_library_of_the_simulation(self):
        links = [line for line in ninja("-t", "commands").splitlines() if " -o bin/" in line]
        self.assertTrue(any("libhal_fake" in line for line in links), "no program is linked")
        words = {word for line in links for word in line.split() if word.startswith("-l") or word.endswith((".a", ".so"))}
        self.assertEqual(sorted(word for word in words if FOREIGN.search(word.removeprefix("-l").replace("lib", " "))), [])

    def test_would_see_them(self):
        for name in ("/usr/include/ode/ode.h", "/usr/include/eigen3/Eigen/Dense", "sim_board/world/world.h", "/usr/include/libfyaml.h"):
            self.assertRegex(name, FOREIGN)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
