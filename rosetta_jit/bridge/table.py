"""The table that a bridge shows while it runs."""

from __future__ import annotations

from typing import Any

from rosetta_jit.bridge.limits import MAX_NAME, MAX_REASONS, MAX_STATE
from rosetta_jit.terminal import cells, printable

HEAD = ("route", "in /s", "out /s", "bytes /s", "p50 us", "p99 us", "sent", "waiting", "dropped", "failed")


def rows(snapshot: list[dict[str, Any]]) -> list[str]:
    """The table's lines; below each route why messages were lost, or why it does not run."""
    table = [HEAD, *map(_row, snapshot)]
    widths = [max(cells(row[column]) for row in table) for column in range(len(HEAD))]
    shown = [_line(HEAD, widths)]
    for each, row in zip(snapshot, table[1:], strict=True):
        shown.append(_line(row, widths))
        if each["problem"]:
            shown.append(f"    not running: {printable(each['problem'])}")
        if each["state"]:
            state = ", ".join(f"{name} {value}" for name, value in each["state"].items())
            shown.append(f"    state: {printable(state[:MAX_STATE])}")
        for kind in ("dropped", "failed"):
            reasons = sorted(each[kind].items(), key=lambda item: -item[1])[:MAX_REASONS]
            shown += [f"    {kind} {count}: {printable(reason[:200])}" for reason, count in reasons]
    return shown


def _row(each: dict[str, Any]) -> tuple[str, ...]:
    name = printable(each["route"])
    return (
        name if len(name) <= MAX_NAME else f"{name[: MAX_NAME - 1]}…",
        f"{each['taken_per_s']:.0f}",
        f"{each['sent_per_s']:.0f}",
        _bytes(each["bytes_per_s"]),
        "-" if each["p50_us"] is None else f"{each['p50_us']:.1f}",
        "-" if each["p99_us"] is None else f"{each['p99_us']:.1f}",
        str(each["sent"]),
        str(each["waiting"]),
        str(sum(each["dropped"].values())),
        str(sum(each["failed"].values())),
    )


def _line(row: tuple[str, ...], widths: list[int]) -> str:
    first, *rest = row
    name = first + " " * (widths[0] - cells(first))
    return "  ".join((name, *(each.rjust(width) for each, width in zip(rest, widths[1:], strict=True))))


def _bytes(number: float) -> str:
    for unit in ("", "k", "M"):
        if number < 10_000:
            return f"{number:.0f}{unit}"
        number /= 1000
    return f"{number:.1f}G"
