#!/usr/bin/env python3
"""Make a model without Trivet, and add it to a library. Needs h5py, numpy and xxhash.

usage: add_model.py OUT.h5 [--to LIBRARY.h5] [--scene SCAN.ply]
then:  trivet library import OUT.h5 -o GROWN.h5
       trivet recognize GROWN.h5 SCAN.ply --unit mm
The model, `bracket_of_cubes`, is a solid made of cubes of 20 mm: as many a model as its arrays say.
"""
import argparse
import itertools

import h5py
import numpy as np
import xxhash

import point_pairs
from read_library import check_checksums, digest, text

NAME = "bracket_of_cubes"
EDGE = 20.0  # edge length of a cube [mm]
RELATIVE_STEP = 0.04  # width of a distance bin and distance of the table's points [diameter]
NUM_ANGLE_BINS = 15
NUM_SAMPLES_A_SIDE, NUM_POINTS_A_SIDE = 6, 4  # number along an edge of a cube
REFERENCE_SHARE = 4  # pairs start at every so many of the points
NUM_VIEWS = 256


def bracket() -> np.ndarray:
    """Which cubes [5, 3, 4] are solid: a base, a wall and a lug, so that no turn gives it back."""
    solid = np.zeros((5, 3, 4), dtype=bool)
    solid[:, :, 0] = True
    solid[:3, 0, :] = True
    solid[4, 2, 1] = True
    return solid


