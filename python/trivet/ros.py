"""ROS 2 messages as dictionaries in the layout of rosidl and rosbridge; ROS is not required.

`rosidl_runtime_py.message_to_ordereddict` converts a message to such a dictionary, and
`rosidl_runtime_py.set_message_fields` fills a message from one.
"""

from __future__ import annotations

import math
from typing import Any, Mapping, Optional

import numpy as np

from ._trivet import Detection
from .errors import DataError
from .library import Library
from .results import Result

_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


def points_of(cloud: Mapping[str, Any]) -> np.ndarray:
    """The points of a sensor_msgs/PointCloud2: (n, 3), or (height, width, 3) if it is organized.

    Points without a measurement are NaN. The message's bytes are not copied if x, y and z are
    contiguous little-endian floats. Errors: DataError.
    """
    fields = {field["name"]: field for field in cloud["fields"]}
    missing = [axis for axis in "xyz" if axis not in fields]
    if missing:
        raise DataError(f"PointCloud2: expected fields x, y, z, found {', '.join(fields) or 'none'}")
    order = ">" if cloud["is_bigendian"] else "<"
    kinds = [order + _TYPES[fields[axis]["datatype"]] for axis in "xyz"]
    offsets = [fields[axis]["offset"] for axis in "xyz"]
    data = cloud["data"]
    raw = np.frombuffer(data if isinstance(data, (bytes, bytearray, memoryview))
                        else bytes(bytearray(data)), np.uint8)
    height, width = cloud["height"], cloud["width"]
    step, row = cloud["point_step"], cloud["row_step"]
    sizes = [np.dtype(kind).itemsize for kind in kinds]
    needed = (height - 1) * row + (width - 1) * step + max(
        offset + size for offset, size in zip(offsets, sizes))
    if height * width > 0 and raw.size < needed:
        raise DataError(f"PointCloud2: expected {needed} bytes of {height} x {width} points, found "
                        f"{raw.size}")

    def column(axis: int) -> np.ndarray:
        return np.ndarray((height, width), kinds[axis], raw, offsets[axis], (row, step))

    size = sizes[0]
    if kinds[0] in ("<f4", "<f8") and len(set(kinds)) == 1 and offsets == [
            offsets[0] + k * size for k in range(3)]:
        points: np.ndarray = np.ndarray((height, width, 3), kinds[0], raw, offsets[0], (row, step, size))
    else:
        points = np.stack([column(axis) for axis in range(3)], axis=-1).astype(np.float32)
    return points if height > 1 else points.reshape(-1, 3)


def _vector(values: Any) -> dict[str, float]:
    return dict(zip("xyz", map(float, values)))


def pose_of(matrix: np.ndarray) -> dict[str, Any]:
    """A (4, 4) pose as geometry_msgs/Pose."""
    x, y, z, w = quaternion_of(matrix)
    return {"position": _vector(matrix[:3, 3]), "orientation": {"x": x, "y": y, "z": z, "w": w}}


def quaternion_of(matrix: np.ndarray) -> tuple[float, float, float, float]:
    """The unit quaternion x, y, z, w of a pose's rotation, with w >= 0.

    Source: Shepperd, 1978, which starts from the largest of the four elements.
    """
    r = np.asarray(matrix, float)[:3, :3]
    trace = np.trace(r)
    largest = int(np.argmax([r[0, 0], r[1, 1], r[2, 2], trace]))
    if largest == 3:
        q = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], 1 + trace]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q = [0.0, 0.0, 0.0, r[k, j] - r[j, k]]
        q[i] = 1 + r[i, i] - r[j, j] - r[k, k]
        q[j] = r[j, i] + r[i, j]
        q[k] = r[k, i] + r[i, k]
    norm = math.copysign(math.sqrt(sum(value * value for value in q)), q[3] or 1.0)
    x, y, z, w = (float(value / norm) for value in q)
    return x, y, z, w


def detection_of(
    detection: Detection, library: Library, header: Optional[Mapping[str, Any]] = None
) -> dict[str, Any]:
    """A vision_msgs/Detection3D (version 4).

    The box is the model's bounding box, aligned with the model's axes. Alternative poses that the
    scan cannot distinguish from the first follow as further results, and the score is divided among
    all poses.
    """
    vertices = library[detection.model].vertices
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    center = detection.pose.copy()
    center[:3, 3] += detection.pose[:3, :3] @ ((low + high) / 2)
    others = detection.alternatives
    poses = [detection.pose, *others]
    rest = detection.score - detection.pose_score
    shares = [detection.pose_score] + [rest / max(len(others), 1)] * len(others)
    return {
        "header": dict(header or {}),
        "results": [{"hypothesis": {"class_id": detection.model, "score": float(share)},
                     "pose": {"pose": pose_of(pose), "covariance": [0.0] * 36}}
                    for pose, share in zip(poses, shares)],
        "bbox": {"center": pose_of(center), "size": _vector(high - low)},
        "id": "",
    }


def detections_of(
    result: Result, library: Library, header: Optional[Mapping[str, Any]] = None
) -> dict[str, Any]:
    """A vision_msgs/Detection3DArray.

    header: std_msgs/Header of the scan's message. Lengths are in meters, as REP 103 requires, if
    those of the library and the scene are.
    """
    return {"header": dict(header or {}),
            "detections": [detection_of(one, library, header) for one in result]}
