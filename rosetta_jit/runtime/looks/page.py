"""Messages in a notebook: a table of their fields, arrays in short with a curve, images drawn. All that comes from messages is escaped."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from rosetta_jit.kernel.state import VALID
from rosetta_jit.model.words import field_words
from rosetta_jit.runtime.holder.message import Message
from rosetta_jit.runtime.limits import (
    MAX_PAGE_CELL,
    MAX_PAGE_COLUMNS,
    MAX_PAGE_DEPTH,
    MAX_PAGE_FIELDS,
    MAX_PAGE_IMAGE_BYTES,
    MAX_PAGE_MESSAGES,
    MAX_PAGE_PIXELS,
    MAX_PAGE_ROWS,
)
from rosetta_jit.runtime.looks.brief import brief, present_fields
from rosetta_jit.runtime.looks.pixels import png
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Rows(Protocol):
    """Messages of one type: a batch."""

    def __iter__(self) -> Iterator[Message]: ...
    def __len__(self) -> int: ...


CURVE_POINTS, CURVE_WIDTH, CURVE_HEIGHT = 100, 160, 24
CELL = "text-align:left;vertical-align:top;padding:1px 8px"
STYLE = f"{CELL};white-space:pre-wrap;max-width:60em;overflow-wrap:anywhere"
NAME = f"{CELL};white-space:nowrap"
BATCH_CELL = f"{CELL};white-space:pre-wrap;min-width:10em;max-width:30em;overflow-wrap:break-word"
TABLE = '<table style="margin:0">'
"""Notebooks put tables in the middle, away from the name above."""
MEDIA = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def page(holder: Message) -> str:
    """A message as HTML; one line of a holder that cannot be read."""
    if not holder.lanes_.words[VALID]:
        return escape(repr(holder))
    return f"<div>{''.join(_Page().message(holder, 0))}</div>"


def batch_page(batch: Rows, fields: Sequence[str]) -> str:
    """The first messages of a batch, a row each, and their first fields; one that is absent is left empty."""
    names = fields[:MAX_PAGE_COLUMNS]
    head = "".join(f'<th style="{NAME}">{escape(name)}</th>' for name in names)
    lines = "".join(f"<tr>{_cells(message, names)}</tr>" for message in islice(batch, MAX_PAGE_ROWS))
    rest = "".join(_rest(len(batch), MAX_PAGE_ROWS))
    return f'<div style="overflow-x:auto"><b>{escape(repr(batch))}</b>{TABLE}<tr>{head}</tr>{lines}</table>{rest}</div>'


def _cells(message: Message, names: Sequence[str]) -> str:
    shown = {entry.name: brief(value) for entry, value in present_fields(message, len(names))}
    texts = (shown.get(name, "") for name in names)
    cut = (text if len(text) <= MAX_PAGE_CELL else f"{text[:MAX_PAGE_CELL]}…" for text in texts)
    return "".join(f'<td style="{BATCH_CELL}">{escape(text)}</td>' for text in cut)


def failed_page(batch: Rows) -> str:
    """A batch of which nothing can be read."""
    return f"<div><b>{escape(repr(batch))}</b></div>"


@dataclass(slots=True)
class _Page:
    """The rows of one page; of a type of very many fields, or of messages in messages, the first are shown."""

    rows_left: int = MAX_PAGE_FIELDS

    def message(self, message: Message, depth: int) -> Iterator[str]:
        yield f"<b>{escape(message.access_.record.struct)}</b>"
        picture = cast("Any", message).picture_()
        if picture is not None:
            yield _picture(picture)
        rows = "".join(self.rows(message, depth))
        if rows:
            yield f"{TABLE}{rows}</table>"

    def rows(self, message: Message, depth: int) -> Iterator[str]:
        for entry, value in present_fields(message):
            if not self.rows_left:
                yield f'<tr><td style="{NAME}">…</td></tr>'
                return
            self.rows_left -= 1
            words = escape(field_words(entry.field, message.access_.family.schema))
            head = f'<th style="{NAME}">{escape(entry.name)}</th><td style="{NAME};opacity:0.6">{words}</td>'
            yield f'<tr>{head}<td style="{STYLE}">{self.value(value, depth)}</td></tr>'

    def value(self, value: Any, depth: int) -> str:
        match value:
            case Message() if depth < MAX_PAGE_DEPTH:
                return _folded(brief(value), self.message(value, depth + 1))
            case np.ndarray():
                return _array(cast("NDArray[Any]", value))
            case str() | bytes() | Mapping() | Message():
                return escape(brief(cast("Any", value)))
            case Sequence():
                items = cast("Sequence[Any]", value)
                if items and isinstance(items[0], Message) and depth < MAX_PAGE_DEPTH:
                    shown = chain.from_iterable(self.message(each, depth + 1) for each in items[:MAX_PAGE_MESSAGES])
                    return _folded(_messages(len(items)), chain(shown, _rest(len(items), MAX_PAGE_MESSAGES)))
                return escape(brief(items))
            case _:
                return escape(brief(value))


def _messages(count: int) -> str:
    return "1 message" if count == 1 else f"{count} messages"


def _rest(count: int, most: int) -> Iterator[str]:
    """How many messages are not shown."""
    if count > most:
        yield f'<div style="{CELL}">… {_messages(count - most)} more</div>'


def _folded(summary: str, parts: Iterable[str]) -> str:
    return f"<details><summary>{escape(summary)}</summary>{''.join(parts)}</details>"


def _array(array: NDArray[Any]) -> str:
    """Its begin, and of long ones the least, the greatest and the mean, with a curve."""
    text = escape(brief(array))
    if array.size <= 8 or array.dtype == np.bool_:
        return text
    numbers = array.reshape(-1).astype(np.float64)
    finite = numbers[np.isfinite(numbers)]
    if not finite.size:
        return f"{text}<br>no finite number"
    not_finite = "" if finite.size == numbers.size else f", {numbers.size - finite.size} not finite"
    summary = f"{finite.min():.6g} … {finite.max():.6g}, mean {finite.mean():.6g}{not_finite}"
    return f"{text}<br>{summary} {_curve(numbers)}"


def _curve(numbers: NDArray[np.float64]) -> str:
    """A line through some of the numbers."""
    some = numbers[np.linspace(0, numbers.size - 1, min(numbers.size, CURVE_POINTS)).astype(int)]
    some = some[np.isfinite(some)]
    if some.size < 2:
        return ""
    extent = float(some.max()) / 2 - float(some.min()) / 2 or 1.0  # halved: the difference of two floats may be none
    heights = CURVE_HEIGHT - 1 - (some / 2 - float(some.min()) / 2) / extent * (CURVE_HEIGHT - 2)
    steps = np.linspace(0, CURVE_WIDTH, some.size)
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(steps.tolist(), heights.tolist(), strict=True))
    line = f'<polyline points="{points}" fill="none" stroke="currentColor"/>'
    return f'<svg width="{CURVE_WIDTH}" height="{CURVE_HEIGHT}" style="vertical-align:middle">{line}</svg>'


def _picture(picture: NDArray[np.uint8] | bytes) -> str:
    """Pixels as PNG; what comes compressed as it came, if a browser knows it."""
    if isinstance(picture, bytes):
        media = next((media for magic, media in MEDIA.items() if picture.startswith(magic)), None)
        if media is None or len(picture) > MAX_PAGE_IMAGE_BYTES:
            return ""
        return _inline(media, picture, "")
    height, width = picture.shape[:2]
    step = max(1, -(-max(height, width) // MAX_PAGE_PIXELS))
    return _inline("image/png", png(picture[::step, ::step]), f"{width} by {height}")


def _inline(media: str, data: bytes, title: str) -> str:
    source = f"data:{media};base64,{base64.b64encode(data).decode('ascii')}"
    return f'<div><img src="{source}" title="{title}" style="max-width:{MAX_PAGE_PIXELS}px"></div>'
