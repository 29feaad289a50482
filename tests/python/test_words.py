"""Names and texts from outside: any bytes give valid answers and control no terminal, and a typing error is
reported with a suggestion; a check of settings reports what a start would; a full disk is reported as such."""
import http.client
import json
import os
import resource
import signal
import subprocess
from contextlib import contextmanager

import pytest

PROGRAM = os.environ["TRIVET_PROGRAM"]
LATIN = b"Geh\xe4use.ply"
EVIL = b"\x1b]0;owned\x07\x1b[2J\xc2\x9b31m.ply"


def run(*words, cwd):
    return subprocess.run([PROGRAM, *words], cwd=cwd, capture_output=True, check=False)


@pytest.fixture()
def scans(library, outside, tmp_path):
    """A folder of three scans: one name is Latin-1, one would clear a terminal; the library is l.h5."""
    folder = tmp_path / "scans"
    folder.mkdir()
    (tmp_path / "l.h5").write_bytes(library.read_bytes())
    scan = (outside.parent / "scan.ply").read_bytes()
    for name in (b"a.ply", LATIN, EVIL):
        with open(os.path.join(os.fsencode(folder), name), "wb") as file:
            file.write(scan)
    return tmp_path


def is_quiet(text):
    """Whether it does nothing to a terminal, and is UTF-8."""
    return all(c in "\n\t" or c.isprintable() or c == "\N{REPLACEMENT CHARACTER}"
               for c in text.decode("utf-8"))


def test_results_of_names_that_are_no_utf8_are_complete(scans):
    done = run("recognize", "l.h5", "scans", "--json", "-", "--report", "page", "--robot-csv", "p.csv",
               cwd=scans)
    assert done.returncode == 0, done.stderr
    names = sorted(scene["scene"] for scene in json.loads(done.stdout)["scenes"])
    assert len(names) == 3
    assert any(name.endswith("Geh\N{REPLACEMENT CHARACTER}use.ply") for name in names)
    assert is_quiet(done.stdout) and is_quiet(done.stderr)
    for file in ("page/index.html", "p.csv"):
        assert "use.ply" in (scans / file).read_text(encoding="utf-8")
    for line in run("recognize", "l.h5", "scans", "--progress", "json", cwd=scans).stderr.splitlines():
        assert json.loads(line)["stage"]


def test_no_name_acts_on_a_terminal(scans):
    done = run("recognize", "l.h5", "scans", cwd=scans)
    assert done.returncode == 0 and is_quiet(done.stdout) and is_quiet(done.stderr)
    assert rb"\u001B]0;owned\u0007\u001B[2J\u009B31m.ply" in done.stdout
    for words in (["recognize", "l.h5", EVIL + b".stl"], ["recognize", EVIL, "scans"],
                  [b"--" + EVIL], [EVIL], ["recognize", "l.h5", "scans", b"--min-score=" + EVIL],
                  ["library", "rename", "l.h5", EVIL, "x"]):
        refused = run(*words, cwd=scans)
        assert refused.returncode not in (0, 70) and is_quiet(refused.stderr), refused.stderr


@contextmanager
def service(*words, cwd, limit=None):
    def begin():
        if limit:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    with subprocess.Popen([PROGRAM, "serve", "l.h5", *words, "--port", "0", "--drain-grace-ms", "0",
                           "--log", "none"], cwd=cwd, stderr=subprocess.PIPE,
                          preexec_fn=begin) as process:
        try:
            for line in process.stderr:  # warnings may come first
                if line.startswith(b"serving"):
                    break
            yield line.decode().strip().rpartition("/")[2]
        finally:
            process.send_signal(signal.SIGTERM)
            process.communicate()


def ask(address, method, target, body=b""):
    connection = http.client.HTTPConnection(address, timeout=60)
    try:
        connection.request(method, target, body)
        response = connection.getresponse()
        return response.status, json.loads(response.read())
    finally:
        connection.close()


def test_targets_that_are_no_utf8_are_refused_by_name(scans):
    with service("--allow-training", "parts", "--session", "cell", cwd=scans) as address:
        for method, target in (("PUT", "/v1/parts/a?unit=mm&file=%ff.stl"),
                               ("PUT", "/v1/parts/%c3?unit=mm&file=a.stl"),
                               ("PUT", "/v1/session/scans/%ed%a0%80?format=ply"),
                               ("POST", "/v1/recognize?format=%ff"),
                               ("POST", "/v1/recognize?%ff=1"),
                               ("POST", "/v1/recognize?format=ply&explain=%c0%af"),
                               ("POST", "/v2/models/%ff/infer"),
                               ("GET", "/v1/models/%fe/mesh.ply"), ("GET", "/%ff")):
            status, answer = ask(address, method, target, b"x")
            assert (status, "expected UTF-8 in the target" in answer["error"]) == (400, True), target
        status, answer = ask(address, "POST", "/v1/recognize?format=ply&min_scor=0.5", b"x")
        assert status == 400 and "did you mean 'min-score'?" in answer["error"]
        status, answer = ask(address, "POST", "/v1/recognize?format=ply&unti=mm", b"x")
        assert status == 400 and "did you mean 'unit'?" in answer["error"]


