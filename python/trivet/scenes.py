"""Scenes from arrays and files, and surfaces through their points."""

from __future__ import annotations

import os
from typing import Any, Optional, Sequence

import numpy as np

from . import _trivet
from ._geometry import Mesh, PathLike, as_mesh, is_path
from ._trivet import Scene


def as_scene(
    thing: Any,
    *,
    camera: Any = None,
    depth_scale: float = 1.0,
    viewpoint: Optional[Sequence[float]] = None,
    closed_surface: bool = False,
    unit: Optional[str] = None,
    name: str = "array",
) -> Scene:
    """Converts to a Scene.

    Accepts a Scene, a file, a depth image (with a camera), points (n, 3) or (height, width, 3), a
    Mesh, or an object of trimesh or Open3D.
    """
    if isinstance(thing, Scene):
        return thing
    if is_path(thing):
        return Scene.read(thing, camera=camera, depth_scale=depth_scale,
                          viewpoint=viewpoint, closed_surface=closed_surface, unit=unit)
    if camera is not None:
        return Scene.from_depth(thing, camera, depth_scale=depth_scale, unit=unit, name=name)
    mesh_ = as_mesh(thing)
    return Scene.from_points(mesh_.vertices, normals=mesh_.normals, triangles=mesh_.triangles,
                             viewpoint=viewpoint, closed_surface=closed_surface, unit=unit,
                             name=name)


def mesh(
    scene: Any,
    *,
    method: Optional[str] = None,
    viewpoint: Optional[Sequence[float]] = None,
    **how: Any,
) -> Mesh:
    """Triangulates the points of a scan, as `trivet mesh` does.

    scene:     any scene that Library.recognize accepts, with the same keywords
    method:    "grid" (adjacent pixels), "greedy" (unorganized points) or "faces" (unchanged); None:
               the first one applicable to the scan
    viewpoint: position of the sensor; triangles are counter-clockwise seen from there
    Errors: UsageError, DataError.
    """
    made = as_scene(scene, viewpoint=viewpoint, **how)._mesh(method, viewpoint)
    vertices = made["vertices"]
    if np.any(made["offset"]):
        vertices = vertices + made["offset"]
    return Mesh(vertices, made["triangles"], made["normals"])


def write_ply(file: PathLike, geometry: Any) -> None:
    """Writes points or a mesh as binary PLY; the file appears complete or not at all.

    Errors: CannotCreateError, InputOutputError, DataError.
    """
    made = as_mesh(geometry)
    _trivet._write_mesh(os.fsencode(file), made.vertices, made.triangles, made.normals)
