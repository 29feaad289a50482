"""Fixtures that the tests of examples/ share. TRIVET_PROGRAM names the program, TRIVET_DATA real scans."""
import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest
import xxhash

EXAMPLES = Path(__file__).parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES))

import add_model  # noqa: E402
import read_library  # noqa: E402


def run(*words) -> subprocess.CompletedProcess:
    command = [str(word) for word in words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def run_example(name: str, *words) -> subprocess.CompletedProcess:
    return run(sys.executable, EXAMPLES / name, *words)


@pytest.fixture(scope="session")
def trivet():
    """Run the program; what it prints, or the test fails with what it says."""
    program = os.environ.get("TRIVET_PROGRAM")
    if not program:
        pytest.skip("TRIVET_PROGRAM is not set")

    def call(*words, exit_code=0) -> str:
        outcome = run(program, "--quiet", *words)
        assert outcome.returncode == exit_code, outcome.stderr
        return outcome.stderr if exit_code else outcome.stdout
    return call


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real scans."""
    folder = Path(os.environ.get("TRIVET_DATA", ""))
    if not (folder / "uwa").is_dir():
        pytest.skip("TRIVET_DATA is not set")
    return folder


def write_mesh(path: Path, solid: np.ndarray) -> None:
    """Write the open faces of cubes as an OBJ file [mm]."""
    corners = add_model.faces(solid)[0].reshape(-1, 3)
    with open(path, "w", encoding="utf-8") as file:
        for corner in corners:
            file.write("v {} {} {}\n".format(*corner))
        for i in range(1, len(corners), 4):
            file.write(f"f {i} {i + 1} {i + 2} {i + 3}\n")


@pytest.fixture(scope="session")
def library(trivet, tmp_path_factory) -> Path:
    """Trained from a brick, which three half turns map onto itself, and from a bracket."""
    folder = tmp_path_factory.mktemp("library")
    write_mesh(folder / "brick.obj", np.ones((3, 2, 1), dtype=bool))
    write_mesh(folder / "bracket.obj", add_model.bracket())
    trivet("train", folder / "brick.obj", folder / "bracket.obj", "--unit", "mm", "--samples", 512,
           "--relative-step", 0.06, "-o", folder / "parts.h5")
    return folder / "parts.h5"


@pytest.fixture(scope="session")
def outside(tmp_path_factory) -> Path:
    """A library that only add_model.py had to do with; beside it a scan, scan.ply."""
    folder = tmp_path_factory.mktemp("outside")
    add_model.write_library(str(folder / "outside.h5"), add_model.bracket(), None)
    add_model.write_scan(str(folder / "scan.ply"), add_model.bracket())
    return folder / "outside.h5"


def reseal(path: Path) -> None:
    """Set all checksums of a library right again, after an edit."""
    with h5py.File(path, "r+") as file:
        def seal(_, found):
            if isinstance(found, h5py.Dataset):
                found.attrs["xxh3_128"] = np.bytes_(xxhash.xxh3_128_hexdigest(found[()].tobytes()))
        file.visititems(seal)
        file.attrs["checksum"] = np.bytes_(read_library.digest(file))


def detections(trivet, path: Path, *words) -> dict[str, np.ndarray]:
    """Recognize by trivet: the poses [n, 4, 4] of each model, best first."""
    trivet("recognize", *words, "--json", path)
    poses: dict[str, list] = {}
    for found in json.loads(path.read_text(encoding="utf-8"))["scenes"][0]["detections"]:
        poses.setdefault(found["model"], []).append(found["T_scene_model"])
    return {name: np.array(of_model) for name, of_model in poses.items()}


def read_depth(path: Path) -> np.ndarray:
    """The numbers of a PNG file of one channel of 16 bits (PNG specification, section 9)."""
    content = path.read_bytes()
    at, packed = 8, b""
    while at < len(content):
        size, kind = int.from_bytes(content[at:at + 4], "big"), content[at + 4:at + 8]
        body = content[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height = (int.from_bytes(body[i:i + 4], "big") for i in (0, 4))
            assert body[8:10] == b"\x10\0" and body[12] == 0
        if kind == b"IDAT":
            packed += body
        at += 12 + size
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, -1)
    out = np.zeros((height + 1, 2 * width + 2), dtype=np.uint8)  # a border above and to the left
    for y, row in enumerate(rows, 1):
        if row[0] in (0, 2):
            out[y, 2:] = row[1:] + (out[y - 1, 2:] if row[0] == 2 else 0)
        elif row[0] == 1:
            out[y, 2:] = np.cumsum(row[1:].reshape(-1, 2), axis=0, dtype=np.uint8).ravel()
        else:
            for i in range(2, out.shape[1]):
                left, up, corner = int(out[y, i - 2]), int(out[y - 1, i]), int(out[y - 1, i - 2])
                nearest = min(left, up, corner, key=lambda value: abs(left + up - corner - value))
                guess = (left + up) // 2 if row[0] == 3 else nearest
                out[y, i] = (int(row[i - 1]) + guess) & 255
    return np.ascontiguousarray(out[1:, 2:]).view(">u2")
