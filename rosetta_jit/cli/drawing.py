"""Curves as text: dots of Braille where the terminal has them, else one `*` a character."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rosetta_jit.logs.curves import Curve

DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""The bits of a character of Braille, from U+2800 on, by row and column."""

LABEL = 11
"""Characters in front of a line."""


def drawn(curve: Curve, span_ns: tuple[int, int], width: int, height: int, *, braille: bool) -> list[str]:
    """The lines of a picture of a curve: its name and unit, ``height`` lines of dots, and the seconds below them."""
    first, last = span_ns
    columns = max(width - LABEL - 1, 2)
    across, down = (2, 4) if braille else (1, 1)
    finite = np.isfinite(curve.values)
    values, times = curve.values[finite], curve.times_ns[finite]
    if not len(values):
        return [curve.title, " " * LABEL + "no values"]
    least, greatest = float(values.min()), float(values.max())
    extent = greatest - least or 1.0
    x = ((times - first) / max(last - first, 1) * (columns * across - 1)).astype(np.int64)
    y = np.rint((greatest - values) / extent * (height * down - 1)).astype(np.int64)
    if greatest == least:
        y[:] = height * down // 2
    cells = np.zeros((height, columns), np.int64)
    np.bitwise_or.at(cells, (y // down, x // across), DOTS[y % down, x % across] if braille else 1)
    labels = {0: f"{greatest:.5g}", height - 1: f"{least:.5g}"}
    lines = [f"{labels.get(row, ''):>{LABEL - 1}} {_line(cells[row], braille=braille)}".rstrip() for row in range(height)]
    end = f"{(last - first) / 1e9:.6g} s"
    return [curve.title, *lines, f"{' ' * LABEL}0 {end:>{columns - 2}}"]


def _line(cells: np.ndarray[tuple[int], np.dtype[np.int64]], *, braille: bool) -> str:
    if braille:
        return "".join(chr(0x2800 + cell) if cell else " " for cell in cells.tolist())
    return "".join("*" if cell else " " for cell in cells.tolist())
