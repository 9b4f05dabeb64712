"""Texts and bytes of lanes and messages."""

# pyright: reportUnusedFunction=false

from __future__ import annotations

from typing import Any


def _text(lane: Any, data: Any, start: int, count: int) -> str:
    """A text: of a lane, or where the count is negative of the message."""
    if count < 0:
        return str(data[start : start - 1 - count], "utf-8", "surrogateescape")
    return str(lane[start : start + count], "utf-8", "surrogateescape")


def _texts(lane: Any, data: Any, spans: Any) -> list[str]:
    """The texts of an array: where all of a lane is ASCII they are parts of one text."""
    rows = zip(spans[::2], spans[1::2], strict=True)
    if not lane.isascii():
        return [_text(lane, data, start, count) for start, count in rows]
    whole = lane.decode()
    return [whole[start : start + count] if count >= 0 else _text(lane, data, start, count) for start, count in rows]


def _bytes(lane: Any, data: Any, start: int, count: int) -> bytes:
    return bytes(data[start : start - 1 - count]) if count < 0 else bytes(lane[start : start + count])


def _text16(lane: Any, start: int, count: int) -> str:
    return str(bytes(lane[2 * start : 2 * (start + count)]), "utf-16-le", "surrogatepass")


def _is_text(memory: Any, start: int, size: int) -> bool:
    try:
        str(memory[start : start + size], "utf-8")
    except UnicodeDecodeError:
        return False
    return True
