"""Geometry passed by callers: arrays, and objects of other libraries that contain arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Optional, Union

import numpy as np

from .errors import UsageError

PathLike = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Mesh:
    """A surface, or a point cloud if there are no triangles.

    vertices:  (n, 3)
    triangles: (m, 3) indices of vertices, or None
    normals:   (n, 3), or None
    """

    vertices: np.ndarray
    triangles: Optional[np.ndarray] = None
    normals: Optional[np.ndarray] = None

    def __post_init__(self) -> None:
        for name in ("vertices", "triangles", "normals"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, np.asarray(value))


def is_path(thing: Any) -> bool:
    return isinstance(thing, (str, os.PathLike))


def _array(value: Any) -> Optional[np.ndarray]:
    if value is None:
        return None
    array = np.asarray(value)
    return array if array.size else None


def _points_of(thing: Any) -> np.ndarray:
    """The points as an array; for a structured array, its fields x, y, z.

    Raises UsageError if these fields are missing.
    """
    array = np.asarray(thing)
    names = array.dtype.names
    if names is None:
        return array
    if not {"x", "y", "z"} <= set(names):
        raise UsageError(
            f"points: expected the fields x, y, z of a structured array, found {', '.join(names)}; if "
            "the first three are the coordinates, give "
            "numpy.stack([a[n] for n in a.dtype.names[:3]], axis=-1)")
    return np.stack([array[name] for name in "xyz"], axis=-1)


def as_mesh(thing: Any) -> Mesh:
    """Converts to a Mesh.

    Accepts a Mesh, an array (n, 3), a structured array with the fields x, y, z, a pair (vertices,
    triangles), or a mesh or cloud of trimesh (`vertices`, `faces`) or Open3D (`vertices`,
    `triangles`; `points`, `normals`).
    """
    if isinstance(thing, Mesh):
        return thing
    if isinstance(thing, tuple) and len(thing) == 2:
        return Mesh(*thing)
    if hasattr(thing, "vertices"):
        faces = thing.faces if hasattr(thing, "faces") else getattr(thing, "triangles", None)
        return Mesh(np.asarray(thing.vertices), _array(faces))
    if hasattr(thing, "points"):
        return Mesh(np.asarray(thing.points), None, _array(getattr(thing, "normals", None)))
    return Mesh(_points_of(thing))
