"""The page of the use case: the angles that the component got, the commands that it sent, the last image, the routes."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING, Any

from rosetta_jit.bridge.table import rows
from rosetta_jit.runtime.looks.pixels import png

if TYPE_CHECKING:
    from pathlib import Path

    from tests.usecase.component import Seen

WIDTH, HEIGHT, MARGIN = 760, 300, 40
COLORS = ("#c0392b", "#27ae60", "#2c5aa0")
NAMES = ("yaw", "roll", "pitch")


def write(path: Path, seen: Seen, snapshot: list[dict[str, Any]], how: str) -> None:
    """One file, without anything from elsewhere."""
    picture = "" if seen.image is None else f'<img src="data:image/png;base64,{b64encode(png(seen.image)).decode()}" width="320">'
    legend = " ".join(f'<b style="color:{color}">{name}</b>' for name, color in zip(NAMES, COLORS, strict=True))
    table = escape("\n".join(rows(snapshot)))
    got = f"{len(seen.angles)} messages of joint angles and {seen.images} images arrived as RST's types"
    head = "<!doctype html><meta charset=utf-8><title>iCub and RSB</title><style>body{font:15px sans-serif;margin:2em}</style>"
    parts = (
        f"<h1>An iCub on YARP, a component on RSB</h1><p>{escape(how)}: {got}, {len(seen.commands)} commands went back.</p>",
        f"<h2>Joint angles, in radians, as the component got them: {legend}; dashed: commanded</h2>{_plot(seen)}",
        f"<h2>The last image</h2>{picture}<h2>The bridge</h2><pre>{table}</pre>",
    )
    path.write_text(head + "".join(parts), "utf-8")


def _plot(seen: Seen) -> str:
    end = max((time for time, _ in seen.angles), default=1.0)
    values = [value for _, angles in (*seen.angles, *seen.commands) for value in angles] or [0.0]
    low, high = min(values) - 0.05, max(values) + 0.05

    def at(time: float, value: float) -> str:
        x = MARGIN + time / end * (WIDTH - 2 * MARGIN)
        return f"{x:.1f},{HEIGHT - MARGIN - (value - low) / (high - low) * (HEIGHT - 2 * MARGIN):.1f}"

    shapes: list[str] = []
    for joint, color in enumerate(COLORS):
        points = " ".join(at(time, angles[joint]) for time, angles in seen.angles)
        shapes.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="2"/>')
        times = [*(time for time, _ in seen.commands), end]
        for (begin, pose), until in zip(seen.commands, times[1:], strict=True):
            line = f"{at(begin, pose[joint])} {at(until, pose[joint])}"
            shapes.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-dasharray="4 4"/>')
    return f'<svg width="{WIDTH}" height="{HEIGHT}" style="background:#f7f7f7">{"".join(shapes)}</svg>'
