"""Builds the extension module by CMake, so that `pip install .`, wheels and sdists work; all else is
in pyproject.toml."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCES = Path(__file__).resolve().parent


def version() -> str:
    found = re.search(r"project\(trivet VERSION ([0-9.]+)", (SOURCES / "CMakeLists.txt").read_text())
    assert found, "CMakeLists.txt: expected project(trivet VERSION ...)"
    return found[1]


class BuildByCMake(build_ext):
    """TRIVET_PYTHON_MODULE names a module that is built already."""

    def build_extension(self, ext: Extension) -> None:
        module = os.environ.get("TRIVET_PYTHON_MODULE") or self._build()
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(module, target)

    def _build(self) -> Path:
        build = Path(self.build_temp).resolve()
        subprocess.run(
            ["cmake", "-S", SOURCES, "-B", build, "-DCMAKE_BUILD_TYPE=Release",
             "-DTRIVET_BUILD_PYTHON=ON", "-DTRIVET_BUILD_TESTS=OFF", "-DTRIVET_BUILD_C=OFF",
             f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "trivet_python", "--parallel",
                        str(os.cpu_count() or 1)], check=True)
        return next((build / "python" / "trivet").glob("_trivet*.so"))


setup(version=version(), ext_modules=[Extension("trivet._trivet", [])],
      cmdclass={"build_ext": BuildByCMake})
