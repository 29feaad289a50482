"""The virtual depth sensor: scenes with exactly known ground truth."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, Optional, Sequence

import numpy as np

from . import _trivet
from ._geometry import Mesh
from .training import Models, arguments_of


@dataclass(frozen=True)
class Truth:
    """An object of a scene.

    visible_fraction, occlusion, clutter: 0..1; ignore: too little of it is visible to require its
    detection.
    """

    model: str
    pose: np.ndarray  # (4, 4)
    visible_fraction: Optional[float]
    occlusion: Optional[float]
    clutter: Optional[float]
    ignore: bool


@dataclass(frozen=True)
class ScannedScene:
    """A simulated depth image with its camera and ground truth.

    depth: (height, width) uint16, 0: not measured; camera: (fx, fy, cx, cy) [pixel]; depth times
    depth_scale is a length. `library.recognize(scene.depth, camera=scene.camera,
    depth_scale=scene.depth_scale)` recognizes it.
    """

    depth: np.ndarray
    camera: tuple[float, float, float, float]
    depth_scale: float
    truth: list[Truth]


class VirtualScanner:
    """A sequence of scenes with piles of models: len, indexing, iteration.

    A scene does not depend on which others are scanned. trivet.scan creates a scanner.
    """

    def __init__(self, scanner: _trivet._Scanner) -> None:
        self._scanner = scanner

    @property
    def models(self) -> dict[str, Mesh]:
        """The scanned models by name, in a form that trivet.train accepts."""
        return {name: Mesh(vertices, triangles)
                for name, vertices, triangles in self._scanner.models}

    def __len__(self) -> int:
        return self._scanner.num_scenes

    def __getitem__(self, index: int) -> ScannedScene:
        if not 0 <= index < len(self):
            raise IndexError(f"scene {index}: expected 0 to {len(self) - 1}")
        made = self._scanner.scan(index)
        return ScannedScene(made["depth"], made["camera"], made["depth_scale"],
                            [Truth(**one) for one in made["truth"]])

    def __iter__(self) -> Iterator[ScannedScene]:
        return (self[index] for index in range(len(self)))


def scan(
    models: Optional[Models] = None,
    *,
    parts: int = 0,
    families: Sequence[str] = (),
    unit: Optional[str] = None,
    diameter: float = 0,
    metal: bool = False,
    **options: Any,
) -> VirtualScanner:
    """Scans piles of models with a virtual depth sensor, without any file:
    `for scene in trivet.scan(parts=5, scenes=3): ...`.

    models:   models as for trivet.train; may be None if parts is set
    parts:    number of machine parts generated from the seed, in addition to the models or alone
    families: generate only parts of these families
    unit:     unit of the models and the truth, "m" (also None) or "mm"
    diameter: scale every model from a file to this diameter; 0: unchanged
    metal:    the models are of bright metal
    options:  those of `trivet scan`, e.g. scenes=4, sensor="stereo" (trivet.options("scan"))
    Errors: UsageError, DataError.
    """
    with tempfile.TemporaryDirectory(prefix="trivet-") as folder:
        files = [] if models is None else arguments_of(models, Path(folder))
        return VirtualScanner(
            _trivet._Scanner(files, parts, list(families), unit, diameter, metal, options))
