"""Runs policies on the Cortex-M4: the same bits as on the host, and no more instructions than the validator reckons.

Usage: policy_test.py BUILD_FOLDER SAMPLE_HEADER, the header with the digest of the host's outputs
"""

import pathlib
import re
import subprocess
import sys
import unittest

IMAGE = pathlib.Path(sys.argv[1]) / "bin/target_policy.elf"
HEADER = pathlib.Path(sys.argv[2])
QEMU = ("qemu-system-arm -M mps2-an386 -icount shift=6,sleep=off -display none -monitor none -nodefaults -nic none "
        "-semihosting-config enable=on,target=native -kernel").split()
MAX_WORK = 12_000


def measure():
    return subprocess.run([*QEMU, IMAGE], stdin=subprocess.DEVNULL, check=True, capture_output=True, text=True, timeout=60).stdout


class Policy(unittest.TestCase):
    def test_gives_the_bits_of_the_host(self):
        high, low = re.search(r"^digest (\w+) (\w+)$", measure(), re.MULTILINE).groups()
        (expected,) = re.findall(r"kSampleDigest = 0x([0-9A-F']+)u;", HEADER.read_text())
        self.assertEqual(int(high, 16) << 32 | int(low, 16), int(expected.replace("'", ""), 16))

    def test_takes_no_more_instructions_than_reckoned(self):
        rows = [[int(cell) for cell in line.strip("|").split("|")] for line in measure().splitlines()[2:-1]]
        self.assertEqual(len(rows), 8)
        for policy, reckoned, measured in rows:
            with self.subTest(policy=policy):
                self.assertLessEqual(measured, reckoned)
                self.assertLessEqual(reckoned, MAX_WORK)
                self.assertGreater(measured, 0.9 * reckoned)  # a bound that is too wide refuses policies that fit
        self.assertGreater(max(row[2] for row in rows), 11_000)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
