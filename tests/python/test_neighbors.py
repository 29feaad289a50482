"""Messages of ROS 2 and structures of the BOP toolkit, against their definitions."""

import numpy as np
import pytest

trivet = pytest.importorskip("trivet")
from scipy.spatial.transform import Rotation  # noqa: E402
from trivet import bop, ros  # noqa: E402

# Names and types of fields, as the definitions give them: vision_msgs 4, geometry_msgs.
VECTOR = {"x": float, "y": float, "z": float}
POSE = {"position": VECTOR, "orientation": {**VECTOR, "w": float}}
DETECTION = {
    "header": dict,
    "results": [{"hypothesis": {"class_id": str, "score": float},
                 "pose": {"pose": POSE, "covariance": [float]}}],
    "bbox": {"center": POSE, "size": VECTOR},
    "id": str,
}


def check(value, definition, at="message"):
    if isinstance(definition, dict):
        assert value.keys() == definition.keys(), at
        for key in definition:
            check(value[key], definition[key], f"{at}.{key}")
    elif isinstance(definition, list):
        for one in value:
            check(one, definition[0], at)
    else:
        assert type(value) is definition, at


def cloud_message(points, kind="<f4", offsets=(0, 4, 8), step=16, height=1):
    width = len(points) // height
    raw = np.zeros((len(points), step), np.uint8)
    for axis, offset in enumerate(offsets):
        size = np.dtype(kind).itemsize
        column = points[:, axis].astype(kind).view(np.uint8).reshape(-1, size)
        raw[:, offset:offset + size] = column
    datatype = {"f4": 7, "f8": 8}[kind[1:]]
    return {"header": {}, "height": height, "width": width, "is_bigendian": kind[0] == ">",
            "fields": [{"name": axis, "offset": offset, "datatype": datatype, "count": 1}
                       for axis, offset in zip("xyz", offsets)],
            "point_step": step, "row_step": step * width, "data": raw.tobytes(), "is_dense": True}


@pytest.fixture(scope="module")
def pile():
    return trivet.scan(parts=2, scenes=1, instances=2, seed=3)


@pytest.fixture(scope="module")
def library(pile, tmp_path_factory):
    file = tmp_path_factory.mktemp("neighbors") / "parts.h5"
    trivet.train(pile.models, file, preset="fast", methods=["ppf"])
    return trivet.Library(file)


@pytest.fixture(scope="module")
def result(pile, library):
    scene = pile[0]
    found = library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale,
                              method="ppf")
    assert len(found) > 0
    return found


class TestPointCloud2:
    points = np.random.default_rng(1).normal(size=(12, 3)).astype(np.float32)

    @pytest.mark.parametrize("message", [
        {}, {"kind": ">f4"}, {"kind": "<f8", "offsets": (0, 8, 16), "step": 24},
        {"offsets": (8, 0, 4), "step": 20}])
    def test_is_read_in_any_layout(self, message):
        read = ros.points_of(cloud_message(self.points, **message))
        np.testing.assert_array_equal(read, self.points)

    def test_is_organized(self):
        read = ros.points_of(cloud_message(self.points, height=3))
        np.testing.assert_array_equal(read, self.points.reshape(3, 4, 3))

    def test_is_not_copied(self):
        message = cloud_message(self.points)
        assert np.shares_memory(ros.points_of(message), np.frombuffer(message["data"], np.uint8))

    def test_accepts_lists_of_numbers(self):
        message = cloud_message(self.points)
        message["data"] = list(message["data"])
        np.testing.assert_array_equal(ros.points_of(message), self.points)

    def test_is_refused_where_bytes_or_fields_are_missing(self):
        message = cloud_message(self.points)
        with pytest.raises(trivet.DataError, match="bytes"):
            ros.points_of({**message, "data": message["data"][:-5]})
        with pytest.raises(trivet.DataError, match="x, y, z"):
            ros.points_of({**message, "fields": message["fields"][:2]})


