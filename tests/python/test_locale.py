"""Numbers and words do not depend on the locale of the process: commands, the service, the C interface
and Python answer as in the C locale.

TRIVET_PROGRAM, TRIVET_C_LIBRARY and PYTHONPATH name what is tested, TRIVET_OTHER_LOCALE the library that
puts a program into a locale.
"""
import http.client
import json
import locale
import os
import re
import subprocess
from contextlib import contextmanager
from pathlib import Path

import numpy
import pytest

import test_ctypes
from test_ctypes import data  # noqa: F401, a fixture

SOURCES = Path("/usr/share/i18n/locales")
# A comma; a decimal mark of two bytes; capitals whose small letters are others.
NAMES = ("de_DE", "ps_AF", "tr_TR")


@pytest.fixture(scope="module")
def locales(tmp_path_factory):
    """The folder that LOCPATH names."""
    if not all((SOURCES / name).exists() for name in NAMES):
        pytest.skip("Debian's package locales is not installed")
    folder = tmp_path_factory.mktemp("locales")
    for name in NAMES:  # its exit code also reports warnings
        subprocess.run(["localedef", "--quiet", "-c", "-i", name, "-f", "UTF-8",
                        folder / f"{name}.UTF-8"], check=False, capture_output=True)
    return folder


@contextmanager
def in_locale(folder, name):
    os.environ["LOCPATH"] = str(folder)
    try:
        locale.setlocale(locale.LC_ALL, f"{name}.UTF-8")
        assert name == "tr_TR" or f"{1.5:n}" != "1.5"
        yield
    finally:
        locale.setlocale(locale.LC_ALL, "C")
        del os.environ["LOCPATH"]


def environment(folder, name):
    if name is None:
        return os.environ
    return {**os.environ, "LOCPATH": str(folder), "OTHER_LOCALE": f"{name}.UTF-8",
            "LD_PRELOAD": os.environ["TRIVET_OTHER_LOCALE"]}


def without_times(thing):
    """The output of a run without its times."""
    if isinstance(thing, dict):
        return {key: without_times(value) for key, value in thing.items()
                if "seconds" not in key and key not in ("stages", "peak_bytes", "request_id")}
    return [without_times(one) for one in thing] if isinstance(thing, list) else thing


def comparable(output):
    """The values of JSON; of text, which contains times everywhere, the form of its numbers."""
    text = output.decode()
    if text.startswith("{"):
        return without_times(json.loads(text))
    return re.sub(r"\d+", "9", re.sub(r" +", " ", text))


def run_all(folder, locales, name, commands):
    """The output of each command, and the files that it writes."""
    answers = {}
    folder.mkdir()
    for words in commands:
        done = subprocess.run([os.environ["TRIVET_PROGRAM"], "--quiet", *words.split()], cwd=folder,
                              env=environment(locales, name), capture_output=True, check=False)
        assert done.returncode == 0, (words, done.stderr.decode())
        answers[words] = comparable(done.stdout), comparable(done.stderr)
    for file in sorted(folder.rglob("*")):
        if not file.is_file():
            continue
        content = file.read_bytes()
        is_text = file.suffix in (".json", ".html", ".csv", ".txt")
        answers[str(file.relative_to(folder))] = comparable(content) if is_text else content
    return answers


COMMANDS = [
    "scan --parts 2 --scenes 1 --instances 2 --unit mm --noise 0.35 -o scans",
    "train scans/manifest.json -o parts.h5 --relative-step 0.055 --preset fast --json trained.json",
    "recognize parts.h5 scans/manifest.json --json - --min-score 0.4 --preset fast",
    "recognize parts.h5 scans/manifest.json --radius 0.45 --robot-csv poses.csv --robot kuka "
    "--region=-1000.5,-1000.5,0.5,1000.5,1000.5,2000.5 --report page",
    "evaluate parts.h5 scans/manifest.json --json evaluated.json --csv evaluated.csv --report judged",
    "compare evaluated.json evaluated.json --max-translation 1.5 --max-rotation 2.5",
    "library list parts.h5",
    "library info parts.h5 --json info.json",
    "library export parts.h5 -o meshes",
    "mesh scans/test/000001/depth/000000.png --camera scans/camera.json -o mesh.ply --max-jump 4.5",
]


