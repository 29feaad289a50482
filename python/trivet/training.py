"""Training of libraries."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, Optional, Union

from . import _trivet
from ._geometry import PathLike, is_path
from .scenes import write_ply

Progress = Callable[[int, int, str], None]
Models = Union[PathLike, Iterable[PathLike], Mapping[str, Any]]


@dataclass(frozen=True)
class TrainReport:
    """The outcome of training.

    models: for each model its name, origin ("trained", "resumed", "kept"), counts, diameter,
            symmetry, seconds and warnings
    faults: name and reason for each omitted model (keep_going)
    """

    library: str
    unit: str
    seconds: float
    unchanged: bool
    models: list[dict[str, Any]]
    faults: list[dict[str, Any]]

    def __repr__(self) -> str:
        trained = sum(model["origin"] == "trained" for model in self.models)
        return (f"<trivet.TrainReport {self.library}: {len(self.models)} models, {trained} trained, "
                f"{self.seconds:.1f} s>")


def arguments_of(models: Models, folder: Path) -> list[bytes]:
    """The models as arguments of the command line; arrays are written to files in the folder."""
    if isinstance(models, (str, os.PathLike)):
        return [os.fsencode(models)]
    if not isinstance(models, Mapping):
        return [os.fsencode(model) for model in models]
    arguments = []
    for number, (name, model) in enumerate(models.items()):
        if not is_path(model):
            file = folder / f"{number}.ply"
            write_ply(file, model)
            model = file
        arguments.append(os.fsencode(f"{name}=") + os.fsencode(model))
    return arguments


def train(
    models: Models,
    output: PathLike,
    *,
    unit: Optional[str] = None,
    prune: bool = False,
    keep_going: bool = False,
    preset: str = "balanced",
    progress: Optional[Progress] = None,
    **options: Any,
) -> TrainReport:
    """Updates a library with models: unchanged models are kept, the others are trained.

    The file is replaced as a whole at the end. Ctrl-C stops training, and the same call resumes it.

    models:     {name: file, Mesh, (vertices, triangles), points (n, 3), or a mesh of trimesh or
                Open3D}, or files, folders, manifests and BOP data sets
    output:     library file
    unit:       unit of the models, "m" (also None) or "mm"; manifests state their unit
    prune:      remove models of the file that are not in `models`; otherwise they stay
    keep_going: omit models that cannot be trained; otherwise nothing is written
    preset:     "fast", "balanced" or "accurate"
    progress:   called with (done, total, name of the model), from any thread
    options:    those of `trivet train`, e.g. relative_step=0.03 (trivet.options("train"))
    Errors: UsageError, DataError (covers all models), MissingInputError, CannotCreateError,
    InputOutputError.
    """
    with tempfile.TemporaryDirectory(prefix="trivet-") as folder:
        document = json.loads(
            _trivet._train(arguments_of(models, Path(folder)), os.fsencode(output), unit, prune,
                           keep_going, preset, progress, options))
    return TrainReport(document["library"], document["unit"], document["seconds"],
                       document["unchanged"], document["models"], document["faults"])
