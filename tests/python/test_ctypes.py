"""The C interface from Python: the answers are those of the program, to the bit.

TRIVET_C_LIBRARY names libtrivet.so, TRIVET_PROGRAM the program.
"""
import ctypes
import json
import os
import pathlib
import subprocess
import sys
import threading
from ctypes import POINTER, byref, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_size_t
from ctypes import c_uint32, c_uint64, c_void_p

import numpy
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "c"))
import make_data  # noqa: E402

PROGRAM = os.environ["TRIVET_PROGRAM"]
OK, USAGE, BAD_DATA, MISSING_INPUT, STOPPED = 0, 2, 65, 66, 75
FLOAT32, FLOAT64, UINT16 = 0, 1, 2
UNIT_OF_LIBRARY, METER, MILLIMETER = 0, 1, 2


class Error(ctypes.Structure):
    _fields_ = [("status", c_int32), ("message", c_char * 1020)]


class Camera(ctypes.Structure):
    _fields_ = [*((name, c_double) for name in ("fx", "fy", "cx", "cy", "depth_scale")),
                ("distortion", c_double * 8),
                *((name, c_uint32) for name in ("depth_along_ray", "width", "height"))]


class Detection(ctypes.Structure):
    _fields_ = [("pose", c_double * 16), ("model", c_uint32), ("num_alternatives", c_uint32),
                *((name, c_float) for name in ("score", "pose_share", "visible_fraction",
                                               "hidden_fraction", "outside_fraction", "violation",
                                               "contour", "rmse"))]


class Scene(ctypes.Structure):
    _fields_ = [("num_points", c_uint64), ("num_invalid", c_uint64), ("noise", c_double),
                ("seconds", c_double)]


def declare():
    lib = ctypes.CDLL(os.environ["TRIVET_C_LIBRARY"])
    end = [c_void_p, POINTER(c_char_p), c_void_p, POINTER(c_void_p), POINTER(Error)]
    for name, result, arguments in (
            ("version", c_char_p, []),
            ("open", c_int, [c_char_p, c_char_p, POINTER(c_void_p), POINTER(Error)]),
            ("close", None, [c_void_p]),
            ("num_models", c_size_t, [c_void_p]),
            ("model_name", c_char_p, [c_void_p, c_size_t]),
            ("model_diameter", c_double, [c_void_p, c_size_t]),
            ("library_unit", c_int, [c_void_p]),
            ("recognize_points", c_int, [c_void_p, c_void_p, c_int, c_size_t, c_size_t, c_size_t,
                                         POINTER(c_double), c_int, *end[1:]]),
            ("recognize_depth", c_int, [c_void_p, c_void_p, c_int, c_size_t, c_size_t, c_size_t,
                                        POINTER(Camera), c_int, *end[1:]]),
            ("num_detections", c_size_t, [c_void_p]),
            ("get_detection", c_int, [c_void_p, c_size_t, POINTER(Detection)]),
            ("get_alternative", c_int, [c_void_p, c_size_t, c_size_t, POINTER(c_double)]),
            ("get_scene", c_int, [c_void_p, POINTER(Scene)]),
            ("free_result", None, [c_void_p]),
            ("new_stopper", c_void_p, []),
            ("stop", None, [c_void_p]),
            ("free_stopper", None, [c_void_p])):
        function = getattr(lib, "trivet_" + name)
        function.restype, function.argtypes = result, arguments
    return lib


LIB = declare()


class Failure(Exception):
    def __init__(self, status, error):
        super().__init__(error.message.decode())
        assert error.status == status
        self.status = status


def open_library(file, calibration=None):
    library, error = c_void_p(), Error()
    status = LIB.trivet_open(os.fsencode(file), calibration, byref(library), byref(error))
    if status != OK:
        assert not library
        raise Failure(status, error)
    return library


def texts(options):
    encoded = [option.encode() for option in options]
    return (c_char_p * (len(encoded) + 1))(*encoded, None)


