"""The Python package: the same answers as the command line, from arrays."""

import json
import os
import pickle
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

trivet = pytest.importorskip("trivet")

DATA = Path(os.environ.get("TRIVET_DATA", ""))
PROGRAM = os.environ["TRIVET_PROGRAM"]


@pytest.fixture(scope="module")
def piles():
    return trivet.scan(parts=3, scenes=2, instances=3, seed=5)


@pytest.fixture(scope="module")
def library(piles, tmp_path_factory):
    file = tmp_path_factory.mktemp("library") / "parts.h5"
    trivet.train(piles.models, file, preset="fast")
    return trivet.Library(file)


def recognized_by_command(*arguments):
    run = subprocess.run([PROGRAM, "recognize", *map(str, arguments), "--json", "-"], check=True,
                         capture_output=True)
    return json.loads(run.stdout)["scenes"]


def poses_of(result):
    return [(found.model, found.pose.tolist()) for found in result]


def without_times(scene):
    return {key: value for key, value in scene.items() if key not in ("seconds", "scene")}


class TestRecognize:
    def test_agrees_with_the_command(self, tmp_path):
        """Every number is the same for a laser scan from points alone."""
        if not (DATA / "uwa").is_dir():
            pytest.fail("TRIVET_DATA: expected uwa") if DATA.is_dir() else pytest.skip("no data")
        file = tmp_path / "uwa.h5"
        manifest = json.loads((DATA / "uwa" / "manifest.json").read_text())
        trivet.train(DATA / "uwa" / "manifest.json", file)
        scan = DATA / "uwa" / manifest["scenes"][0]["file"]
        viewpoint = manifest["scenes"][0].get("viewpoint")
        where = [] if viewpoint is None else ["--viewpoint", *map(str, viewpoint)]
        expected = recognized_by_command(file, scan, *where)[0]
        assert expected["detections"]

        library = trivet.Library(file)
        read = trivet.Scene.read(str(scan), viewpoint=viewpoint)
        assert without_times(library.recognize(read).to_dict()) == without_times(expected)

        points = read.points + read.offset.astype(np.float32) if np.any(read.offset) else read.points
        found = library.recognize(points, viewpoint=viewpoint)
        assert [one["T_scene_model"] for one in found.to_dict()["detections"]] == [
            one["T_scene_model"] for one in expected["detections"]]
        assert [one["score"] for one in found.to_dict()["detections"]] == [
            one["score"] for one in expected["detections"]]

    def test_finds_what_was_scanned(self, piles, library):
        num_found = 0
        for scene in piles:
            found = library.recognize(scene.depth, camera=scene.camera,
                                      depth_scale=scene.depth_scale)
            num_found += len(found)
            for detection in found:
                near = min(np.linalg.norm(truth.pose[:3, 3] - detection.pose[:3, 3])
                           for truth in scene.truth if truth.model == detection.model)
                assert near < 0.1 * library[detection.model].diameter
                assert detection.covariance.shape == (6, 6)
                assert np.all(np.linalg.eigvalsh(detection.covariance) >= -1e-12)
                assert 0 < detection.covariance[0, 0] < library[detection.model].diameter ** 2
        assert num_found >= 3

    def test_accepts_arrays_of_any_layout(self, piles, library):
        scene = piles[0]
        once = library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
        expected = [one.pose.tolist() for one in once]
        assert expected
        matrix = np.diag([scene.camera[0], scene.camera[1], 1.0])
        matrix[:2, 2] = scene.camera[2:]
        wide = np.repeat(scene.depth, 2, axis=1)[:, ::2]
        for depth in (np.asfortranarray(scene.depth), wide, scene.depth.astype(float),
                      scene.depth.astype(">u2")):
            again = library.recognize(depth, camera=matrix, depth_scale=scene.depth_scale)
            assert [one.pose.tolist() for one in again] == expected

    def test_reads_a_camera_like_its_file(self, piles, library, tmp_path):
        scene = piles[0]
        fx, fy, cx, cy = scene.camera
        fields = {"fx": fx, "fy": fy, "cx": np.float32(cx), "cy": cy, "depth_scale": scene.depth_scale,
                  "width": scene.depth.shape[1], "height": scene.depth.shape[0]}
        matrix = np.asfortranarray([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        expected = library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
        file = tmp_path / "camera.json"
        file.write_text(json.dumps({**fields, "cx": cx}))
        for camera in (fields, file, str(file)):
            assert poses_of(library.recognize(scene.depth, camera=camera)) == poses_of(expected)
        assert poses_of(library.recognize(scene.depth, camera=matrix,
                                          depth_scale=scene.depth_scale)) == poses_of(expected)
        for wrong, words in (({**fields, "width": 7}, "7 x"), (matrix.T, "transposed"),
                             ({**fields, "model": "kannala_brandt4"}, "kannala_brandt4"),
                             ((fx, fy, float("nan"), cy), "finite"), (3, "dictionary")):
            with pytest.raises(trivet.Error, match=words):
                library.recognize(scene.depth, camera=wrong)
        bent = trivet.Scene.from_depth(scene.depth, {**fields, "distortion": [-0.2, 0, 0, 0, 0]})
        straight = trivet.Scene.from_depth(scene.depth, fields)
        assert not np.array_equal(bent.points, straight.points)

    def test_accepts_structured_arrays_by_their_names(self, piles, library):
        scene = piles[0]
        points = trivet.Scene.from_depth(scene.depth, scene.camera, depth_scale=scene.depth_scale).points
        fields = np.zeros(len(points), [("intensity", "f4"), ("x", "f4"), ("y", "f4"), ("z", "f4")])
        for axis, name in enumerate("xyz"):
            fields[name] = points[:, axis]
        assert np.array_equal(trivet.scenes.as_scene(fields).points, points)
        with pytest.raises(trivet.UsageError, match="dtype.names"):
            library.recognize(np.zeros(60, "f4,f4,f4"))

    def test_streams_in_order(self, piles, library):
        depths = [scene.depth for scene in piles] * 2
        how = {"camera": piles[0].camera, "depth_scale": piles[0].depth_scale}
        one_by_one = [[d.pose.tolist() for d in library.recognize(depth, **how)]
                      for depth in depths]
        streamed = [[d.pose.tolist() for d in result]
                    for result in library.recognize_all(iter(depths), **how)]
        assert streamed == one_by_one

    def test_lets_other_threads_run(self, piles, library):
        scene, turns, done = piles[0], 0, threading.Event()

        def recognize():
            library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
            done.set()

        thread = threading.Thread(target=recognize)
        thread.start()
        while not done.is_set():
            turns += 1
            time.sleep(0.001)
        thread.join()
        assert turns > 5

    def test_stops(self, piles, library):
        scene, stopper = piles[0], trivet.Stopper()
        stopper.stop()
        with pytest.raises(trivet.Stopped):
            library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale,
                              stopper=stopper)

    def test_is_interrupted(self, piles, library):
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            for scene in library.recognize_all(
                    [piles[0].depth] * 1000, camera=piles[0].camera,
                    depth_scale=piles[0].depth_scale):
                pass

    def test_raises_what_a_signal_raises(self, piles, library):
        def expire(number, frame):
            raise TimeoutError("expired")

        former = signal.signal(signal.SIGALRM, expire)
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        try:
            with pytest.raises(TimeoutError, match="expired"):
                for _ in range(100):
                    library.recognize(piles[0].depth, camera=piles[0].camera,
                                      depth_scale=piles[0].depth_scale)
        finally:
            signal.signal(signal.SIGALRM, former)

    def test_shows_pictures(self, piles, library):
        scene = piles[0]
        found = library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
        picture = found.picture()
        assert picture.shape[2] == 3 and picture.std() > 10
        assert found._repr_html_().count("<tr>") == 1 + len(found)
        nothing = library.recognize(np.zeros((48, 64), np.uint16), camera=scene.camera)
        assert len(nothing) == 0 and "<table>" in nothing._repr_html_()

    def test_tests_expected_poses(self, piles, library):
        scene = piles[0]
        how = {"camera": scene.camera, "depth_scale": scene.depth_scale}
        searched = library.recognize(scene.depth, **how)[0]
        found = library.recognize(scene.depth, rounds=0,
                                  expected=[(searched.model, searched.pose)], **how)
        assert [one.model for one in found] == [searched.model]
        assert found[0].source == "expected"

    def test_converts_units(self, piles, library):
        scene = piles[0]
        meters = library.recognize(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
        millimeters = library.recognize(scene.depth, camera=scene.camera,
                                        depth_scale=1000 * scene.depth_scale, unit="mm")
        # The surest one: rounding decides about others.
        assert millimeters[0].model == meters[0].model
        np.testing.assert_allclose(millimeters[0].pose[:3, 3], 1000 * meters[0].pose[:3, 3],
                                   atol=0.1)


class TestLibrary:
    def test_reads_as_a_mapping(self, library):
        assert len(library) == 3 and sorted(library) == library.names
        assert library.names[0] in library and "none" not in library
        with pytest.raises(KeyError):
            library["none"]
        assert library.unit == "m" and library.parameters["relative-step"] == pytest.approx(0.05)
        library.verify()

    def test_returns_arrays_without_a_copy(self, library):
        model = library[library.names[0]]
        for array in (model.vertices, model.samples, model.pairs["offsets"],
                      model.features[0]["codes"]):
            assert not array.flags.owndata and not array.flags.writeable
        assert np.shares_memory(model.vertices, model.vertices)
        assert model.triangles.max() < len(model.vertices)
        np.testing.assert_allclose(np.linalg.norm(model.sample_normals, axis=1), 1, atol=1e-3)
        extent = np.linalg.norm(np.ptp(model.vertices, axis=0))
        assert 0.5 * extent < model.diameter <= extent * 1.0001

    def test_outlives_its_file_object(self, library):
        samples = trivet.Library(library.file)[library.names[0]].samples
        assert np.isfinite(samples).all()

    def test_is_pickled_by_its_file(self, library):
        assert pickle.loads(pickle.dumps(library)).names == library.names


class TestTrain:
    def test_reuses_unchanged_models(self, piles, library):
        report = trivet.train(piles.models, library.file, preset="fast")
        assert report.unchanged and {one["origin"] for one in report.models} == {"kept"}

    def test_accepts_objects_that_hold_arrays(self, piles, tmp_path):
        mesh = next(iter(piles.models.values()))

        class Trimesh:
            vertices, faces = mesh.vertices, mesh.triangles

        class Open3D:
            vertices, triangles = mesh.vertices.astype(float), mesh.triangles

        trivet.train({"a": mesh, "b": (mesh.vertices, mesh.triangles), "c": Trimesh(),
                      "d": Open3D()}, tmp_path / "l.h5", methods=["ppf"])
        made = trivet.Library(tmp_path / "l.h5")
        assert len({made[name].fingerprint for name in made}) == 1

    def test_reports_progress_and_raises_errors(self, piles, tmp_path):
        reported = []
        trivet.train(piles.models, tmp_path / "a.h5", preset="fast",
                     progress=lambda done, total, name: reported.append((done, total)))
        assert reported[0] == (0, 3) and reported[-1] == (3, 3)

        def fail(done, total, name):
            raise RuntimeError("enough")

        with pytest.raises(RuntimeError, match="enough"):
            trivet.train(piles.models, tmp_path / "b.h5", preset="fast", progress=fail)
        assert not (tmp_path / "b.h5").exists()


class TestEvaluate:
    def test_agrees_with_the_command(self, library, tmp_path):
        subprocess.run([PROGRAM, "scan", "--parts", "3", "--scenes", "2", "--instances", "3",
                        "--seed", "5", "-o", tmp_path / "scans"], check=True, capture_output=True)
        manifest = tmp_path / "scans" / "manifest.json"
        reported = []
        found = trivet.evaluate(library, manifest, progress=lambda *one: reported.append(one[:2]))
        run = subprocess.run([PROGRAM, "evaluate", library.file, manifest, "--json", "-"],
                             check=True, capture_output=True)
        expected = json.loads(run.stdout)
        for key in ("instances", "right", "false_positives", "average_precision", "by_model"):
            assert found.document[key] == expected[key]
        assert found.instances > 0 and reported[-1] == (2, 2)


class TestMesh:
    def test_lays_a_surface_through_a_scan(self, piles):
        scene = piles[0]
        made = trivet.mesh(scene.depth, camera=scene.camera, depth_scale=scene.depth_scale)
        assert made.triangles.shape[1] == 3 and made.triangles.max() < len(made.vertices)
        with pytest.raises(trivet.UsageError, match="grid"):
            trivet.mesh(scene.depth, camera=scene.camera, method="none")


class TestErrors:
    def test_are_exceptions_by_kind(self, library, tmp_path):
        with pytest.raises(FileNotFoundError, match="none.h5"):
            trivet.Library("none.h5")
        (tmp_path / "bad.h5").write_bytes(b"no library")
        with pytest.raises(trivet.DataError, match="bad.h5"):
            trivet.Library(tmp_path / "bad.h5")
        with pytest.raises(trivet.UsageError, match="found 'min_scor'; did you mean 'min_score'"):
            library.recognize(np.zeros((10, 3)), min_scor=0.5)
        with pytest.raises(trivet.UsageError, match="min-score"):
            library.recognize(np.zeros((10, 3)), min_score=2)
        with pytest.raises(ValueError, match="camera"):
            library.recognize(np.zeros((4, 4), np.uint16), camera=(1, 2))
        for points in (np.zeros((3, 2)), "a b".split(), np.zeros(3), None, {}):
            with pytest.raises(trivet.Error):
                library.recognize(points)
        with pytest.raises(trivet.UsageError, match="expected"):
            library.recognize(np.zeros((10, 3)), expected=[("a", 2 * np.eye(4))])


def test_options_are_those_of_the_command_line():
    for command in ("recognize", "train", "scan"):
        run = subprocess.run([PROGRAM, command, "--help"], check=True, capture_output=True,
                             text=True)
        for option in trivet.options(command):
            assert "--" + option["name"].replace("_", "-") in run.stdout
