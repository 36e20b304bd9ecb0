"""Runs the numeric kernels on the Cortex-M4. Each must take fewer instructions in fixed point than in soft float.

Usage: kernels_test.py BUILD_FOLDER
"""

import pathlib
import subprocess
import sys
import unittest

IMAGE = pathlib.Path(sys.argv[1]) / "bin/target_kernels.elf"
QEMU = ("qemu-system-arm -M mps2-an386 -icount shift=6,sleep=off -display none -monitor none -nodefaults -nic none "
        "-semihosting-config enable=on,target=native -kernel").split()


def measure():
    return subprocess.run([*QEMU, IMAGE], stdin=subprocess.DEVNULL, check=True, capture_output=True, text=True, timeout=60).stdout


class Kernels(unittest.TestCase):
    def test_take_fewer_instructions_than_soft_float(self):
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in measure().splitlines()[2:]]
        self.assertEqual([row[0] for row in rows], ["sin", "cos", "atan2", "sqrt", "multiply", "divide", "biquad"])
        for name, fixed_mean, fixed_max, _, float_mean, float_max in rows:
            with self.subTest(kernel=name):
                self.assertLess(int(fixed_mean), int(float_mean))
                self.assertLess(int(fixed_max), int(float_max))
                self.assertGreater(int(fixed_mean), 2)  # fewer would mean that no kernel was called

    def test_take_the_same_in_each_run(self):
        self.assertEqual(measure(), measure())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
