"""Makes the wheel of the Python package `pliant` with CMake: `pip install .`.

PLIANT_BUILD=FOLDER takes what is built there already; otherwise everything is compiled, without ROS.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
WORK = ROOT / "build" / "wheel"  # nothing of it lies among the sources


class CMakeBuild(build_ext):
    """Builds and installs into the wheel: the package, and inside it the libraries, the program, its scenes."""

    def run(self):
        build = os.environ.get("PLIANT_BUILD")
        if not build:
            build = str(pathlib.Path(self.build_temp).resolve())
            self._cmake("-S", str(ROOT), "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DPLIANT_ROS=OFF",
                        "-DPLIANT_TESTS=OFF", "-DPLIANT_BENCH=OFF", "-DPLIANT_PYTHON=REQUIRED",
                        "-DPYTHON_EXECUTABLE=" + sys.executable)
            self._cmake("--build", build, "-j", str(os.cpu_count() or 1))
        package = pathlib.Path(self.build_lib).resolve() / "pliant"
        shutil.rmtree(package, ignore_errors=True)
        with tempfile.TemporaryDirectory() as prefix:
            self._cmake("--install", build, "--component", "python", "--prefix", prefix)
            shutil.copytree(pathlib.Path(prefix) / "lib/python3/dist-packages/pliant", package)
        self._cmake("--install", build, "--component", "runtime", "--prefix", str(package))

    def _cmake(self, *arguments):
        subprocess.run(["cmake", *arguments], check=True)

    def get_outputs(self):
        return []


def version():
    return re.search(r"project\(pliant VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


WORK.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    packages=[],
    py_modules=[],
    ext_modules=[Extension("pliant._pliant", sources=[])],  # so that the wheel is one of this platform
    cmdclass={"build_ext": CMakeBuild},
    options={"build": {"build_base": str(WORK)}, "egg_info": {"egg_base": str(WORK)}},
)
