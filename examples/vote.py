#!/usr/bin/env python3
"""Find a model of a library in a scan by plain voting. Needs h5py, numpy, scipy and xxhash.

usage: vote.py LIBRARY.h5 MODEL SCENE [--viewpoint X,Y,Z] [--json FILE]
The scene is a PLY file or an array [n, 3] (.npy), in the library's unit. Written from
docs/format.md and Drost et al., CVPR 2010, to be read; `trivet recognize` is faster and surer.
"""
import argparse
import json
import sys
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

import point_pairs
from read_library import LibraryError, Model, read_library

TURN_BINS = 30  # number of rotation bins of an accumulator
REFERENCE_SHARE = 3  # every so many sampled points of the scene vote; 5 in the paper
CLUSTER_DIAMETERS, CLUSTER_DEGREES = 0.1, 15.0
NUM_REFINED = 30  # clusters, those of most votes first
PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4",
             "uint": "u4", "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1",
             "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
             "float64": "f8"}


class Scene(NamedTuple):
    """A scan, thinned twice; normals point to the viewpoint."""
    points: np.ndarray  # [n, 3], a third of a distance step apart
    normals: np.ndarray  # [n, 3]
    sampled: np.ndarray  # rows of them that vote, about a distance step apart
    viewpoint: np.ndarray  # [3]


class Found(NamedTuple):
    T_scene_model: np.ndarray  # [4, 4]
    votes: int
    fit: float  # share of the samples turned to the viewpoint that lie on the scan


def read_scene(path: str) -> np.ndarray:
    """Points [n, 3] of a file; those that are not finite are left out."""
    if path.endswith(".npy"):
        points = np.load(path).astype(float)
    else:
        with open(path, "rb") as file:
            points = _read_ply(file)
    return points[np.isfinite(points).all(axis=1)]


