"""Results held against the truth."""

from __future__ import annotations

import json
import os
from typing import Any, Optional

from . import _trivet
from ._geometry import PathLike
from .library import Library
from .training import Progress


class Evaluation:
    """How many of the objects were found, and what else was.

    instances, right, false_positives: numbers; recall, precision: 0..1; document: all that
    `trivet evaluate --json` tells, with every detection of every scene
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
    """Recognize the scenes of a manifest, or of a BOP data set, and hold the detections against its
    truth. `options` and `preset` are those of Library.recognize; progress is called with (done,
    total, name of the scene). Errors: UsageError, DataError, MissingInputError."""
    return Evaluation(json.loads(
        _trivet._evaluate(library, os.fsencode(manifest), preset, progress, options)))