@pytest.fixture(scope="module")
def plain_answers(tmp_path_factory, locales):
    return run_all(tmp_path_factory.mktemp("commands") / "plain", locales, None, COMMANDS)


@pytest.mark.parametrize("name", NAMES)
def test_commands_answer_alike(tmp_path, locales, plain_answers, name):
    commands = COMMANDS if name == "de_DE" else COMMANDS[:3]
    other = run_all(tmp_path / "other", locales, name, commands)
    for what, answer in other.items():
        assert plain_answers[what] == answer, what
    assert len(other) == len(plain_answers) or name != "de_DE"


def ask_service(locales, name, data):
    """The answer to a scene that came with an option and a deadline in fractions."""
    with subprocess.Popen([os.environ["TRIVET_PROGRAM"], "serve", data.file, "--port", "0",
                           "--drain-grace-ms", "0", "--log", "none"], stderr=subprocess.PIPE,
                          env=environment(locales, name)) as service:
        try:
            line = service.stderr.readline().decode()
            connection = http.client.HTTPConnection(line.strip().rpartition("/")[2], timeout=60)
            camera = ",".join(str(data.camera[key])
                              for key in ("fx", "fy", "cx", "cy", "depth_scale"))
            scene = next((data.folder / "scans").rglob("depth/000000.png"))
            connection.request(
                "POST", f"/v1/recognize?format=png&unit=mm&camera={camera}&min-score=0.45",
                scene.read_bytes(), {"X-Deadline-Ms": "59000.5", "Accept-Encoding": "gzip;q=0.0"})
            response = connection.getresponse()
            answer = without_times(json.loads(response.read()))
            assert response.getheader("Content-Encoding") is None
            connection.request("GET", "/metrics")
            metrics = connection.getresponse().read().decode()
            assert re.search(r"^process_start_time_seconds \d+\.?\d*(e[+]\d+)?$", metrics, re.M)
            return response.status, answer
        finally:
            service.terminate()
            service.wait()


def test_the_service_answers_alike(locales, data):  # noqa: F811
    status, answer = ask_service(locales, None, data)
    assert status == 200, answer
    for name in NAMES:
        assert ask_service(locales, name, data) == (status, answer), name


OPTIONS = ["min-score=0.45", "radius=0.45", "budget=30.5", "preset=fast",
           "region=-1000.5,-1000.5,0.5,1000.5,1000.5,2000.5"]


def plain_detections(found):
    return [(bytes(detection), alternatives) for detection, alternatives in found[0]]


def test_the_c_interface_answers_alike(locales, data):  # noqa: F811
    def found():
        library = test_ctypes.open_library(data.file)
        try:
            return plain_detections(
                test_ctypes.recognize_depth(library, data.depths, data.camera, OPTIONS))
        finally:
            test_ctypes.LIB.trivet_close(library)
    plain = found()
    assert plain
    for name in NAMES:
        with in_locale(locales, name):
            assert found() == plain, name


def test_python_answers_alike(locales, data):  # noqa: F811
    trivet = pytest.importorskip("trivet")

    def found():
        library = trivet.Library(data.file)
        scene = trivet.Scene.from_depth(data.depths, [data.camera[key] for key in
                                                      ("fx", "fy", "cx", "cy")],
                                        depth_scale=data.camera["depth_scale"])
        result = library.recognize(scene, min_score=0.45, radius=0.45)
        return without_times(result.to_dict()), library.parameters
    plain = found()
    assert plain[0]["detections"]
    assert numpy.isfinite(plain[1]["relative-step"])
    for name in NAMES:
        with in_locale(locales, name):
            assert found() == plain, name