class TestDetection3DArray:
    def test_has_the_fields_of_its_definition(self, result, library):
        message = ros.detections_of(result, library, {"frame_id": "camera"})
        assert message["header"] == {"frame_id": "camera"}
        assert len(message["detections"]) == len(result)
        for one in message["detections"]:
            check({**one, "header": {}}, {**DETECTION, "header": {}})
            assert all(len(r["pose"]["covariance"]) == 36 for r in one["results"])

    def test_places_the_box_around_the_model(self, result, library):
        for message, found in zip(ros.detections_of(result, library)["detections"], result):
            vertices = library[found.model].vertices @ found.pose[:3, :3].T + found.pose[:3, 3]
            box = message["bbox"]
            center = np.array([box["center"]["position"][axis] for axis in "xyz"])
            turn = Rotation.from_quat([box["center"]["orientation"][axis] for axis in "xyzw"])
            inside = np.abs(turn.inv().apply(vertices - center))
            half = np.array([box["size"][axis] for axis in "xyz"]) / 2
            np.testing.assert_allclose(inside.max(axis=0), half, rtol=1e-4)


def test_quaternions_are_those_of_scipy():
    for turn in [*Rotation.random(200, random_state=1), Rotation.from_euler("xyz", [np.pi, 0, 0]),
                 Rotation.from_euler("xyz", [0, np.pi, 0]), Rotation.identity()]:
        pose = np.eye(4)
        pose[:3, :3] = turn.as_matrix()
        found = np.array(ros.quaternion_of(pose))
        assert found[3] >= 0 and abs(abs(found @ turn.as_quat()) - 1) < 1e-9


class TestBop:
    def test_results_are_what_the_toolkit_saves(self, result):
        ids = {found.model: number + 1 for number, found in enumerate(result)}
        estimates = bop.results_of(result, 1, 2, ids)
        assert len(estimates) == len(result)
        for estimate, found in zip(estimates, result):
            assert estimate["R"].shape == (3, 3) and estimate["t"].shape == (3, 1)
            np.testing.assert_allclose(estimate["t"][:, 0], 1000 * found.pose[:3, 3])
            assert (estimate["scene_id"], estimate["im_id"]) == (1, 2)
            assert estimate["obj_id"] == ids[found.model] and estimate["time"] > 0
        assert bop.results_of(result, 1, 2, {}) == []

    def test_cameras_and_truth(self, pile, library, result):
        scene = pile[0]
        fx, fy, cx, cy = scene.camera
        entry = {"cam_K": [fx, 0, cx, 0, fy, cy, 0, 0, 1], "depth_scale": 1000 * scene.depth_scale}
        again = library.recognize(scene.depth, method="ppf", **bop.camera_of(entry))
        assert [one.model for one in again] == [one.model for one in result]
        truth = bop.truth_of(scene, {one.model: 7 for one in scene.truth})
        assert truth[0]["cam_R_m2c"].shape == (3, 3) and truth[0]["cam_t_m2c"].shape == (3, 1)


def with_open3d(points, triangles=None):
    open3d = pytest.importorskip("open3d")
    points = open3d.utility.Vector3dVector(np.asarray(points, dtype=float))
    if triangles is None:
        return open3d.geometry.PointCloud(points)
    return open3d.geometry.TriangleMesh(points, open3d.utility.Vector3iVector(triangles))


def with_trimesh(points, triangles=None):
    trimesh = pytest.importorskip("trimesh")
    if triangles is None:
        return trimesh.PointCloud(points)
    return trimesh.Trimesh(points, triangles, process=False)


@pytest.mark.parametrize("of", [with_open3d, with_trimesh])
class TestObjectsOfOthers:
    """The folder of the installed packages; TestTrain of test_package.py has their layout."""

    def test_are_trained_from(self, of, library, tmp_path):
        model = library[library.names[0]]
        trivet.train({"one": of(model.vertices, np.asarray(model.triangles))},
                     tmp_path / "one.h5", preset="fast", methods=["ppf"])
        again = trivet.Library(tmp_path / "one.h5")["one"]
        np.testing.assert_array_equal(again.vertices, model.vertices)
        np.testing.assert_array_equal(again.triangles, model.triangles)

    def test_are_recognized_in(self, of, pile, library):
        scene = pile[0]
        fx, fy, cx, cy = scene.camera
        rows, columns = np.nonzero(scene.depth)
        z = scene.depth[rows, columns] * scene.depth_scale
        points = np.stack([(columns - cx) / fx * z, (rows - cy) / fy * z, z], axis=1)
        found = library.recognize(of(points), viewpoint=(0, 0, 0), method="ppf")
        assert {one.model for one in found} == {one.model for one in scene.truth}