def _read_ply(file) -> np.ndarray:
    if file.readline().strip() != b"ply":
        raise ValueError("expected a PLY file or a .npy file")
    storing, element, num_points, columns = "", "", 0, []
    while (words := file.readline().decode("latin-1").split()) != ["end_header"]:
        match words:
            case ["format", storing, _]:
                pass
            case ["element", element, count]:
                if element == "vertex":
                    num_points = int(count)
                elif not num_points:
                    raise ValueError("expected the vertices first")
            case ["property", kind, name] if element == "vertex":
                columns.append((name, "<" + PLY_TYPES[kind]))
            case ["property", "list", *_] if element == "vertex":
                raise ValueError("expected vertices without lists")
            case []:
                raise ValueError("expected end_header")
    if storing == "ascii":
        at = [[name for name, _ in columns].index(axis) for axis in "xyz"]
        rows = [file.readline().split() for _ in range(num_points)]
        points = np.array([[row[i] for i in at] for row in rows if row], dtype=float)
    elif storing == "binary_little_endian":
        size = np.dtype(columns).itemsize
        content = file.read(num_points * size)
        rows = np.frombuffer(content, columns, count=len(content) // size)
        points = np.stack([rows[axis] for axis in "xyz"], axis=1).astype(float)
    else:
        raise ValueError(f"expected ascii or binary_little_endian, found {storing}")
    if len(points) != num_points:
        raise ValueError(f"expected {num_points} vertices, found {len(points)}")
    return points


def thin(points: np.ndarray, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """The first point of each voxel, as rows; and the mean [m, 3] of all in it."""
    voxels = np.floor(points / edge).astype(np.int64)
    _, first, voxel = np.unique(voxels, axis=0, return_index=True, return_inverse=True)
    counts = np.bincount(voxel)
    means = np.stack([np.bincount(voxel, column) / counts for column in points.T], axis=1)
    return first, means


def off_planes(points: np.ndarray, normals: np.ndarray, step: float, num_least: int) -> np.ndarray:
    """Which points [n] are on no plane of so many points, tables and walls of bins.

    Source: Fischler, Bolles, CACM 1981, with planes of single oriented points.
    """
    off = np.ones(len(points), dtype=bool)
    random = np.random.default_rng(0)
    while True:
        rows = np.flatnonzero(off)
        planes = [(np.abs((points[rows] - points[i]) @ normals[i]) < step / 2)
                  & (normals[rows] @ normals[i] > 0.9)
                  for i in random.choice(rows, min(100, len(rows)), replace=False)]
        largest = max(planes, key=np.sum, default=off[:0])
        if largest.sum() < num_least:
            return off
        off[rows[largest]] = False


def prepare(points: np.ndarray, model: Model, viewpoint: np.ndarray) -> Scene:
    """Thin a scan and fit normals to it, as wide as the model's points stand for.

    What is on planes larger than the model does not vote: it has no features, but most pairs.
    Source: Hoppe et al., SIGGRAPH 1992: planes through the nearest points.
    """
    step = model.pairs.quantization.distance_step
    points = thin(points, step / 3)[1]
    near = points[cKDTree(points).query(points, k=20)[1]]
    near -= near.mean(axis=1, keepdims=True)
    normals = np.linalg.eigh(near.transpose(0, 2, 1) @ near)[1][:, :, 0]
    away = np.sum(normals * (viewpoint - points), axis=1) < 0
    normals[away] *= -1
    sampled = thin(points, step)[0]
    off = off_planes(points[sampled], normals[sampled], step, int((model.diameter / step)**2))
    return Scene(points, normals, sampled[off], viewpoint)


def vote(model: Model, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """The best pose of each reference point of the scene: poses [n, 4, 4] and their votes [n]."""
    pairs = model.pairs
    offsets = pairs.offsets.astype(np.int64)
    points, normals = scene.points[scene.sampled], scene.normals[scene.sampled]
    tree = cKDTree(points)
    model_frames, scene_frames = point_pairs.frames(pairs.normals), point_pairs.frames(normals)
    poses, votes = [], []
    for r in range(0, len(points), REFERENCE_SHARE):
        near = np.array(tree.query_ball_point(points[r], model.diameter))
        d = points[near] - points[r]
        cell = point_pairs.cells(pairs.quantization, normals[r], d, normals[near])
        near, cell = d[cell >= 0], cell[cell >= 0]
        # The rows of all the cells, one after the other.
        counts = offsets[cell + 1] - offsets[cell]
        first = np.repeat(offsets[cell] - (np.cumsum(counts) - counts), counts)
        entries = pairs.entries[first + np.arange(len(first))]
        turn = entries[:, 1] - np.repeat(point_pairs.turns(scene_frames[r], near), counts)
        turn_bins = turn.astype(np.int64) * TURN_BINS // 65536  # differences have wrapped
        accumulator = np.bincount(entries[:, 0].astype(np.int64) * TURN_BINS + turn_bins,
                                  minlength=pairs.num_references * TURN_BINS)
        if not accumulator.any():
            continue
        m, turn_bin = divmod(int(accumulator.argmax()), TURN_BINS)
        alpha = 2 * np.pi * (turn_bin + 0.5) / TURN_BINS
        # Drost et al., eq. (2).
        pose = np.eye(4)
        about_normal = Rotation.from_euler("x", alpha).as_matrix()
        pose[:3, :3] = scene_frames[r].T @ about_normal @ model_frames[m]
        pose[:3, 3] = points[r] - pose[:3, :3] @ pairs.points[m]
        poses.append(pose)
        votes.append(accumulator.max())
    return np.array(poses).reshape(-1, 4, 4), np.array(votes, dtype=np.int64)


def symmetric_motions(model: Model, num_turns: int) -> np.ndarray:
    """Motions [n, 4, 4] that map a model onto itself, the identity first.

    num_turns  that stand for any turn about an axis
    """
    motions = np.concatenate([np.eye(4)[None], model.symmetry_poses])
    if model.symmetry_axis is None:
        return motions
    direction, point = model.symmetry_axis
    angles = np.arange(num_turns)[:, None] * (2 * np.pi / num_turns)
    turned = np.tile(np.eye(4), (num_turns, 1, 1))
    turned[:, :3, :3] = Rotation.from_rotvec(angles * direction).as_matrix()
    turned[:, :3, 3] = point - turned[:, :3, :3] @ point
    return (turned[:, None] @ motions[None]).reshape(-1, 4, 4)


def differences(model: Model, pose: np.ndarray, poses: np.ndarray,
                motions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far poses [n, 4, 4] are from one, up to symmetry.

    Returns the distances [n] of the model's centre in diameters, the angles [n] in degrees, and
    the equivalents [n, 4, 4] of the poses that are nearest to the one.
    """
    rotations = poses[:, None, :3, :3] @ motions[None, :, :3, :3]
    traces = np.einsum("nkij,ij->nk", rotations, pose[:3, :3])
    best = traces.argmax(axis=1)
    cosines = (traces[np.arange(len(poses)), best] - 1) / 2
    nearest = poses @ motions[best]
    moved = (nearest - pose)[:, :3] @ np.append(model.centre, 1)
    return (np.linalg.norm(moved, axis=1) / model.diameter,
            np.degrees(np.arccos(np.clip(cosines, -1, 1))), nearest)


def cluster(model: Model, poses: np.ndarray, votes: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Like poses together: mean poses and sums of votes, most first."""
    motions = symmetric_motions(model, 36)
    clusters = []
    order = np.argsort(-votes, kind="stable")
    poses, votes = poses[order], votes[order]
    while len(poses):
        moved, turned, nearest = differences(model, poses[0], poses, motions)
        like = (moved < CLUSTER_DIAMETERS) & (turned < CLUSTER_DEGREES)
        like[0] = True
        mean = np.average(nearest[like], axis=0, weights=votes[like])
        mean[:3, :3] = Rotation.from_matrix(nearest[like, :3, :3]).mean(votes[like]).as_matrix()
        clusters.append((mean, int(votes[like].sum())))
        poses, votes = poses[~like], votes[~like]
    return sorted(clusters, key=lambda found: -found[1])


def refine(model: Model, scene: Scene, tree: cKDTree, pose: np.ndarray) -> tuple[np.ndarray, float]:
    """Point-to-plane ICP (Chen, Medioni, 1992) of the samples turned to the viewpoint.

    Returns the pose and the share of these samples that lie on the scan.
    """
    step = model.pairs.quantization.distance_step
    share = 0.0
    for gate in np.geomspace(2 * step, step / 3, 15):
        samples = model.samples @ pose[:3, :3].T + pose[:3, 3]
        normals = model.sample_normals @ pose[:3, :3].T
        seen = np.sum(normals * (scene.viewpoint - samples), axis=1) > 0
        samples, normals = samples[seen], normals[seen]
        distance, nearest = tree.query(samples, distance_upper_bound=gate)
        met = np.isfinite(distance)
        met[met] = np.sum(normals[met] * scene.normals[nearest[met]], axis=1) > 0.8
        share = float(met.mean()) if len(met) else 0.0
        if met.sum() < 20:
            return pose, 0.0
        p, n, q = samples[met], normals[met], scene.points[nearest[met]]
        origin = p.mean(axis=0)  # small angles are about it
        jacobian = np.hstack([np.cross(p - origin, n) / model.diameter, n])
        x = np.linalg.lstsq(jacobian, np.sum((q - p) * n, axis=1), rcond=1e-3)[0]
        step_pose = np.eye(4)
        step_pose[:3, :3] = Rotation.from_rotvec(x[:3] / model.diameter).as_matrix()
        step_pose[:3, 3] = x[3:] + origin - step_pose[:3, :3] @ origin
        pose = step_pose @ pose
    return pose, share


def recognize(model: Model, points: np.ndarray, viewpoint: np.ndarray) -> Found | None:
    """The best pose of a model in a scan [n, 3], or none where nothing votes for one."""
    scene = prepare(points, model, viewpoint)
    clusters = cluster(model, *vote(model, scene))
    tree = cKDTree(scene.points)
    found = []
    for pose, votes in clusters[:NUM_REFINED]:
        refined, fit = refine(model, scene, tree, pose)
        found.append(Found(refined, votes, fit))
    return max(found, key=lambda one: one.fit, default=None)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library")
    parser.add_argument("model")
    parser.add_argument("scene")
    parser.add_argument("--viewpoint", default="0,0,0", metavar="X,Y,Z",
                        help="where the sensor was, in the scene's frame")
    parser.add_argument("--json", metavar="FILE")
    arguments = parser.parse_args()
    try:
        model = read_library(arguments.library).models.get(arguments.model)
        points = read_scene(arguments.scene)
    except (LibraryError, OSError, ValueError) as error:
        sys.exit(f"error: {error}")
    if model is None:
        sys.exit(f"error: {arguments.library} has no model {arguments.model}")
    viewpoint = np.array([float(number) for number in arguments.viewpoint.split(",")])
    found = recognize(model, points, viewpoint)
    if found is None:
        sys.exit(f"error: nothing of {model.name} in {arguments.scene}")
    print(np.array2string(found.T_scene_model, precision=6, suppress_small=True))
    print(f"{found.votes} votes, {found.fit:.0%} of what is turned to the sensor lies on the scan")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"model": model.name, "votes": found.votes, "fit": found.fit,
                       "T_scene_model": found.T_scene_model.tolist()}, file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