CONFIGURATIONS = {
    "good": ([], None),
    "all of it": (["--session", "cell", "--watch", "scans", "--watch-query", "unit=mm",
                   "--allow-training", "parts"], None),
    "a file as session": (["--session", "file"], "file: expected an empty folder"),
    "no folder to watch": (["--watch", "nowhere"], "nowhere: expected a folder to watch"),
    "a parameter that is none": (["--watch", "scans", "--watch-query", "min-scor=1"],
                                 "did you mean 'min-score'?"),
    "a broken query": (["--watch", "scans", "--watch-query", "unit=%"], "watch-query 'unit=%'"),
    "a query for no folder": (["--watch-query", "unit=mm"], "watch-query: expected a folder"),
    "a file as workshop": (["--allow-training", "file"], "file: expected an empty folder"),
    "examples that are none": (["--examples", "file"], "file: no JSON"),
    "a calibration that is none": (["--calibration", "file"], "file: no JSON"),
    "an address elsewhere": (["--address", "192.0.2.1"], "192.0.2.1"),
    "a session that another service has": (["--session", "taken"], "taken/scans.json: being written"),
}


def test_a_check_of_settings_says_what_a_start_would(scans):
    (scans / "file").write_text("none of it")
    with service("--session", "taken", cwd=scans):
        for what, (words, fault) in CONFIGURATIONS.items():
            checked = run("serve", "l.h5", *words, "--port", "0", "--check-config", cwd=scans)
            if fault is None:
                assert checked.returncode == 0, (what, checked.stderr)
                assert checked.stderr.endswith(b"the configuration is good\n"), what
                with service(*words, cwd=scans) as address:
                    assert ask(address, "GET", "/v1/models")[0] == 200, what
                continue
            started = run("serve", "l.h5", *words, "--port", "0", cwd=scans)
            assert fault in checked.stderr.decode(), (what, checked.stderr)
            assert checked.stderr == started.stderr, what
            assert checked.returncode == started.returncode != 0, what
        everything = run("serve", "l.h5", "--session", "file", "--watch", "nowhere", "--examples",
                         "file", "--allow-training", "file", "--check-config", cwd=scans).stderr
        assert everything.count(b"error: ") == 4, everything
    (scans / "l.h5").write_bytes(b"no library")
    everything = run("serve", "l.h5", "--watch", "nowhere", "--check-config", cwd=scans).stderr
    assert everything.count(b"error: ") == 2, everything


def test_a_full_disk_is_reported_as_507(scans):
    scan = (scans / "scans/a.ply").read_bytes()
    with service("--allow-training", "parts", "--session", "cell", cwd=scans,
                 limit=len(scan) - 1) as address:
        for target in ("/v1/session/scans/a?format=ply", "/v1/parts/a?unit=mm&file=a.ply"):
            status, answer = ask(address, "PUT", target, scan)
            assert status == 507 and "File too large" in answer["error"], (status, answer)
        assert ask(address, "GET", "/v1/models")[0] == 200


def test_typing_errors_are_reported_with_a_suggestion(scans):
    (scans / "serve.toml").write_text("prot = 8081\n")
    (scans / "study.toml").write_text("tilte = 'x'\n")
    (scans / "manifest.json").write_text('{"unit": "mm", "scens": []}')
    for words, meant in ((["recognize", "l.h5", "scans", "--min-scor", "0.5"], "--min-score?"),
                         (["recognice", "l.h5", "scans"], "did you mean recognize?"),
                         (["serve", "l.h5", "--config", "serve.toml", "--check-config"],
                          "serve.toml:1: found 'prot'; did you mean 'port'?"),
                         (["study", "study.toml", "-o", "out"], "found 'tilte'; did you mean"),
                         (["recognize", "l.h5", "manifest.json"],
                          "found 'scens'; did you mean 'scenes'?")):
        refused = run(*words, cwd=scans)
        assert refused.returncode in (2, 65) and meant in refused.stderr.decode(), refused.stderr


def test_python_accepts_files_of_any_name(scans):
    trivet = pytest.importorskip("trivet")
    file = os.path.join(scans, "scans", os.fsdecode(LATIN))
    scene = trivet.Scene.read(file, unit="mm")
    assert scene.name == file
    found = trivet.Library(scans / "l.h5").recognize(scene)
    assert found.name == file
    assert found.to_dict()["scene"].endswith("Geh\N{REPLACEMENT CHARACTER}use.ply")
    with pytest.raises(trivet.MissingInputError, match="Geh\N{REPLACEMENT CHARACTER}use.ply"):
        trivet.Scene.read(file.replace("scans", "none", 1))