def faces(solid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The faces of cubes that lie open: corners [n, 4, 3] [mm], counterclockwise from outside,
    and outward normals [n, 3]."""
    padded = np.pad(solid, 1)
    corners, normals = [], []
    for axis, sign in itertools.product(range(3), (1, -1)):
        beside = np.roll(padded, -sign, axis)[1:-1, 1:-1, 1:-1]
        square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]][::sign])
        face = np.insert(square, 0, (sign + 1) // 2, axis=1)  # (axis, next, next but one)
        at = np.argwhere(solid & ~beside)
        corners.append(EDGE * (at[:, None] + np.roll(face, axis, axis=1)))
        normals.append(np.tile(sign * np.eye(3)[axis], (len(at), 1)))
    return np.concatenate(corners), np.concatenate(normals)


def on_faces(corners: np.ndarray, n: int) -> np.ndarray:
    """Points [faces * n * n, 3], n x n of a face."""
    a, b = np.meshgrid(*[(np.arange(n) + 0.5) / n] * 2)
    a, b = a.ravel()[None, :, None], b.ravel()[None, :, None]
    first, along, across = corners[:, None, 0], corners[:, None, 1], corners[:, None, 3]
    return (first + a * (along - first) + b * (across - first)).reshape(-1, 3)


def cast(solid: np.ndarray, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """How far [n] rays go until they enter a cube; infinity where they miss."""
    nearest = np.full(len(directions), np.inf)
    with np.errstate(divide="ignore"):
        inverse = 1 / directions
    for cube in np.argwhere(solid):
        low, high = (EDGE * cube - origins) * inverse, (EDGE * (cube + 1) - origins) * inverse
        enter = np.minimum(low, high).max(axis=1)
        leave = np.maximum(low, high).min(axis=1)
        nearest = np.where((enter < leave) & (enter > 0) & (enter < nearest), enter, nearest)
    return nearest


def view_directions() -> np.ndarray:
    """Directions [256, 3] to cameras, as the bits of `sample_views` stand for."""
    d = np.arange(NUM_VIEWS)
    z = 1 - (2 * d + 1) / NUM_VIEWS
    radius, longitude = np.sqrt(1 - z * z), d * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(longitude), radius * np.sin(longitude), z], axis=1)


def views(solid: np.ndarray, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Which of the directions see each point: bits [n, 256]."""
    directions = view_directions()
    seen = normals @ directions.T > 0.05
    point, view = np.nonzero(seen)
    start = points[point] + 1e-3 * EDGE * normals[point]
    seen[point, view] = np.isinf(cast(solid, start, directions[view]))
    return seen


def pair_table(points: np.ndarray, normals: np.ndarray, seen: np.ndarray, num_references: int,
               q: point_pairs.Quantization) -> tuple[np.ndarray, np.ndarray]:
    """Offsets [cells + 1] and entries [pairs, 2] of the pairs that some direction sees."""
    frames = point_pairs.frames(normals[:num_references])
    rows = []
    for r in range(num_references):
        d = points - points[r]
        cell = point_pairs.cells(q, normals[r], d, normals)
        kept = (cell >= 0) & (seen & seen[r]).any(axis=1)
        turn = point_pairs.turns(frames[r], d[kept])
        rows.append(np.stack([cell[kept], np.full(kept.sum(), r), turn], axis=1))
    table = np.concatenate(rows)
    table = table[np.lexsort(table.T[::-1])]  # sorted by cell, then reference, then turn
    offsets = np.searchsorted(table[:, 0], np.arange(q.num_cells + 1))
    return offsets.astype(np.uint32), table[:, 1:].astype(np.uint16)


def make_model(solid: np.ndarray, scale: float) -> tuple[dict, dict]:
    """Attributes and datasets of a model as docs/format.md names them.

    scale  from mm to the library's unit
    """
    corners, face_normals = faces(solid)
    vertices, at = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    at = at.reshape(-1, 4)
    triangles = np.concatenate([at[:, [0, 1, 2]], at[:, [0, 2, 3]]])
    diameter = np.linalg.norm(vertices[:, None] - vertices, axis=2).max()
    samples = on_faces(corners, NUM_SAMPLES_A_SIDE)
    sample_normals = np.repeat(face_normals, NUM_SAMPLES_A_SIDE**2, axis=0)
    seen = views(solid, samples, sample_normals)
    visible = seen.any(axis=1)
    samples, sample_normals, seen = samples[visible], sample_normals[visible], seen[visible]
    points = on_faces(corners, NUM_POINTS_A_SIDE)
    normals = np.repeat(face_normals, NUM_POINTS_A_SIDE**2, axis=0)
    order = np.argsort(np.arange(len(points)) % REFERENCE_SHARE != 0, kind="stable")
    points, normals = points[order], normals[order]  # the references first
    num_references = -(-len(points) // REFERENCE_SHARE)
    q = point_pairs.Quantization(RELATIVE_STEP * diameter, int(np.ceil(1 / RELATIVE_STEP)),
                                 NUM_ANGLE_BINS)
    offsets, entries = pair_table(points, normals, views(solid, points, normals),
                                  num_references, q)

    f4, zeros = np.float32, np.zeros(3, np.float32)
    attributes = {
        "": {"source": b"", "source_xxh3": b"", "fingerprint": b"",
             "diameter": f4(scale * diameter), "centre": f4(scale * samples.mean(axis=0)),
             "sample_spacing": f4(scale * EDGE / NUM_SAMPLES_A_SIDE),
             "symmetry_axis_direction": zeros, "symmetry_axis_point": zeros,
             "symmetry_declared": np.uint8(1)},
        "ppf": {"distance_step": f4(scale * q.distance_step),
                "num_distance_bins": np.uint32(q.num_distance_bins),
                "num_angle_bins": np.uint32(q.num_angle_bins),
                "num_references": np.uint32(num_references)}}
    datasets = {
        "vertices": f4(scale * vertices.T), "triangles": np.uint32(triangles.T),
        "samples": f4(scale * samples.T), "sample_normals": f4(sample_normals.T),
        "sample_views": np.packbits(seen, axis=1, bitorder="little").view("<u8"),
        "symmetry_poses": np.zeros((0, 4, 4), f4), "near_symmetries": np.zeros((0, 4, 4), f4),
        "near_axis": np.zeros((0, 2, 3), f4),
        "ppf/points": f4(scale * points.T), "ppf/normals": f4(normals.T),
        "ppf/offsets": offsets, "ppf/entries": entries}
    return attributes, datasets


def set_attributes(found: h5py.Group, values: dict) -> None:
    for name, value in values.items():
        if isinstance(value, bytes):  # strings have a fixed length, the empty one is a single NUL
            found.attrs.create(name, np.bytes_(value), dtype=f"S{max(1, len(value))}")
        else:
            found.attrs[name] = value


def write_dataset(group: h5py.Group, name: str, data: np.ndarray) -> None:
    data = np.ascontiguousarray(data)
    written = group.create_dataset(name, data=data)
    set_attributes(written, {"xxh3_128": xxhash.xxh3_128_hexdigest(data.tobytes()).encode()})


def write_library(path: str, solid: np.ndarray, base: str | None) -> None:
    """Write a library of the new model, and of those of another library if there is one.

    The directory and the index are left out: `trivet library import` makes them.
    """
    with h5py.File(path, "w", libver="latest") as out:
        root = {"format": b"trivet-library", "format_version_major": np.uint32(1),
                "format_version_minor": np.uint32(5), "producer": b"add_model.py",
                "length_unit": b"mm", "parameters": b"{}", "axis_convention":
                b"models keep the axes of their source; scenes: x right, y down, z forward"}
        models = out.create_group("models")
        if base:
            with h5py.File(base) as file:
                check_checksums(file)
                root |= {name: text(file, name).encode() for name in ("length_unit", "parameters")}
                for name in file["models"]:
                    file.copy(f"models/{name}", models)
                if "trisi" in file:
                    file.copy("trisi", out)
        attributes, datasets = make_model(solid, 1 if root["length_unit"] == b"mm" else 1e-3)
        if "trisi" in out:  # then every model has its groups; this one has no features in them
            for scale in ("trisi", "trisi_2x", "trisi_4x"):
                attributes[scale] = {"resolution": np.float32(0)}
                datasets[f"{scale}/keypoints"] = np.zeros((3, 0), np.float32)
                datasets[f"{scale}/frames"] = np.zeros((0, 3, 3), np.float32)
                datasets[f"{scale}/features"] = np.zeros((0, len(out["trisi/energies"])), np.uint8)
        model = models.create_group(NAME)
        for name, data in datasets.items():
            write_dataset(model, name, data)
        for name, values in attributes.items():
            set_attributes(model[name] if name else model, values)
        set_attributes(out, root | {"num_models": np.uint32(len(models))})
        set_attributes(out, {"checksum": digest(out).encode()})


def write_scan(path: str, solid: np.ndarray) -> np.ndarray:
    """Write what a camera sees of the model on a table, as a PLY file [mm].

    Returns T_scene_model [4, 4]. 320 x 240 pixels, noise of 0.2 mm along the rays.
    """
    looking = np.array([[-0.6, 0.8, 0], [0.48, 0.36, -0.8], [-0.64, -0.48, -0.6]])  # rows x, y, z
    camera = np.array([50, 30, 30]) - 500 * looking[2]  # position in the model's frame
    v, u = np.divmod(np.arange(320 * 240), 320)
    rays = np.stack([(u - 159.5) / 450, (v - 119.5) / 450, np.ones(len(u))], axis=1)
    origins, directions = np.broadcast_to(camera, rays.shape), rays @ looking
    table = -camera[2] / directions[:, 2]
    depth = np.minimum(cast(solid, origins, directions), np.where(table > 0, table, np.inf))
    depth += np.random.default_rng(1).normal(0, 0.2, len(depth))
    points = (depth[:, None] * rays)[depth < 1500]
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
                   b"property float x\nproperty float y\nproperty float z\nend_header\n"
                   % len(points) + points.astype("<f4").tobytes())
    T_scene_model = np.eye(4)
    T_scene_model[:3, :3], T_scene_model[:3, 3] = looking, -looking @ camera
    return T_scene_model


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--to", metavar="LIBRARY.h5", help="whose models come in, too")
    parser.add_argument("--scene", metavar="SCAN.ply", help="write a scan of the model [mm]")
    arguments = parser.parse_args()
    solid = bracket()
    write_library(arguments.out, solid, arguments.to)
    if arguments.scene:
        pose = write_scan(arguments.scene, solid)
        print("T_scene_model [mm]:", np.array2string(pose, precision=4, suppress_small=True),
              sep="\n")


if __name__ == "__main__":
    main()
