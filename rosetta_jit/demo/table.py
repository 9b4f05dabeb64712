"""The demo's figures as a table for a person."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rosetta_jit.demo.play import Played, Report

HEADINGS = ("recording", "dialect", "messages", "bytes", "ns a message", "dynamic ns", "ratio", "cold ms", "warm ms")


def table(report: Report) -> str:
    """One line a recording; cold is a first compile, warm a load from the cache in a fresh process."""
    rows = [HEADINGS, *(_cells(played) for played in report.played)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADINGS))]
    lines = ["  ".join(_padded(cell, width, column) for column, (cell, width) in enumerate(zip(row, widths, strict=True))) for row in rows]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def _cells(played: Played) -> tuple[str, ...]:
    stream = played.stream
    return (
        stream.name,
        stream.dialect,
        f"{len(stream.messages):,}",
        f"{stream.size_bytes:,}",
        f"{played.message_ns:,.0f}",
        f"{played.dynamic_ns:,.0f}",
        f"{played.dynamic_ns / played.message_ns:,.0f} x",
        f"{played.cold_ms:.1f}",
        f"{played.warm_ms:.1f}",
    )


def _padded(cell: str, width: int, column: int) -> str:
    return cell.ljust(width) if column < 2 else cell.rjust(width)
