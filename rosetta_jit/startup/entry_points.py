"""Whether installed packages may offer something under a group of entry points: a look at their folders.

`importlib.metadata` says it, and what they offer; but its import takes as long as making sense of a mapping, and hardly a package does.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import PathFinder


def may_be_offered(group: str) -> bool:
    """Whether `importlib.metadata` might find entry points of the group; where this cannot be seen in folders, it might."""
    others = any(hasattr(each, "find_distributions") for each in sys.meta_path if each is not PathFinder)
    return others or any(_is_named_in(folder or ".", group.encode()) for folder in sys.path)


def _is_named_in(folder: str, group: bytes) -> bool:
    if folder.lower().endswith(".egg") or os.path.isfile(folder):  # noqa: PTH113 - hundreds of them, at each start
        return True
    try:
        with os.scandir(folder) as entries:
            described = [each.path for each in entries if each.name.lower().endswith((".dist-info", ".egg-info"))]
    except OSError:
        return False
    return any(_is_said(f"{each}/entry_points.txt", group) for each in described)


def _is_said(file: str, group: bytes) -> bool:
    try:
        with open(file, "rb") as entry_points:  # noqa: PTH123 - hundreds of them, at each start
            return group in entry_points.read()
    except OSError:
        return False
