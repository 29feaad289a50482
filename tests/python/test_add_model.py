"""Trivet imports what examples/add_model.py writes, or reports why it cannot."""
import shutil

import h5py
import numpy as np
import pytest
from conftest import detections, reseal

import add_model
import vote
from read_library import read_library

NAME = add_model.NAME


@pytest.fixture(scope="module")
def pose(tmp_path_factory) -> np.ndarray:
    """Pose of the model in the scan."""
    scan = tmp_path_factory.mktemp("pose") / "scan.ply"
    return add_model.write_scan(str(scan), add_model.bracket())


def test_trivet_imports_and_finds_it(trivet, outside, pose, tmp_path):
    imported = tmp_path / "imported.h5"
    trivet("library", "import", outside, "-o", imported)
    trivet("library", "verify", imported)
    model = read_library(str(imported)).models[NAME]
    assert model.diameter == pytest.approx(20 * np.sqrt(5**2 + 3**2 + 4**2))
    found = detections(trivet, tmp_path / "found.json", imported, outside.parent / "scan.ply")
    moved, turned, _ = vote.differences(model, pose, found[NAME], np.eye(4)[None])
    assert len(moved) == 1 and moved[0] < 0.01 and turned[0] < 1


def test_its_own_table_votes_for_the_pose(outside, pose):
    model = read_library(str(outside)).models[NAME]
    points = vote.read_scene(str(outside.parent / "scan.ply"))
    found = vote.recognize(model, points, np.zeros(3))
    moved, turned, _ = vote.differences(model, pose, found.T_scene_model[None], np.eye(4)[None])
    assert moved[0] < 0.01 and turned[0] < 1


def test_it_joins_a_library_that_has_features(trivet, library, outside, tmp_path):
    grown, imported = tmp_path / "grown.h5", tmp_path / "imported.h5"
    add_model.write_library(str(grown), add_model.bracket(), str(library))
    trivet("library", "import", grown, "-o", imported)
    trivet("library", "verify", imported)
    assert trivet("library", "list", imported).split() == ["bracket", NAME, "brick"]
    with h5py.File(library) as before, h5py.File(imported) as after:
        for name in ("bracket", "brick"):
            for part in ("vertices", "sample_views", "ppf/entries", "trisi/features"):
                np.testing.assert_array_equal(after[f"models/{name}/{part}"],
                                              before[f"models/{name}/{part}"])
        assert "index" in after
    found = detections(trivet, tmp_path / "found.json", imported, outside.parent / "scan.ply",
                       "--models", NAME)
    assert len(found[NAME]) == 1


def test_texts_may_be_padded_and_their_padding_counts(trivet, outside, tmp_path):
    padded = tmp_path / "padded.h5"
    shutil.copy(outside, padded)
    with h5py.File(padded, "r+") as file:
        file.attrs.create("producer", np.bytes_("another program"), dtype="S40")
    reseal(padded)
    assert read_library(str(padded)).producer == "another program"
    trivet("library", "import", padded, "-o", tmp_path / "imported.h5")


def replace(group: h5py.Group, name: str, data: np.ndarray) -> None:
    del group[name]
    add_model.write_dataset(group, name, data)


def stretch_normal(model):
    model["ppf/normals"][2, 5] = 1.1


def misplace_point(model):
    model["ppf/points"][0, 3] = np.nan


def name_other_vertex(model):
    model["triangles"][1, 7] = 76


def name_other_reference(model):
    model["ppf/entries"][-1, 0] = model["ppf"].attrs["num_references"]


def swap_entries(model):
    cell = int(np.argmax(np.diff(model["ppf/offsets"][()].astype(np.int64))))
    row = int(model["ppf/offsets"][cell])
    model["ppf/entries"][row] = model["ppf/entries"][row + 1] + np.uint16([1, 0])


def let_offsets_fall(model):
    model["ppf/offsets"][9] = 2**31


def cut_offsets(model):
    replace(model, "ppf/offsets", model["ppf/offsets"][:-1])


def cut_entries(model):
    replace(model, "ppf/entries", model["ppf/entries"][:-1])


def cut_views(model):
    replace(model, "sample_views", model["sample_views"][1:])


def transpose_points(model):
    replace(model, "ppf/points", model["ppf/points"][()].T)


def widen_turns(model):
    replace(model, "ppf/entries", model["ppf/entries"][()].astype(np.uint32))


def drop_samples(model):
    del model["samples"]


def flatten(model):
    model.attrs["diameter"] = np.float32(0)


def mirror(model):
    replace(model, "symmetry_poses", np.diag([-1, 1, 1, 1])[None].astype(np.float32))


def add_dataset(model):
    add_model.write_dataset(model, "colors", np.zeros((3, 3), dtype=np.uint8))


@pytest.mark.parametrize("edit, reason", [
    (stretch_normal, "ppf/normals[5]: expected a unit vector, found ("),
    (misplace_point, "ppf/points[3]: expected coordinates of at most 1e12"),
    (name_other_vertex, "triangles[7]: expected an index below 76, found 76"),
    (name_other_reference, "expected a reference below"),
    (swap_entries, "sorted by reference, then angle"),
    (let_offsets_fall, "ppf/offsets[10]: expected at least 2147483648"),
    (cut_offsets, "ppf/offsets: expected 84376 rows, found 84375"),
    (cut_entries, "ppf/entries: expected "),
    (cut_views, "sample_views: expected "),
    (transpose_points, "ppf/points: expected float32 of shape (3, 0)"),
    (widen_turns, "ppf/entries: expected uint16"),
    (drop_samples, "samples: expected this dataset, found none"),
    (flatten, "diameter: expected a length from 1e-12 to 1e12, found 0"),
    (mirror, "symmetry_poses[0]: expected a rigid motion"),
    (add_dataset, "colors: the format has no such dataset"),
])
def test_trivet_refuses_what_breaks_the_format(trivet, outside, tmp_path, edit, reason):
    broken = tmp_path / "broken.h5"
    shutil.copy(outside, broken)
    with h5py.File(broken, "r+") as file:
        edit(file[f"models/{NAME}"])
    said = trivet("library", "import", broken, "-o", tmp_path / "out.h5", exit_code=65)
    assert "checksum" in said
    reseal(broken)
    said = trivet("library", "import", broken, "-o", tmp_path / "out.h5", exit_code=65)
    assert NAME in said and reason in said
    assert not (tmp_path / "out.h5").exists()
