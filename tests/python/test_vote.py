"""examples/vote.py finds the poses that trivet finds."""
import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import detections, read_depth, run_example
from scipy.spatial.transform import Rotation

import vote
from read_library import read_library

MOST_MOVED, MOST_TURNED = 0.02, 3.0  # [diameter], [degrees], up to symmetry


def nearest(model, pose: np.ndarray, others: np.ndarray) -> tuple[float, float]:
    moved, turned, _ = vote.differences(model, pose, others, vote.symmetric_motions(model, 720))
    best = moved.argmin()
    return moved[best], turned[best]


def test_finds_the_bracket_of_a_scan(trivet, library, outside, tmp_path):
    scan = outside.parent / "scan.ply"
    found = run_example("vote.py", library, "bracket", scan, "--json", tmp_path / "vote.json")
    assert found.returncode == 0, found.stderr
    written = json.loads((tmp_path / "vote.json").read_text(encoding="utf-8"))
    assert written["model"] == "bracket"
    assert f"{written['votes']} votes" in found.stdout
    model = read_library(str(library)).models["bracket"]
    others = detections(trivet, tmp_path / "trivet.json", library, scan)["bracket"]
    moved, turned = nearest(model, np.array(written["T_scene_model"]), others)
    assert moved < MOST_MOVED and turned < MOST_TURNED


def test_points_of_the_model_vote_for_where_it_is(library):
    model = read_library(str(library)).models["bracket"]
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", (1, 2, 3)).as_matrix()
    pose[:3, 3] = 100, 200, 300
    points = model.pairs.points @ pose[:3, :3].T + pose[:3, 3]
    normals = model.pairs.normals @ pose[:3, :3].T
    scene = vote.Scene(points, normals, np.arange(len(points)), np.zeros(3))
    poses, votes = vote.vote(model, scene)
    moved, turned, _ = vote.differences(model, pose, poses, np.eye(4)[None])
    good = (moved < 0.1) & (turned < 15)
    assert good.mean() > 0.8
    assert good[votes.argmax()]


def test_agrees_with_trivet_on_a_laser_scan(trivet, data, tmp_path):
    manifest = data / "uwa" / "manifest.json"
    trivet("train", manifest, "--methods", "ppf", "-o", tmp_path / "uwa.h5")
    found = detections(trivet, tmp_path / "uwa.json", tmp_path / "uwa.h5", manifest)
    models = read_library(str(tmp_path / "uwa.h5")).models
    points = vote.read_scene(str(data / "uwa" / "scenes" / "rs1_normals2.ply"))
    assert sorted(found) == sorted(models)
    for name, model in models.items():
        own = vote.recognize(model, points, np.zeros(3))
        moved, turned = nearest(model, own.T_scene_model, found[name])
        print(f"{name}: {moved:.4f} diameters, {turned:.3f} degrees apart")
        assert moved < MOST_MOVED and turned < MOST_TURNED, name


@pytest.fixture(scope="module")
def bin_scene(trivet, data, tmp_path_factory):
    """The models of a bin of parts, the points of a scene, and what trivet finds in it."""
    folder = tmp_path_factory.mktemp("bin")
    manifest = json.loads((data / "clutter_bin" / "manifest.json").read_text(encoding="utf-8"))
    scene = manifest["scenes"][0]
    camera = folder / "camera.json"
    camera.write_text(json.dumps(scene["camera"]), encoding="utf-8")
    trivet("train", data / "clutter_bin" / "manifest.json", "--methods", "ppf",
           "-o", folder / "bin.h5")
    depth = data / "clutter_bin" / scene["file"]
    found = detections(trivet, folder / "bin.json", folder / "bin.h5", depth, "--camera", camera)
    fx, fy, cx, cy, scale = (scene["camera"][k] for k in ("fx", "fy", "cx", "cy", "depth_scale"))
    z = read_depth(depth) * scale
    v, u = np.nonzero(z)
    z = z[v, u]
    points = np.stack([(u - cx) * z / fx, (v - cy) * z / fy, z], axis=1)
    return read_library(str(folder / "bin.h5")).models, points, found


