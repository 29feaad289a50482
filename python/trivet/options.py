"""The available options."""

from __future__ import annotations

from typing import Any

from . import _trivet
from .errors import UsageError


def options(of: str) -> list[dict[str, Any]]:
    """The options of "recognize", "train" or "scan".

    Each has a name, group, help, unit, range, choices and default (None: chosen by the program, or
    unlimited).
    """
    lists = {
        "recognize": _trivet._recognize_options,
        "train": _trivet._train_options,
        "scan": _trivet._scan_options,
    }
    if of not in lists:
        raise UsageError(f"options: expected recognize, train or scan, found '{of}'")
    return lists[of]()
