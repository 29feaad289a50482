"""Every snippet of the documents runs, in their order, as a reader would run it."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

trivet = pytest.importorskip("trivet")

SOURCES = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["TRIVET_PROGRAM"]


def snippets(document):
    return re.findall(r"^```python\n(.*?)^```$", (SOURCES / document).read_text(), re.M | re.S)


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """A folder with what the snippets speak of."""
    monkeypatch.chdir(tmp_path)
    subprocess.run([PROGRAM, "scan", "--parts", "2", "--families", "bracket,lever", "--scenes", "1",
                    "--instances", "2", "-o", "scans"], check=True, capture_output=True)
    scans = trivet.scan(parts=2, families=["bracket", "lever"], scenes=1, instances=2)
    for name, mesh in scans.models.items():
        trivet.write_ply(name.split("_")[0] + ".ply", mesh)
    scene = scans[0]
    made = trivet.Scene.from_depth(scene.depth, scene.camera, depth_scale=scene.depth_scale)
    np.save("scan.npy", made.points)
    np.save("depth.npy", np.round(scene.depth * scene.depth_scale * 1000).astype(np.uint16))
    return tmp_path


@pytest.mark.parametrize("document", ["docs/python.md", "README.md"])
def test_snippets_run(document, reader, capsys):
    found = snippets(document)
    assert found
    names = {}
    for number, snippet in enumerate(found):
        exec(compile(snippet, f"{document}, snippet {number}", "exec"), names)
    assert "bracket" in capsys.readouterr().out