# Models with six turns and six flips, and with an axis and a flip; those of the laser scan have no symmetry.
@pytest.mark.parametrize("name", ["gear", "pipe"])
def test_agrees_with_trivet_on_a_bin_of_parts(bin_scene, name):
    models, points, found = bin_scene
    own = vote.recognize(models[name], points, np.zeros(3))
    moved, turned = nearest(models[name], own.T_scene_model, found[name])
    print(f"{name}: {moved:.4f} diameters, {turned:.3f} degrees apart")
    assert moved < MOST_MOVED and turned < MOST_TURNED


def test_differences_are_up_to_symmetry(library):
    model = read_library(str(library)).models["brick"]
    motions = vote.symmetric_motions(model, 1)
    pose = np.eye(4)
    pose[:3, 3] = 10, 20, 30
    moved, turned, nearest_poses = vote.differences(model, pose, pose @ motions, motions)
    np.testing.assert_allclose(moved, 0, atol=1e-3)
    np.testing.assert_allclose(turned, 0, atol=0.1)
    np.testing.assert_allclose(nearest_poses, np.tile(pose, (4, 1, 1)), atol=0.1)
    pushed = pose.copy()
    pushed[0, 3] += model.diameter / 2
    assert vote.differences(model, pose, pushed[None], motions)[0] == pytest.approx(0.5)


def test_turns_about_an_axis_leave_it_where_it_is(library):
    axis = np.array([0, 0.6, 0.8]), np.array([5, -3, 2])
    model = replace(read_library(str(library)).models["bracket"], symmetry_axis=axis)
    motions = vote.symmetric_motions(model, 8)
    assert len(motions) == 8
    for along in (0, 10):
        on_axis = np.append(axis[1] + along * axis[0], 1)
        np.testing.assert_allclose(motions @ on_axis, np.tile(on_axis, (8, 1)), atol=1e-9)
    assert np.trace(motions[1, :3, :3]) == pytest.approx(1 + 2 * np.cos(np.pi / 4))


def test_reads_ply_and_npy_alike(tmp_path):
    points = np.array([[1, 2, 3], [-0.5, np.nan, 4], [7, 8, 9.25]])
    np.save(tmp_path / "a.npy", points)
    head = ("ply\nformat {}\ncomment a scan\nelement vertex 3\nproperty uchar red\n"
            "property float x\nproperty double y\nproperty float z\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n")
    rows = "".join("7 {} {} {}\n".format(*row) for row in points) + "3 0 1 2\n"
    (tmp_path / "a.ply").write_text(head.format("ascii 1.0") + rows, encoding="utf-8")
    packed = np.zeros(3, [("red", "u1"), ("x", "<f4"), ("y", "<f8"), ("z", "<f4")])
    packed["x"], packed["y"], packed["z"] = points.T
    (tmp_path / "b.ply").write_bytes(head.format("binary_little_endian 1.0").encode()
                                     + packed.tobytes() + b"\3" + bytes(12))
    for name in ("a.npy", "a.ply", "b.ply"):
        np.testing.assert_array_equal(vote.read_scene(str(tmp_path / name)), points[[0, 2]])


@pytest.mark.parametrize("content, reason", [
    (b"solid\n", "expected a PLY file"),
    (b"ply\nformat ascii 1.0\nelement vertex 1\n", "expected end_header"),
    (b"ply\nformat ascii 1.0\nelement face 1\nelement vertex 1\nend_header\n", "vertices first"),
    (b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nend_header\n",
     "found binary_big_endian"),
    (b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n"
     b"property float y\nproperty float z\nend_header\n" + bytes(12), "expected 2 vertices"),
    (b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
     b"property float y\nproperty float z\nend_header\n1 2 3\n", "expected 2 vertices"),
])
def test_refuses_other_scenes_with_a_reason(tmp_path, content, reason):
    (tmp_path / "scan.ply").write_bytes(content)
    with pytest.raises(ValueError, match=reason):
        vote.read_scene(str(tmp_path / "scan.ply"))


def test_names_what_is_missing(library, outside):
    scan = outside.parent / "scan.ply"
    assert "has no model other" in run_example("vote.py", library, "other", scan).stderr
    assert run_example("vote.py", library, "brick", "none.ply").returncode == 1
