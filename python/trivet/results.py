"""The results of recognition in a scene."""

from __future__ import annotations

import base64
import html
import json
from typing import Any, Iterator

import numpy as np

from . import _trivet
from ._trivet import Detection, RejectedPose


class Result:
    """The detections of a scene by descending score.

    It is a sequence of detections: len, iteration, indexing.
    """

    def __init__(self, recognized: _trivet._Recognized) -> None:
        self._recognized = recognized
        self.detections: list[Detection] = recognized.detections
        self.rejected: list[RejectedPose] = recognized.rejected
        self.name: str = recognized.name
        self.seconds: float = recognized.seconds

    def __len__(self) -> int:
        return len(self.detections)

    def __iter__(self) -> Iterator[Detection]:
        return iter(self.detections)

    def __getitem__(self, index: int) -> Detection:
        return self.detections[index]

    def __repr__(self) -> str:
        found = ", ".join(f"{one.model} {one.score:.2f}" for one in self.detections)
        return f"<trivet.Result of {self.name}: {found or 'nothing found'}>"

    def to_dict(self) -> dict[str, Any]:
        """The scene in the format of `trivet recognize --json`."""
        return json.loads(self._recognized.json())

    def picture(self) -> np.ndarray:
        """The scan from the sensor's viewpoint with drawn detections: (height, width, 3) uint8."""
        return self._recognized.draw()[0]

    def _repr_html_(self) -> str:
        """Representation in notebooks: the picture, and a table below it."""
        try:
            _, png, colors = self._recognized.draw()
        except Exception as error:  # a scan too small to be drawn still has a table
            picture, colors = f"<p>{html.escape(str(error))}</p>", ["gray"] * len(self)
        else:
            data = base64.b64encode(png).decode("ascii")
            picture = (f'<img alt="The scan with {len(self)} models drawn in" '
                       f'style="max-width:100%" src="data:image/png;base64,{data}">')
        rows = "".join(
            f'<tr><td><span style="color:{color}">&#9632;</span> {html.escape(one.model)}</td>'
            f"<td>{min(one.score, 0.999):.3f}</td><td>{100 * one.visible_fraction:.0f} %</td>"
            f"<td>{', '.join(f'{x:.4g}' for x in one.pose[:3, 3])}</td></tr>"
            for one, color in zip(self.detections, colors))
        return (f"{picture}<table><thead><tr><th>model</th><th>score</th><th>seen</th>"
                f"<th>place</th></tr></thead><tbody>{rows}</tbody></table>")
