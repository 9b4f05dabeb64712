"""What is wrong with a message, and how an attempt to read or write ends."""

# pyright: reportUnusedFunction=false

from __future__ import annotations

from typing import Any


class MessageError(ValueError):
    """What is wrong with a message: its kind, the field (``.joints[3].name``), one sentence, the mapping's line."""

    def __init__(self, kind: str, path: str, detail: str, line: str = "", offset: int | None = None) -> None:
        self.kind, self.path, self.detail, self.line, self.offset = kind, path, detail, line, offset
        where = f" at {path}" if path else ""
        byte = "" if offset is None else f", byte {offset}"
        super().__init__(f"{kind}{where}{byte}: {detail}" + (f" ({line})" if line else ""))


class DecodeError(MessageError):
    """A message that cannot be read; ``offset`` is that of the byte."""


class EncodeError(MessageError):
    """An object that cannot be written."""


class _Failed(Exception):  # noqa: N818 - an end, no error
    """An attempt to read or write has come upon something that cannot be."""

    def __init__(self, site: int, at: int, indices: tuple[Any, ...] = (), detail: bytes | None = None) -> None:
        self.site, self.at, self.indices, self.detail = site, at, indices, detail


def _error(sites: tuple[tuple[Any, ...], ...], failed: _Failed, end: int | None) -> MessageError:
    """The error of a failure; ``end`` is that of the message which was read."""
    kind, path, detail, line, parts = sites[failed.site]
    at, indices = failed.at, list(failed.indices)
    if failed.site == 0:
        path = "{}"
    for offset, size, step, inner in parts:
        available, element = (0 if end is None else end - at), 0
        if step and available - offset - size >= 0:
            element = (available - offset - size) // step + 1
        if step or offset + size > available:
            path, at = inner, at + offset + element * step
            count = inner.count("{}")
            if step and count:
                indices = [*indices, 0, 0, 0, 0][:count]
                indices[count - 1] = element
            break
    pieces = path.split("{}")
    path = pieces[0] + "".join(f"{number}{piece}" for number, piece in zip([*indices, 0, 0, 0, 0], pieces[1:], strict=False))
    if failed.detail is not None:
        detail = failed.detail.decode("utf-8", "replace")
    return EncodeError(kind, path, detail, line) if end is None else DecodeError(kind, path, detail, line, at)
