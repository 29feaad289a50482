"""The extension module. Arrays of models lie in the mapped file and are read only."""

from os import PathLike
from typing import Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Axis = tuple[Doubles, Doubles]

class Scene:
    """A scan, read once and used as often as you like."""

    @staticmethod
    def from_points(
        points: ArrayLike,
        *,
        normals: Optional[ArrayLike] = ...,
        triangles: Optional[ArrayLike] = ...,
        viewpoint: Optional[Sequence[float]] = ...,
        closed_surface: bool = ...,
        unit: Optional[str] = ...,
        name: str = ...,
    ) -> Scene:
        """Of points (n, 3), or (height, width, 3) of an organized cloud."""
    @staticmethod
    def from_depth(
        depth: ArrayLike,
        camera: ArrayLike,
        *,
        depth_scale: float = ...,
        unit: Optional[str] = ...,
        name: str = ...,
    ) -> Scene:
        """Of a depth image (height, width); camera: (fx, fy, cx, cy) or (3, 3) [pixel]."""
    @staticmethod
    def read(
        file: Union[str, bytes, PathLike[str]],
        *,
        camera: Optional[ArrayLike] = ...,
        depth_scale: float = ...,
        viewpoint: Optional[Sequence[float]] = ...,
        closed_surface: bool = ...,
        unit: Optional[str] = ...,
    ) -> Scene:
        """Of a file of any format that the command line reads."""
    def __len__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def num_invalid(self) -> int:
        """Points that were dropped since a coordinate was not finite."""
    @property
    def offset(self) -> Doubles:
        """(3,): what was subtracted from the coordinates, mostly zero."""
    @property
    def points(self) -> Floats:
        """(n, 3), without the offset."""
    @property
    def pixels(self) -> Optional[NDArray[np.int32]]:
        """(height, width): which point each pixel holds, -1 for none; None of scattered points."""
    def _mesh(
        self, method: Optional[str], viewpoint: Optional[Sequence[float]]
    ) -> dict[str, Any]: ...

class Model:
    """A model of a library, lengths in its unit."""

    @property
    def name(self) -> str: ...
    @property
    def source(self) -> str:
        """The file it was trained from."""
    @property
    def source_xxh3(self) -> str: ...
    @property
    def fingerprint(self) -> str:
        """Equal for models that are equal but for their names."""
    @property
    def diameter(self) -> float: ...
    @property
    def center(self) -> Doubles:
        """(3,), the centroid of its area."""
    @property
    def sample_spacing(self) -> float: ...
    @property
    def symmetries(self) -> Doubles:
        """(k, 4, 4): motions that map it onto itself, without the identity."""
    @property
    def symmetry_axis(self) -> Optional[Axis]:
        """Direction and point of an axis that any turn about is a symmetry."""
    @property
    def near_symmetries(self) -> Doubles:
        """(k, 4, 4): motions that map much of it onto itself."""
    @property
    def near_axis(self) -> Optional[Axis]: ...
    @property
    def vertices(self) -> Floats:
        """(n, 3)"""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(m, 3), empty of a cloud."""
    @property
    def samples(self) -> Floats:
        """(n, 3), about uniform over what can be seen of it."""
    @property
    def sample_normals(self) -> Floats:
        """(n, 3), outward."""
    @property
    def pairs(self) -> dict[str, Any]:
        """The table of point pairs (docs/format.md): points and normals (n, 3), offsets (cells + 1,),
        entries (pairs, 2) of reference point and angle, and how it is quantized."""
    @property
    def features(self) -> list[dict[str, Any]]:
        """Tri-Spin-Images by scale: resolution, keypoints (n, 3), frames (n, 9), codes (n, k)."""

class Library:
    def __init__(
        self, file: Union[str, bytes], *, calibration: Union[str, bytes] = ..., memory_mb: int = ..., verify: bool = ...
    ) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, arg0: str) -> Model: ...
    def __contains__(self, arg0: str) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def file(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def producer(self) -> str: ...
    @property
    def _parameters(self) -> str: ...
    def verify(self) -> None:
        """Compare all of it with its checksums. Errors: DataError."""

class Detection:
    """An object that was found; lengths and poses in the scene's unit."""

    @property
    def model(self) -> str: ...
    @property
    def score(self) -> float:
        """Probability that the object is here, in this pose or one of the alternatives."""
    @property
    def pose_score(self) -> float:
        """Probability that it is here in this very pose."""
    @property
    def pose_share(self) -> float: ...
    @property
    def pose(self) -> Doubles:
        """(4, 4): points of the model to points of the scene."""
    @property
    def covariance(self) -> Doubles:
        """(6, 6): of shifts along and turns [rad] about the model's axes, at its center."""
    @property
    def alternatives(self) -> Doubles:
        """(k, 4, 4): other poses that the scan cannot tell from this one."""
    @property
    def identity(self) -> float:
        """Share of the model named first among the candidates."""
    @property
    def candidates(self) -> list[dict[str, Any]]:
        """Models that it may be, the likeliest first, each with the keys of the JSON."""
    @property
    def turns(self) -> Optional[dict[str, Any]]:
        """Turns about an axis of the model, from low to high [rad], that the scan cannot tell."""
    @property
    def visible_fraction(self) -> float:
        """Share of the silhouette that was measured as it says."""
    @property
    def hidden_fraction(self) -> float: ...
    @property
    def outside_fraction(self) -> float: ...
    @property
    def violation(self) -> float:
        """Share of what was measured there that the sensor looked through."""
    @property
    def contour(self) -> float: ...
    @property
    def rmse(self) -> float: ...
    @property
    def deviation(self) -> float:
        """How far the object, as measured, is off its model, root mean square."""
    @property
    def parts(self) -> dict[str, float]:
        """What the score is made of."""
    @property
    def source(self) -> str:
        """What proposed it: "ppf", "trisi" or "expected"."""