def take(call):
    """Read a complete result, and free it."""
    result, error = c_void_p(), Error()
    status = call(byref(result), byref(error))
    if status != OK:
        assert not result
        raise Failure(status, error)
    detections = []
    for i in range(LIB.trivet_num_detections(result)):
        detection = Detection()
        assert LIB.trivet_get_detection(result, i, byref(detection)) == OK
        alternatives = []
        for k in range(detection.num_alternatives):
            pose = (c_double * 16)()
            assert LIB.trivet_get_alternative(result, i, k, pose) == OK
            alternatives.append(list(pose))
        assert LIB.trivet_get_alternative(result, i, len(alternatives), (c_double * 16)()) == USAGE
        detections.append((detection, alternatives))
    assert LIB.trivet_get_detection(result, len(detections), byref(Detection())) == USAGE
    scene = Scene()
    assert LIB.trivet_get_scene(result, byref(scene)) == OK
    LIB.trivet_free_result(result)
    return detections, scene


NUMBERS = {numpy.dtype("f4"): FLOAT32, numpy.dtype("f8"): FLOAT64, numpy.dtype("u2"): UINT16}


def recognize_depth(library, depths, camera, options=(), unit=UNIT_OF_LIBRARY, stopper=None):
    height, width = depths.shape
    return take(lambda result, error: LIB.trivet_recognize_depth(
        library, depths.ctypes.data, NUMBERS[depths.dtype], width, height,
        depths.strides[0] // depths.itemsize, byref(Camera(**camera)), unit, texts(options), stopper,
        result, error))


