"""Features of point pairs as a library's table quantizes them (docs/format.md). Needs numpy."""
from typing import NamedTuple

import numpy as np


class Quantization(NamedTuple):
    """How a feature becomes a cell of the table."""
    distance_step: float  # width of a distance bin, in the library's unit
    num_distance_bins: int
    num_angle_bins: int  # over [0, pi]

    @property
    def num_cells(self) -> int:
        return self.num_distance_bins * self.num_angle_bins**3


def frames(normals: np.ndarray) -> np.ndarray:
    """Rotations [n, 3, 3] into the frames of points; rows are their axes, the first the normal.

    normals  [n, 3], unit vectors
    Source: Duff et al., JCGT 2017.
    """
    x, y, z = normals.T
    s = np.copysign(1, z)
    a = -1 / (s + z)
    b = x * y * a
    u = np.stack([1 + s * x * x * a, s * b, -s * x], axis=1)
    v = np.stack([b, s + y * y * a, -y], axis=1)
    return np.stack([normals, u, v], axis=1)


def turns(frame: np.ndarray, d: np.ndarray) -> np.ndarray:
    """The turns about +x [n], in 1/65536 of a full one, that bring points into y >= 0, z = 0.

    frame  [3, 3] of the pairs' first point; d  [n, 3] from it to the second ones
    """
    alpha = -np.arctan2(d @ frame[2], d @ frame[1])
    return (np.round(alpha / (2 * np.pi) * 65536).astype(np.int64) % 65536).astype(np.uint16)


def cells(q: Quantization, normal: np.ndarray, d: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Cells [n] of pairs from one point; -1 where a pair is too far apart or of one place.

    normal  [3] of the first point; d  [n, 3] from it to the second ones; normals  [n, 3] of these
    Source: Drost et al., CVPR 2010, eq. (1).
    """
    def angle_bins(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1))
        bins = (angle * (q.num_angle_bins / np.pi)).astype(np.int64)
        return np.minimum(bins, q.num_angle_bins - 1)

    length = np.linalg.norm(d, axis=1)
    first = np.broadcast_to(normal, d.shape)
    key = (length / q.distance_step).astype(np.int64)
    inside = (length > 0) & (key < q.num_distance_bins)
    for a, b in (first, d), (normals, d), (first, normals):
        key = key * q.num_angle_bins + angle_bins(a, b)
    return np.where(inside, key, -1)
