"""Comparison of results with the ground truth."""

from __future__ import annotations

import json
import os
from typing import Any, Optional

from . import _trivet
from ._geometry import PathLike
from .library import Library
from .training import Progress


class Evaluation:
    """The counts of right and false detections, and the rates derived from them.

    instances, right, false_positives: counts; recall, precision: 0..1; document: the complete
    output of `trivet evaluate --json`, with every detection of every scene
    """

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.instances: int = document["instances"]
        self.right: int = document["right"]
        self.false_positives: int = document["false_positives"]
        self.recall: float = document["recall"]
        self.precision: float = document["precision"]

    def __repr__(self) -> str:
        return (f"<trivet.Evaluation {self.right} of {self.instances} found, "
                f"{self.false_positives} false>")


def evaluate(
    library: Library,
    manifest: PathLike,
    *,
    preset: str = "balanced",
    progress: Optional[Progress] = None,
    **options: Any,
) -> Evaluation:
    """Recognizes the scenes of a manifest or BOP data set and compares the detections with its
    ground truth.

    `options` and `preset` are those of Library.recognize; progress is called with (done, total,
    name of the scene). Errors: UsageError, DataError, MissingInputError.
    """
    return Evaluation(json.loads(
        _trivet._evaluate(library, os.fsencode(manifest), preset, progress, options)))
