"""Messages that may be long, within others."""

# pyright: reportUnusedFunction=false

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from typing import Any

_LONG = 65536
_LONG_TEXT = 40960


class _Long:
    """A long message in parts, which those around it do not copy."""

    __slots__ = ("parts", "size")

    def __init__(self, parts: Any, size: int) -> None:
        self.parts, self.size = parts, size

    def __len__(self) -> int:
        return self.size


class _LongText:
    """A long text, of ASCII alone, that becomes bytes where it is written."""

    __slots__ = ("text",)

    def __init__(self, text: str) -> None:
        self.text = text

    def __len__(self) -> int:
        return len(self.text)


def _utf8(text: str) -> Any:
    """A text as UTF-8."""
    return _LongText(text) if len(text) >= _LONG_TEXT and text.isascii() else text.encode()


def _long(part: Any) -> Any:
    """Bytes that a message within another has."""
    return part if len(part) < _LONG else _Long((part,), len(part))


def _joined(parts: Any) -> Any:
    """A message that another contains: its bytes, or if these are many their parts."""
    try:
        found = b"".join(parts)
    except TypeError:  # some parts are long
        return _Long(parts, sum(map(len, parts)))
    return found if len(found) < _LONG else _Long((found,), len(found))


def _whole(parts: Any) -> bytes:
    """The bytes of a message."""
    try:
        return b"".join(parts)
    except TypeError:  # some parts are long
        message = BytesIO()
        _write(parts, message.write)
        return message.getvalue()


def _write(parts: Any, write: Callable[[Any], Any]) -> None:
    for each in parts:
        if type(each) is _Long:
            _write(each.parts, write)
        else:
            write(each.text.encode() if type(each) is _LongText else each)
