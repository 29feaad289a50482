"""examples/read_library.py and read_library.m read what docs/format.md describes."""
import json
import re
import shutil

import h5py
import numpy as np
import pytest
from conftest import EXAMPLES, reseal, run, run_example

import point_pairs
from read_library import LibraryError, read_library


def test_reads_what_trivet_says(trivet, library):
    said = json.loads(trivet("library", "info", library, "--json", "-"))
    read = read_library(str(library))
    assert read.unit == "mm"
    assert [model["name"] for model in said["models"]] == list(read.models)
    for model in said["models"]:
        found = read.models[model["name"]]
        assert found.diameter == pytest.approx(model["diameter"])
        assert len(found.vertices) == model["vertices"]
        assert found.triangles.shape == (model["triangles"], 3)
        assert found.triangles.max() == len(found.vertices) - 1
        assert len(found.samples) == model["samples"]
        assert len(found.pairs.entries) == model["point_pairs"]["pairs"]
        assert len(found.pairs.points) == model["point_pairs"]["points"]
        assert found.num_features == model["features"] > 0
    assert len(read.models["brick"].symmetry_poses) == 3
    np.testing.assert_allclose(np.linalg.norm(read.models["bracket"].sample_normals, axis=1), 1,
                               atol=1e-6)


def test_prints_a_row_a_model_and_that_the_file_is_good(library):
    printed = run_example("read_library.py", library)
    assert printed.returncode == 0, printed.stderr
    rows = printed.stdout.splitlines()
    assert [row.split()[0] for row in rows] == ["model", "bracket", "brick", "2"]
    assert rows[2].split()[-1] == "3"
    assert rows[-1].endswith("all checksums are right")


@pytest.mark.parametrize("name", ["bracket", "brick"])
def test_the_table_is_that_of_its_points(library, name):
    """Each pair stands in the cell and at the turn that the page's formulas give."""
    pairs = read_library(str(library)).models[name].pairs
    cells = np.repeat(np.arange(pairs.quantization.num_cells),
                      np.diff(pairs.offsets.astype(np.int64)))
    num_exact = 0
    for r, frame in enumerate(point_pairs.frames(pairs.normals[:pairs.num_references])):
        d = pairs.points - pairs.points[r]
        cell = point_pairs.cells(pairs.quantization, pairs.normals[r], d, pairs.normals)
        own = set(zip(cell.tolist(), point_pairs.turns(frame, d).tolist()))
        of_r = pairs.entries[:, 0] == r
        for stored, turn in zip(cells[of_r].tolist(), pairs.entries[of_r, 1].tolist()):
            num_exact += any((stored, (turn + off) % 65536) in own for off in (0, -1, 1))
    assert len(cells) > 1000
    assert num_exact > 0.999 * len(cells)  # single precision decides at borders of bins


@pytest.mark.parametrize("place", [
    "models/bracket/vertices", "models/bracket/sample_views", "models/brick/ppf/offsets",
    "models/brick/ppf/entries", "models/brick/symmetry_poses", "models/bracket/trisi/features",
    "trisi/mean", "directory/names", "index/00/codes"])
def test_names_the_dataset_of_a_damaged_byte(library, tmp_path, place):
    damaged = tmp_path / "damaged.h5"
    shutil.copy(library, damaged)
    with h5py.File(damaged) as file:
        at = file[place].id.get_offset() + file[place].nbytes // 2
    with open(damaged, "r+b") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 1]))
    read = run_example("read_library.py", damaged)
    assert read.returncode == 65
    assert f"error: {damaged}: /{place}: expected checksum" in read.stderr
    assert read.stdout == ""


def test_finds_what_was_changed_beside_the_datasets(library, tmp_path):
    changed = tmp_path / "changed.h5"
    shutil.copy(library, changed)
    with h5py.File(changed, "r+") as file:
        file["models/brick"].attrs["diameter"] = np.float32(1)
    with pytest.raises(LibraryError, match="^/@checksum: expected"):
        read_library(str(changed))
    reseal(changed)  # then the directory speaks of other models than there are
    with pytest.raises(LibraryError, match="^/directory@models_digest: expected"):
        read_library(str(changed))


def test_refuses_what_is_no_library_of_version_1(library, tmp_path):
    other = tmp_path / "other.h5"
    other.write_text("no HDF5", encoding="utf-8")
    assert run_example("read_library.py", other).returncode == 65
    assert run_example("read_library.py", tmp_path / "none.h5").returncode == 66
    h5py.File(other, "w").close()
    with pytest.raises(LibraryError, match="/@format"):
        read_library(str(other))
    shutil.copy(library, other)
    with h5py.File(other, "r+") as file:
        file.attrs["format_version_major"] = np.uint32(2)
    with pytest.raises(LibraryError, match="^written by trivet .*: expected version 1"):
        read_library(str(other))


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="octave-cli is not installed")
@pytest.mark.parametrize("name", ["bracket", "brick"])
def test_octave_reads_the_same(library, name):
    outcome = run("octave-cli", "--no-init-file", EXAMPLES / "read_library.m", library, name)
    assert outcome.returncode == 0, outcome.stderr
    model = read_library(str(library)).models[name]
    pairs = model.pairs
    counts = np.diff(pairs.offsets.astype(np.int64))
    fullest = int(counts.argmax())
    first, last = pairs.offsets[fullest:fullest + 2].astype(np.int64) - [0, 1]
    assert "2 models: bracket, brick" in outcome.stdout
    numbers = re.findall(r"[ (](\d[\d.]*)", outcome.stdout.partition("model ")[2])
    assert [float(number) for number in numbers] == pytest.approx([
        model.diameter, *model.vertices.shape, *model.samples.shape, *pairs.entries.shape,
        pairs.quantization.num_cells, pairs.quantization.distance_step, fullest, counts[fullest],
        *pairs.entries[first], *pairs.entries[last]], rel=1e-5)
    refused = run("octave-cli", "--no-init-file", EXAMPLES / "read_library.m", library, "other")
    assert refused.returncode == 1 and "has no model other" in refused.stderr
