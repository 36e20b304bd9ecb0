"""`pip install .`: a wheel of the Python module in a virtual environment, away from the sources.

    wheel_test.py SOURCE_FOLDER
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv[1]).resolve()
EXAMPLE = SOURCE / "docs/guide/python/wave.py"


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="koboshi_wheel_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.root = pathlib.Path(cls.folder.name)
        # With the packages of the system: pip, setuptools, wheel and NumPy.
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", cls.root / "venv"], check=True)
        cls.python = cls.root / "venv/bin/python"
        subprocess.run([cls.python, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-index", SOURCE], check=True)

    def run_python(self, *arguments):
        return subprocess.run([self.python, "-I", *arguments], cwd=self.root, capture_output=True, text=True, timeout=120, check=False)

    def test_runs_an_example_elsewhere(self):
        done = self.run_python(EXAMPLE)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Follows a stream of joint targets.", done.stdout)
        self.assertIn("stands; did not fall; 0 faults", done.stdout)

    def test_has_its_own_data_and_stubs(self):
        code = ("import koboshi, koboshi_env, pathlib; print(koboshi.__file__); print(koboshi.__version__);"
                "print(pathlib.Path(koboshi.__file__).with_name('koboshi.pyi').exists())")
        module, version, stubs = self.run_python("-c", code).stdout.split()
        self.assertTrue(pathlib.Path(module).is_relative_to(self.root.resolve()), module)
        self.assertIn(f"project(koboshi VERSION {version} ", (SOURCE / "CMakeLists.txt").read_text())
        self.assertEqual(stubs, "True")
        self.assertTrue((self.root / "venv/share/koboshi/scenarios/go.yaml").exists())
        text = pathlib.Path(module).read_bytes()
        self.assertNotIn(str(SOURCE).encode(), text)

    def test_says_that_numpy_is_missing(self):
        done = self.run_python("-c", "import sys; sys.modules['numpy'] = None; import koboshi")
        self.assertEqual(done.returncode, 1)
        self.assertIn("koboshi needs NumPy, which this interpreter does not have", done.stderr)
        self.assertNotIn("Segmentation", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
