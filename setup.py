"""Builds the Python module `koboshi` by CMake, for the interpreter that runs this file (docs/guide/python.md).

The wheel has the module with its stubs, koboshi_env, and the robots and scenarios, which names such as "go" refer to. It
links with the libraries of this system (ODE, MuJoCo, ...), so it is for machines with the same release of Debian.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent
PYTHON_FOLDER = "simulation/python"


def version():
    text = (SOURCE / "CMakeLists.txt").read_text()
    return re.search(r"^project\(koboshi VERSION ([0-9.]+)", text, re.MULTILINE).group(1)


def data_files():
    """Robots and scenarios below share/koboshi, where the module looks for them."""
    folders = {}
    for root in ("robots", "scenarios"):
        for file in sorted((SOURCE / root).rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                relative = file.relative_to(SOURCE)
                folders.setdefault(f"share/koboshi/{relative.parent}", []).append(str(relative))
    return list(folders.items())


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        if shutil.which("cmake") is None or shutil.which("ninja") is None:
            raise SystemExit("koboshi needs cmake and ninja (Debian: the packages of tools/dev/packages-build.txt)")
        folder = SOURCE / "build/wheel"  # the libraries are the same for all interpreters
        configure = ["cmake", "-U*Python*", "-UPYTHON_*", "-G", "Ninja", "-S", SOURCE, "-B", folder,
                     "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF", "-DKOBOSHI_PACKAGE=ON",
                     "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=0",
                     f"-DKOBOSHI_PYTHON={sys.executable}"]
        if shutil.which("ccache"):
            configure.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        shutil.rmtree(folder / "python", ignore_errors=True)  # of another interpreter
        subprocess.run(configure, check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "koboshi_python", "--parallel", str(os.cpu_count())], check=True)
        module = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        module.parent.mkdir(parents=True, exist_ok=True)
        built, = (folder / "python").glob("koboshi*.so")
        shutil.copy2(built, module)
        shutil.copy2(SOURCE / PYTHON_FOLDER / "koboshi.pyi", module.parent)


setup(
    name="koboshi",
    version=version(),
    description="Firmware of a small humanoid robot, and the simulated board it runs on",
    python_requires=">=3.10",
    install_requires=["numpy"],
    packages=[],
    py_modules=["koboshi_env"],
    package_dir={"": PYTHON_FOLDER},
    ext_modules=[Extension("koboshi", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    data_files=data_files(),
    zip_safe=False,
)
