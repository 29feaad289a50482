"""Data in the format of the BOP toolkit: results, and the ground truth of scenes."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from .results import Result
from .scanning import ScannedScene


def results_of(
    result: Result,
    scene_id: int,
    im_id: int,
    object_ids: Mapping[str, int],
    unit: str = "m",
) -> list[dict[str, Any]]:
    """The input of `inout.save_bop_results`: one dictionary per detection, with R (3, 3) and
    t (3, 1) in millimeters.

    object_ids: BOP ids by model name; detections of other models are omitted
    unit:       unit of the result's poses, "m" or "mm"
    """
    scale = {"m": 1000.0, "mm": 1.0}[unit]
    return [{"scene_id": scene_id, "im_id": im_id, "obj_id": object_ids[one.model],
             "score": float(one.score), "R": one.pose[:3, :3],
             "t": scale * one.pose[:3, 3:], "time": result.seconds}
            for one in result if one.model in object_ids]


def truth_of(
    scene: ScannedScene, object_ids: Mapping[str, int], unit: str = "m"
) -> list[dict[str, Any]]:
    """The input of `inout.save_scene_gt` for an image."""
    scale = {"m": 1000.0, "mm": 1.0}[unit]
    return [{"obj_id": object_ids[one.model], "cam_R_m2c": one.pose[:3, :3],
             "cam_t_m2c": scale * one.pose[:3, 3:]} for one in scene.truth]


def camera_of(entry: Mapping[str, Any], unit: str = "m") -> dict[str, Any]:
    """The keyword arguments of Library.recognize for a depth image and its scene_camera.json entry.

    `library.recognize(depth, **bop.camera_of(scene_camera[im_id]))`
    """
    scale = {"m": 0.001, "mm": 1.0}[unit]
    matrix = np.asarray(entry["cam_K"], float).reshape(3, 3)
    return {"camera": matrix, "depth_scale": scale * entry.get("depth_scale", 1.0)}
