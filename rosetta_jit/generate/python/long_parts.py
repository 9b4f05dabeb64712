"""Messages of types that contain themselves, for generated modules that write some: part of those."""

from __future__ import annotations

from typing import Any

_LONG = 32768


class _Long:
    """The bytes of a long message in parts, which those around it do not copy."""

    __slots__ = ("parts", "size")

    def __init__(self, parts: list[Any], size: int) -> None:
        self.parts, self.size = parts, size

    def __len__(self) -> int:
        return self.size


def _joined(parts: Any) -> Any:  # pyright: ignore[reportUnusedFunction]
    """The bytes of a message that another contains, or their parts."""
    try:
        found = b"".join(parts)
    except TypeError:  # some are long
        flat: list[Any] = []
        size = 0
        for each in parts:
            if type(each) is _Long:
                flat += each.parts
                size += each.size
            else:
                flat.append(each)
                size += len(each)
        return _Long(flat, size)
    return found if len(found) < _LONG else _Long([found], len(found))


def _whole(parts: Any) -> bytes:  # pyright: ignore[reportUnusedFunction]
    """The bytes of a message."""
    found = _joined(parts)
    return b"".join(found.parts) if type(found) is _Long else found
