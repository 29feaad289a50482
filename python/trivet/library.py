"""An opened library, and recognition with it."""

from __future__ import annotations

import json
import os
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Iterable, Iterator, Optional, Sequence

from . import _trivet
from ._geometry import PathLike
from ._trivet import Stopper
from .results import Result
from .scenes import as_scene

_IN_FLIGHT = 2  # one scene is read while another is recognized: more would only add latency


class Library(_trivet.Library):
    """A mapped library file, which opens immediately, whatever its size.

    It is a mapping from names to models: `len(library)`, `library["bracket"]`, `"bracket" in
    library`, `for name in library`. Any number of threads may share it. Unpickling a library opens
    its file again.

    file:        library made by `trivet train` or trivet.train
    calibration: file with the score that `trivet calibrate` adapted to a cell
    memory_mb:   limit of the data cached from earlier scenes
    verify:      check the whole file first; otherwise each model is checked at its first use
    Errors: MissingInputError, DataError, InputOutputError.
    """

    def __init__(
        self,
        file: PathLike,
        *,
        calibration: Optional[PathLike] = None,
        memory_mb: int = 768,
        verify: bool = False,
    ) -> None:
        super().__init__(os.fsencode(file), calibration=os.fsencode(calibration or ""),
                         memory_mb=memory_mb, verify=verify)

    def __repr__(self) -> str:
        return f"<trivet.Library {self.file}: {len(self)} models, lengths in {self.unit}>"

    @property
    def parameters(self) -> dict[str, Any]:
        """The training parameters."""
        return json.loads(self._parameters)

    def recognize(
        self,
        scene: Any,
        *,
        camera: Any = None,
        depth_scale: float = 1.0,
        viewpoint: Optional[Sequence[float]] = None,
        closed_surface: bool = False,
        unit: Optional[str] = None,
        name: str = "array",
        preset: str = "balanced",
        stopper: Optional[Stopper] = None,
        **options: Any,
    ) -> Result:
        """Finds the models of the library in a scene.

        Other Python threads run meanwhile; Ctrl-C stops it.

        scene:          points (n, 3), an organized cloud (height, width, 3), a depth image (height,
                        width) with its camera, a file, a Scene, a Mesh, or a cloud or mesh of
                        trimesh or Open3D
        camera:         (fx, fy, cx, cy) or a (3, 3) matrix [pixel], OpenCV's axes; a camera file, or
                        a dictionary of its form, with "distortion", "depth", "width", "height"
        depth_scale:    factor from depth values to lengths (0.001: millimeters to meters)
        viewpoint:      position of the sensor, 3 numbers; None: from the file, else the origin
        closed_surface: the scene is a complete surface, not a view from one sensor
        unit:           unit of the scene and the poses, "m" or "mm"; None: the library's
        preset:         "fast", "balanced" or "accurate"
        stopper:        stops the call from another thread
        options:        those of `trivet recognize`: min_score=0.7 (trivet.options("recognize"));
                        poses in expected=[(model, pose), ...] are tested before any search
        Errors: UsageError, DataError, Stopped.
        """
        made = as_scene(scene, camera=camera, depth_scale=depth_scale, viewpoint=viewpoint,
                        closed_surface=closed_surface, unit=unit, name=name)
        return Result(_trivet._recognize(self, made, preset, stopper, options))

    def recognize_all(
        self, scenes: Iterable[Any], *, stopper: Optional[Stopper] = None, **how: Any
    ) -> Iterator[Result]:
        """Yields the results of many scenes, or of an endless stream, in order.

        While one scene is recognized, the next is fetched and read. `how`: keyword arguments of
        `recognize`.
        """
        stop = stopper or Stopper()
        with ThreadPoolExecutor(_IN_FLIGHT, thread_name_prefix="trivet") as threads:
            running: deque[Future[Result]] = deque()
            try:
                for scene in scenes:
                    running.append(threads.submit(self.recognize, scene, stopper=stop, **how))
                    if len(running) == _IN_FLIGHT:
                        yield running.popleft().result()
                while running:
                    yield running.popleft().result()
            finally:  # the caller left early: the remaining recognitions stop
                if running:
                    stop.stop()
