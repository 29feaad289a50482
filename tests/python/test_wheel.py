"""The wheel: made from the sources, installed where nothing of the checkout is."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[2]

TEN_LINES = """
import numpy as np, trivet
scans = trivet.scan(parts=1, scenes=1, instances=1)
trivet.train(scans.models, "parts.h5", preset="fast", methods=["ppf"])
scene = scans[0]
found = trivet.Library("parts.h5").recognize(scene.depth, camera=scene.camera,
                                             depth_scale=scene.depth_scale, method="ppf")
print(trivet.__file__, len(found), np.linalg.norm(found[0].pose[:3, 3] - scene.truth[0].pose[:3, 3]))
"""


@pytest.fixture(scope="module")
def wheels(tmp_path_factory):
    """Two, made one after the other from a copy: building leaves files beside the sources."""
    if "TRIVET_PYTHON_MODULE" not in os.environ:
        pytest.skip("TRIVET_PYTHON_MODULE: expected the module that was built")
    folder = tmp_path_factory.mktemp("wheel")
    made = []
    for number in range(2):
        copy = folder / f"sources_{number}"
        (copy / "python").mkdir(parents=True)
        for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "CMakeLists.txt"):
            shutil.copy(SOURCES / name, copy)
        shutil.copytree(SOURCES / "python" / "trivet", copy / "python" / "trivet")
        subprocess.run([sys.executable, "-m", "pip", "wheel", "--no-index", "--no-build-isolation",
                        "--no-deps", "-w", folder / f"wheel_{number}", copy], check=True,
                       capture_output=True, env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"})
        made += (folder / f"wheel_{number}").glob("*.whl")
    assert len(made) == 2
    return made


def test_is_the_same_twice(wheels):
    assert wheels[0].read_bytes() == wheels[1].read_bytes()


def test_holds_the_package_alone(wheels):
    names = zipfile.ZipFile(wheels[0]).namelist()
    assert {"trivet/__init__.py", "trivet/_trivet.pyi", "trivet/py.typed"} <= set(names)
    assert sum(name.endswith(".so") for name in names) == 1
    assert all(name.startswith("trivet") for name in names)


def test_recognizes_where_it_is_installed(wheels, tmp_path):
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", venv], check=True)
    subprocess.run([venv / "bin" / "pip", "install", "--no-index", "--no-deps", wheels[0]],
                   check=True, capture_output=True)
    clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    run = subprocess.run([venv / "bin" / "python", "-c", TEN_LINES], cwd=tmp_path, env=clean,
                         check=True, capture_output=True, text=True)
    where, found, error = run.stdout.split()
    assert str(venv) in where and int(found) == 1 and float(error) < 0.005
