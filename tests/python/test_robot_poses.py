"""`trivet recognize --robot-csv` against conversions by SciPy."""

import csv
import json
import os
import subprocess

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

PROGRAM = os.environ.get("TRIVET_PROGRAM")
pytestmark = pytest.mark.skipif(not PROGRAM, reason="TRIVET_PROGRAM is not set")

# Hand-eye calibration in m: the camera looks down from 1.2 m, turned about the vertical.
FRAME = np.eye(4)
FRAME[:3, :3] = Rotation.from_euler("ZX", [40, 180], degrees=True).as_matrix()
FRAME[:3, 3] = [0.4, -0.2, 1.2]


def run(*arguments, at):
    done = subprocess.run([PROGRAM, *arguments], cwd=at, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    at = tmp_path_factory.mktemp("robot")
    run("scan", "--parts", "2", "--scenes", "1", "--instances", "2", "--seed", "3", "-o", "scans", at=at)
    run("train", "scans/manifest.json", "--methods", "ppf", "-o", "library.h5", at=at)
    run("recognize", "library.h5", "scans/manifest.json", "--json", "found.json", at=at)
    (at / "frame.json").write_text(json.dumps(FRAME.tolist()))
    return at


def detections(folder):
    return json.loads((folder / "found.json").read_text())["scenes"][0]["detections"]


def table(folder, convention, *options):
    run("recognize", "library.h5", "scans/manifest.json", "--robot", convention, "--robot-csv",
        "poses.csv", "--robot-frame", "frame.json", *options, at=folder)
    with open(folder / "poses.csv", newline="") as file:
        return list(csv.DictReader(file))


def rotation_of(row, convention):
    """Rotations by the definitions in the controllers' manuals."""
    numbers = [float(value) for value in list(row.values())[9:-1]]
    match convention:
        case "quaternion":
            return Rotation.from_quat(numbers)
        case "rpy":
            return Rotation.from_euler("xyz", numbers)
        case "kuka":
            return Rotation.from_euler("ZYX", numbers, degrees=True)
        case "fanuc":
            return Rotation.from_euler("xyz", numbers, degrees=True)
        case "ur":
            return Rotation.from_rotvec(numbers)
        case "abb":
            return Rotation.from_quat(numbers[1:] + numbers[:1])


@pytest.mark.parametrize("convention", ["quaternion", "rpy", "kuka", "fanuc", "ur", "abb"])
def test_is_the_pose_in_the_frame_of_the_robot(folder, convention):
    rows = table(folder, convention)
    assert [row["model"] for row in rows] == [one["model"] for one in detections(folder)]
    unit = 1000 if convention in ("kuka", "fanuc", "abb") else 1
    for row, one in zip(rows, detections(folder)):
        pose = FRAME @ np.array(one["T_scene_model"])
        position = [float(value) for value in list(row.values())[6:9]]
        np.testing.assert_allclose(position, unit * pose[:3, 3], atol=unit * 1e-6)
        turn = rotation_of(row, convention) * Rotation.from_matrix(pose[:3, :3]).inv()
        assert turn.magnitude() < 1e-5
        assert row["grasp"] == "" and row["frame"] == "robot"
        assert float(row["score"]) == pytest.approx(one["score"], abs=1e-6)


def test_writes_a_row_for_each_grasp(folder):
    model = detections(folder)[0]["model"]
    grasps = {"side": np.eye(4), "top": np.eye(4)}
    grasps["top"][:3, :3] = Rotation.from_euler("y", 90, degrees=True).as_matrix()
    grasps["top"][:3, 3] = [0, 0.01, 0.02]
    (folder / "grasps.json").write_text(
        json.dumps({model: {name: frame.tolist() for name, frame in grasps.items()}}))
    rows = table(folder, "abb", "--grasps", "grasps.json")
    own = [row for row in rows if row["model"] == model]
    assert [row["grasp"] for row in own] == ["side", "top"]
    pose = FRAME @ np.array(detections(folder)[0]["T_scene_model"]) @ grasps["top"]
    position = [float(value) for value in list(own[1].values())[6:9]]
    np.testing.assert_allclose(position, 1000 * pose[:3, 3], atol=1e-3)
    assert all(row["grasp"] == "" for row in rows if row["model"] != model)


def test_grasps_of_unknown_models_are_refused(folder):
    (folder / "typo.json").write_text(json.dumps({"brakcet": {"top": np.eye(4).tolist()}}))
    done = subprocess.run(
        [PROGRAM, "recognize", "library.h5", "scans/manifest.json", "--robot-csv", "poses.csv",
         "--grasps", "typo.json"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 2 and "brakcet" in done.stderr


def test_the_table_names_the_frame_of_the_scene_without_a_calibration(folder):
    run("recognize", "library.h5", "scans/manifest.json", "--robot-csv", "own.csv", at=folder)
    with open(folder / "own.csv", newline="") as file:
        assert {row["frame"] for row in csv.DictReader(file)} == {"scene"}


def test_a_calibration_in_another_unit_is_warned_of(folder):
    frame = FRAME.copy()
    frame[:3, 3] *= 1000
    (folder / "in_mm.json").write_text(json.dumps(frame.tolist()))
    done = run("recognize", "library.h5", "scans/manifest.json", "--robot-csv", "poses.csv",
               "--robot-frame", "in_mm.json", at=folder)
    assert "in_mm.json: it moves by 1281 m" in done.stderr and "is it in mm?" in done.stderr
    assert "in_mm" not in run("recognize", "library.h5", "scans/manifest.json", "--robot-csv", "poses.csv",
                              "--robot-frame", "frame.json", at=folder).stderr