class RejectedPose:
    """A pose that was tested in full but not reported (max_rejected)."""

    @property
    def model(self) -> str: ...
    @property
    def score(self) -> float: ...
    @property
    def pose(self) -> Doubles: ...
    @property
    def parts(self) -> dict[str, float]: ...
    @property
    def reason(self) -> str:
        """ "too_low", "explained" or "too_many". """
    @property
    def explained_by(self) -> Optional[int]:
        """Index of the detection that explains most of its pixels."""

class Stopper:
    """Stops what runs with it, from any thread."""

    def __init__(self) -> None: ...
    def stop(self) -> None: ...
    @property
    def stopped(self) -> bool: ...

class _Recognized:
    @property
    def detections(self) -> list[Detection]: ...
    @property
    def rejected(self) -> list[RejectedPose]: ...
    @property
    def name(self) -> str: ...
    @property
    def seconds(self) -> float: ...
    def json(self) -> str: ...
    def draw(self) -> tuple[NDArray[np.uint8], bytes, list[str]]: ...

class _Scanner:
    def __init__(
        self,
        files: list[str],
        num_parts: int,
        families: list[str],
        unit: Optional[str],
        diameter: float,
        metal: bool,
        options: dict[str, Any],
    ) -> None: ...
    @property
    def num_scenes(self) -> int: ...
    @property
    def models(self) -> list[tuple[str, Floats, NDArray[np.uint32]]]: ...
    def scan(self, index: int) -> dict[str, Any]: ...

def _recognize(
    library: Library,
    scene: Scene,
    preset: str,
    stopper: Optional[Stopper],
    options: dict[str, Any],
) -> _Recognized: ...
def _train(
    models: list[bytes],
    output: bytes,
    unit: Optional[str],
    prune: bool,
    keep_going: bool,
    preset: str,
    progress: Optional[Callable[[int, int, str], None]],
    options: dict[str, Any],
) -> str: ...
def _evaluate(
    library: Library,
    file: bytes,
    preset: str,
    progress: Optional[Callable[[int, int, str], None]],
    options: dict[str, Any],
) -> str: ...
def _write_mesh(
    file: bytes,
    vertices: ArrayLike,
    triangles: Optional[ArrayLike],
    normals: Optional[ArrayLike],
) -> None: ...
def _recognize_options() -> list[dict[str, Any]]: ...
def _train_options() -> list[dict[str, Any]]: ...
def _scan_options() -> list[dict[str, Any]]: ...
