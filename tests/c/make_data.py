"""Make what the tests of the C interface recognize: a library, a scene, and what trivet finds in it.

usage: make_data.py TRIVET FOLDER
"""
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import zlib

import numpy


def depths_of(png):
    """The depths of a 16-bit gray PNG that is not interlaced, by its specification."""
    data, at, packed = png.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert (bits, color, interlaced) == (16, 0, 0)
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 2 * width)
    above = numpy.zeros(2 * width, int)
    out = numpy.empty((height, 2 * width), numpy.uint8)
    for v, (kind, row) in enumerate(zip(rows[:, 0], rows[:, 1:].astype(int))):
        row = row.copy()
        if kind == 2:
            row = (row + above) % 256
        elif kind != 0:
            for i in range(len(row)):
                left, upper_left = (row[i - 2], above[i - 2]) if i >= 2 else (0, 0)
                if kind == 1:
                    row[i] += left
                elif kind == 3:
                    row[i] += (left + above[i]) // 2
                else:
                    guess = left + above[i] - upper_left
                    row[i] += min((left, above[i], upper_left), key=lambda value: abs(guess - value))
                row[i] %= 256
        out[v] = above = row
    return out.view(">u2").astype(numpy.uint16)


def make(trivet, folder):
    """Fill the folder, and give the depths, the camera and what `recognize --json` says of them."""
    folder = pathlib.Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    def run(*arguments):
        subprocess.run([trivet, "--quiet", *map(str, arguments)], cwd=folder, check=True)

    run("scan", "--parts", 3, "--scenes", 1, "--instances", 4, "--unit", "mm", "-o", "scans")
    run("train", "scans/manifest.json", "-o", "parts.h5")
    run("recognize", "parts.h5", "scans/manifest.json", "--json", "found.json")
    scene = json.loads((folder / "found.json").read_text())["scenes"][0]
    assert len(scene["detections"]) >= 3
    camera = scene["camera_check"]["camera"]
    depths = depths_of(folder / scene["scene"])
    depths.tofile(folder / "depths.u16")
    height, width = depths.shape
    numbers = [width, height, *(camera[name] for name in ("fx", "fy", "cx", "cy", "depth_scale"))]
    (folder / "image.txt").write_text(" ".join(map(repr, numbers)) + "\n")
    # What C reads without a parser of JSON: a row a detection, the model's name and 16 numbers.
    rows = [[d["model"], *(repr(x) for row in d["T_scene_model"] for x in row)]
            for d in scene["detections"]]
    (folder / "found.txt").write_text("".join(" ".join(row) + "\n" for row in rows))
    return depths, camera, scene


if __name__ == "__main__":
    make(*sys.argv[1:])
