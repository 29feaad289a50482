"""Recognize known rigid objects in 3-D scans.

    import trivet

    trivet.train({"bracket": "bracket.ply"}, "parts.h5")
    library = trivet.Library("parts.h5")
    for found in library.recognize(points):       # (n, 3), or a depth image with its camera
        print(found.model, found.score, found.pose)

Lengths are in the unit of the library, "m" or "mm", unless a scene states its unit. Poses are
(4, 4) matrices that transform points of the model to points of the scene. Options are those of the
command line with underscores: `--min-score 0.7` is `min_score=0.7`; `trivet.options("recognize")`
lists them. Errors are raised as exceptions of `trivet.errors`.
"""

from ._geometry import Mesh
from ._trivet import Detection, Model, RejectedPose, Stopper, __version__
from .errors import (CannotCreateError, ChangedError, DataError, Error, InputOutputError,
                     InternalError, MissingInputError, Stopped, UsageError)
from .evaluation import Evaluation, evaluate
from .library import Library
from .options import options
from .results import Result
from .scanning import ScannedScene, Truth, VirtualScanner, scan
from .scenes import Scene, mesh, write_ply
from .training import TrainReport, train

__all__ = [
    "CannotCreateError", "ChangedError", "DataError", "Detection", "Error", "Evaluation",
    "InputOutputError", "InternalError", "Library", "Mesh", "MissingInputError", "Model",
    "RejectedPose", "Result", "ScannedScene", "Scene", "Stopped", "Stopper", "TrainReport", "Truth", "UsageError",
    "VirtualScanner", "__version__", "evaluate", "mesh", "options", "scan", "train", "write_ply",
]