def recognize_points(library, xyz, viewpoint=None, options=(), unit=UNIT_OF_LIBRARY):
    height, width = (1, len(xyz)) if xyz.ndim == 2 else xyz.shape[:2]
    place = None if viewpoint is None else (c_double * 3)(*viewpoint)
    return take(lambda result, error: LIB.trivet_recognize_points(
        library, xyz.ctypes.data, NUMBERS[xyz.dtype], width, height,
        xyz.strides[-2] // xyz.itemsize, place, unit, texts(options), None, result, error))


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    class Data:
        folder = tmp_path_factory.mktemp("trivet")
    Data.depths, Data.camera, Data.scene = make_data.make(PROGRAM, Data.folder / "made")
    Data.folder = Data.folder / "made"
    Data.file = Data.folder / "parts.h5"
    Data.library = open_library(Data.file)
    yield Data
    LIB.trivet_close(Data.library)


def program(data, *arguments):
    """The first scene of what `trivet recognize --json -` says."""
    done = subprocess.run([PROGRAM, "--quiet", "recognize", "parts.h5", *arguments, "--json", "-"],
                          cwd=data.folder, check=True, capture_output=True)
    return json.loads(done.stdout)["scenes"][0]


def assert_same(found, scene, library):
    """Doubles of JSON are exact; its floats are the shortest decimals that read back as they were."""
    detections, stats = found
    assert stats.num_points == scene["points"]
    assert stats.num_invalid == scene["invalid_points"]
    assert numpy.float32(stats.noise) == numpy.float32(scene["noise"])
    assert len(detections) == len(scene["detections"])
    for (detection, alternatives), expected in zip(detections, scene["detections"]):
        assert LIB.trivet_model_name(library, detection.model).decode() == expected["model"]
        assert list(detection.pose) == sum(expected["T_scene_model"], [])
        assert alternatives == [sum(pose, []) for pose in expected["alternatives"]]
        for name in ("score", "pose_share", "visible_fraction", "hidden_fraction",
                     "outside_fraction", "violation", "contour", "rmse"):
            assert numpy.float32(getattr(detection, name)) == numpy.float32(expected[name]), name


def points_of(depths, camera):
    """Depths in front of the camera, zero where nothing was measured."""
    v, u = numpy.indices(depths.shape)
    z = depths * camera["depth_scale"]
    return numpy.stack([(u - camera["cx"]) * z / camera["fx"],
                        (v - camera["cy"]) * z / camera["fy"], z], axis=-1)


def test_version_is_that_of_the_program():
    said = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout
    assert LIB.trivet_version().decode() in said.split()


def test_models_are_those_of_the_library(data):
    names = [LIB.trivet_model_name(data.library, m).decode()
             for m in range(LIB.trivet_num_models(data.library))]
    said = json.loads((data.folder / "scans/manifest.json").read_text())
    assert names == sorted(said["models"])
    assert LIB.trivet_library_unit(data.library) == MILLIMETER
    assert all(20 < LIB.trivet_model_diameter(data.library, m) < 200 for m in range(len(names)))
    assert LIB.trivet_model_name(data.library, len(names)) is None
    assert LIB.trivet_model_diameter(data.library, len(names)) == 0


def test_depths_of_every_type_and_stride_give_what_the_program_finds(data):
    depths = data.depths
    padded = numpy.zeros((depths.shape[0], depths.shape[1] + 3), numpy.uint16)
    padded[:, :-3] = depths
    for image in (depths, padded[:, :-3], depths.astype("f4"), depths.astype("f8")):
        assert_same(recognize_depth(data.library, image, data.camera), data.scene, data.library)


def test_depths_in_another_unit_give_poses_in_it(data):
    in_meters = dict(data.camera, depth_scale=data.camera["depth_scale"] / 1000)
    (data.folder / "camera.json").write_text(json.dumps(in_meters))
    expected = program(data, data.scene["scene"], "--camera", "camera.json", "--unit", "m")
    assert expected["detections"]
    assert_same(recognize_depth(data.library, data.depths, in_meters, unit=METER), expected,
                data.library)


def test_a_camera_says_its_distortion_its_kind_of_depth_and_its_size(data):
    height, width = data.depths.shape
    said = dict(data.camera, distortion=[-0.1, 0.02, 0.001, 0, 0, 0, 0, 0])
    for more, in_c in ((dict(said), said), (dict(data.camera, depth="ray"),
                                            dict(data.camera, depth_along_ray=1))):
        (data.folder / "camera.json").write_text(json.dumps(more))
        expected = program(data, data.scene["scene"], "--camera", "camera.json")
        values = dict(in_c, width=width, height=height)
        if "distortion" in values:
            values["distortion"] = (c_double * 8)(*values["distortion"])
        assert_same(recognize_depth(data.library, data.depths, values), expected, data.library)
        assert expected["detections"] != data.scene["detections"]
    with pytest.raises(Failure, match=f"{width} x {height}"):
        recognize_depth(data.library, data.depths, dict(data.camera, width=2 * width, height=height))


def test_points_give_what_the_program_finds(data):
    xyz = points_of(data.depths, data.camera)
    cloud = xyz[data.depths > 0].astype("f4")[::2]
    cloud[10] = numpy.nan
    numpy.save(data.folder / "cloud.npy", cloud)
    expected = program(data, "cloud.npy", "--viewpoint", "0,0,-1")
    assert expected["detections"] and expected["invalid_points"] == 1
    padded = numpy.full((len(cloud), 8), 1e30, "f4")
    padded[:, :3] = cloud
    for array in (cloud, padded[:, :3], cloud.astype("f8")):
        assert_same(recognize_points(data.library, array, (0, 0, -1)), expected, data.library)


def test_organized_points_give_what_the_program_finds(data):
    xyz = points_of(data.depths, data.camera)
    numpy.save(data.folder / "grid.npy", xyz)
    expected = program(data, "grid.npy")
    assert expected["detections"] and expected["invalid_points"] > 0
    assert_same(recognize_points(data.library, xyz), expected, data.library)


def test_points_far_from_zero_lose_no_digits(data):
    far = points_of(data.depths, data.camera)[data.depths > 0] + [512345.0, 5403210.0, 431.0]
    numpy.save(data.folder / "far.npy", far)
    expected = program(data, "far.npy", "--viewpoint", "512345,5403210,431")
    assert expected["detections"] and expected["offset"]
    assert_same(recognize_points(data.library, far, (512345, 5403210, 431)), expected, data.library)


def test_options_are_those_of_the_program(data):
    options = {"min-score": "0.95", "preset": "fast", "method": "ppf", "models": "bracket_0,hex_nut_0"}
    flags = [f"--{name}={value}" for name, value in options.items() if name != "models"]
    pairs = [f"{name}={value}" for name, value in options.items() if name != "models"]
    expected = program(data, "scans/manifest.json", *flags)
    assert_same(recognize_depth(data.library, data.depths, data.camera, pairs), expected,
                data.library)
    detections, _ = recognize_depth(data.library, data.depths, data.camera, ["models=bracket_0"])
    assert {LIB.trivet_model_name(data.library, d.model) for d, _ in detections} <= {b"bracket_0"}
    for wrong, text in ((["min-score=2"], "min-score"), (["min-score"], "min-score"),
                        (["no-such=1"], "'no-such'"), (["=1"], "''"), ([""], "''"),
                        (["rounds=1", "rounds=2"], "twice"), (["preset=slow"], "preset"),
                        (["models=nothing"], "nothing")):
        with pytest.raises(Failure, match=text) as failure:
            recognize_depth(data.library, data.depths, data.camera, wrong)
        assert failure.value.status == USAGE


def test_four_threads_with_one_library_find_the_same(data):
    found, faults = [None] * 4, []

    def work(thread):
        try:
            for _ in range(2):
                found[thread] = recognize_depth(data.library, data.depths, data.camera)
        except Exception as fault:  # reported below, since threads lose their exceptions
            faults.append(fault)

    threads = [threading.Thread(target=work, args=(t,)) for t in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults
    for each in found:
        assert_same(each, data.scene, data.library)


def test_results_outlive_their_library(data):
    library, result = open_library(data.file), c_void_p()
    height, width = data.depths.shape
    assert LIB.trivet_recognize_depth(library, data.depths.ctypes.data, UINT16, width, height, width,
                                      byref(Camera(**data.camera)), 0, None, None, byref(result),
                                      None) == OK
    LIB.trivet_close(library)
    detection = Detection()
    assert LIB.trivet_get_detection(result, 0, byref(detection)) == OK
    assert list(detection.pose) == sum(data.scene["detections"][0]["T_scene_model"], [])
    LIB.trivet_free_result(result)


def test_errors_have_the_exit_codes_of_the_program(data):
    (data.folder / "broken.h5").write_bytes(b"no library")
    for file, status in (("missing.h5", MISSING_INPUT), ("broken.h5", BAD_DATA)):
        done = subprocess.run([PROGRAM, "library", "list", file], cwd=data.folder, capture_output=True)
        assert done.returncode == status
        with pytest.raises(Failure, match=file) as failure:
            open_library(data.folder / file)
        assert failure.value.status == status
    with pytest.raises(Failure, match="missing.json") as failure:
        open_library(data.file, b"missing.json")
    assert failure.value.status == MISSING_INPUT
    with pytest.raises(Failure) as failure:
        open_library("x" * 5000)
    assert len(str(failure.value)) == 1019, "as much as fits"
    with pytest.raises(Failure) as failure:
        open_library("x" * 1018 + "\u00e9" * 100)
    assert len(str(failure.value)) == 1018, "no half of a character"


def test_what_cannot_be_recognized_is_refused(data):
    def refused(status, text, call):
        with pytest.raises(Failure, match=text) as failure:
            call()
        assert failure.value.status == status

    points = lambda xyz: lambda: recognize_points(data.library, xyz)
    refused(BAD_DATA, "found none", points(numpy.ones((1, 3), "f4")[:0]))
    refused(BAD_DATA, "none is finite", points(numpy.full((9, 3), numpy.nan, "f4")))
    refused(BAD_DATA, "1e\\+07", points(numpy.eye(3, dtype="f4") * numpy.float32(1e30)))
    refused(BAD_DATA, "about as large as the models", points(numpy.random.rand(99, 3) * 1e6))
    refused(USAGE, "16 bits", points(numpy.zeros((9, 3), "u2")))
    refused(USAGE, "viewpoint",
            lambda: recognize_points(data.library, numpy.random.rand(99, 3), (numpy.nan, 0, 0)))
    depths = lambda camera, image=data.depths: lambda: recognize_depth(data.library, image, camera)
    refused(BAD_DATA, "above zero", depths(dict(data.camera, fx=0.0)))
    refused(BAD_DATA, "finite", depths(dict(data.camera, cx=numpy.nan)))
    refused(BAD_DATA, "negate", depths(data.camera, -data.depths.astype("f4")))
    refused(BAD_DATA, "pixels", depths(data.camera, data.depths[:0]))
    nothing, _ = recognize_depth(data.library, numpy.zeros_like(data.depths), data.camera)
    assert nothing == [], "the sensor measured nothing"


def test_sizes_that_cannot_be_are_refused_before_anything_is_read(data):
    huge = 2**64 - 1
    few = numpy.zeros(12, "f4")
    camera = byref(Camera(**data.camera))
    for width, height, stride, status in (
            (4, 1, 2, USAGE), (huge, 1, 3, USAGE), (huge, huge, huge, USAGE), (4, 1, huge, USAGE),
            (2**31, 2**31, 3, USAGE), (2**33, 1, 3, BAD_DATA), (4, huge, 3, USAGE),
            (0, 1, 3, BAD_DATA), (1, 0, 3, BAD_DATA)):
        result, error = c_void_p(1), Error()
        assert LIB.trivet_recognize_points(data.library, few.ctypes.data, FLOAT32, width, height,
                                           stride, None, 0, None, None, byref(result),
                                           byref(error)) == status, (width, height, stride)
        assert not result and error.message and error.status == status
    for width, height, stride, status in (
            (4, 3, 3, USAGE), (huge, 3, huge, USAGE), (4, huge, 4, USAGE), (4, 3, huge, USAGE),
            (2**31, 2**16, 2**31, BAD_DATA), (0, 3, 0, BAD_DATA), (3, 0, 3, BAD_DATA)):
        assert LIB.trivet_recognize_depth(data.library, few.ctypes.data, FLOAT32, width, height,
                                          stride, camera, 0, None, None, byref(result),
                                          byref(error)) == status, (width, height, stride)
        assert not result and error.message


def test_null_pointers_and_unknown_numbers_are_refused(data):
    few, result, error = numpy.zeros((4, 3), "f4"), c_void_p(), Error()
    camera, out = byref(Camera(**data.camera)), byref(result)
    place = few.ctypes.data
    for call in (
            lambda: LIB.trivet_open(None, None, out, byref(error)),
            lambda: LIB.trivet_open(b"parts.h5", None, None, byref(error)),
            lambda: LIB.trivet_recognize_points(None, place, 0, 4, 1, 3, None, 0, None, None, out,
                                                byref(error)),
            lambda: LIB.trivet_recognize_points(data.library, None, 0, 4, 1, 3, None, 0, None, None,
                                                out, byref(error)),
            lambda: LIB.trivet_recognize_points(data.library, place, 7, 4, 1, 3, None, 0, None, None,
                                                out, byref(error)),
            lambda: LIB.trivet_recognize_points(data.library, place, 0, 4, 1, 3, None, 7, None, None,
                                                out, byref(error)),
            lambda: LIB.trivet_recognize_points(data.library, place + 1, 0, 3, 1, 3, None, 0, None,
                                                None, out, byref(error)),
            lambda: LIB.trivet_recognize_points(data.library, place, 0, 4, 1, 3, None, 0, None, None,
                                                None, byref(error)),
            lambda: LIB.trivet_recognize_depth(data.library, None, 0, 4, 3, 4, camera, 0, None, None,
                                               out, byref(error)),
            lambda: LIB.trivet_recognize_depth(data.library, place, 0, 4, 3, 4, None, 0, None, None,
                                               out, byref(error))):
        error.message = b""
        assert call() == USAGE and error.message and error.status == USAGE and not result
    assert LIB.trivet_open(None, None, out, None) == USAGE, "no place for the error"
    assert LIB.trivet_num_models(None) == 0 and LIB.trivet_model_name(None, 0) is None
    assert LIB.trivet_library_unit(None) == UNIT_OF_LIBRARY
    assert LIB.trivet_num_detections(None) == 0
    assert LIB.trivet_get_detection(None, 0, byref(Detection())) == USAGE
    assert LIB.trivet_get_alternative(None, 0, 0, (c_double * 16)()) == USAGE
    assert LIB.trivet_get_scene(None, byref(Scene())) == USAGE
    for free in (LIB.trivet_close, LIB.trivet_free_result, LIB.trivet_free_stopper, LIB.trivet_stop):
        free(None)


def test_a_stopper_ends_calls(data):
    stopper = LIB.trivet_new_stopper()
    assert_same(recognize_depth(data.library, data.depths, data.camera, stopper=stopper), data.scene,
                data.library)
    LIB.trivet_stop(stopper)
    with pytest.raises(Failure) as failure:
        recognize_depth(data.library, data.depths, data.camera, stopper=stopper)
    assert failure.value.status == STOPPED
    LIB.trivet_free_stopper(stopper)
