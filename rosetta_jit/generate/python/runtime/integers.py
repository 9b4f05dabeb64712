"""Lists of integers that are written one by one, for generated modules that write some: part of those."""

from __future__ import annotations

from struct import pack as _pack
from typing import Any


def _fitting(code: str, numbers: Any) -> Any:  # pyright: ignore[reportUnusedFunction]
    """Integers that all fit their field, of which the struct module has the code."""
    _pack(f"={len(numbers)}{code}", *numbers)
    return numbers
