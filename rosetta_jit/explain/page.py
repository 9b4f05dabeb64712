"""An explanation as one HTML page that needs nothing else: no script, no font, no picture from elsewhere.

Every text of the mapping and of its schemas is escaped, and the page forbids scripts besides.
"""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from pathlib import Path
from string import Template

from rosetta_jit.diagnostics import render
from rosetta_jit.explain.content import Direction, Explanation, Side
from rosetta_jit.explain.limits import MAX_LINKS
from rosetta_jit.explain.lines import Line, Names
from rosetta_jit.explain.phrases import cost, heading, kind, loss, missing, shown

ROW, HEAD = 26, 38
"""Heights of a field and of a side's head, in pixels; the template's styles use them too."""

APART = {"unpack": -2, "pack": 2}
"""How far from the middle of a field the lines of each direction end, so that neither hides the other."""


def as_page(explanation: Explanation) -> str:
    """The page as text, to be written as UTF-8."""
    template = Template(Path(__file__).with_name("page.html").read_text("utf-8"))
    last = missing(explanation)
    return template.substitute(
        title=_safe(explanation.mapping),
        row=ROW,
        head=HEAD,
        height=HEAD + ROW * max(len(explanation.wire.rows), len(explanation.holder.rows), 1),
        wire=_side(explanation.wire),
        holder=_side(explanation.holder),
        links="\n".join(_links(explanation)),
        directions="\n".join(
            [*(_direction(each, explanation) for each in explanation.directions), f"<p>{_safe(last)}</p>" if last else ""]
        ),
        warnings="\n".join(f"<pre>{escape(render(each))}</pre>" for each in explanation.warnings),
    )


def _safe(text: str) -> str:
    return escape(shown(text))


def _side(side: Side) -> str:
    framework = f' <span class="soft">{_safe(side.framework)}</span>' if side.framework else ""
    fields = [
        f'<div class="field" title="{_safe(row.path)}: {escape(kind(row))}" style="padding-left: {1.1 * len(row.names) - 0.3:.1f}rem">'
        f".{_safe(row.names[-1])} <span>{escape(kind(row))}</span></div>"
        for row in side.rows
    ]
    more = ['<div class="field"><span>and more fields</span></div>'] if side.more else []
    return "\n".join([f'<div class="side"><h3>{side.side}: {_safe(side.type)}{framework}</h3>', *fields, *more, "</div>"])


def _links(explanation: Explanation) -> list[str]:
    """A line from each field that a rule reads to each that it sets, on the wire's side at 0, on the holder's at 100."""
    heights = {
        side.side: {row.names: HEAD + ROW * n + ROW // 2 for n, row in enumerate(side.rows)}
        for side in (explanation.wire, explanation.holder)
    }
    found: dict[str, None] = {}
    for direction in explanation.directions:
        for line in direction.lines:
            wire, holder = (line.reads, line.sets) if direction.name == "unpack" else (line.sets, line.reads)
            for one, other in ((_height(a, heights["wire"]), _height(b, heights["holder"])) for a in wire for b in holder):
                if one is not None and other is not None:
                    left, right = one + APART[direction.name], other + APART[direction.name]
                    found[f'<path class="{direction.name}" d="M0 {left} C50 {left} 50 {right} 100 {right}"/>'] = None
    return list(found)[:MAX_LINKS]


def _height(names: Names, heights: dict[Names, int]) -> int | None:
    """Where a field is drawn; one that is not shown stands at the one around it."""
    return next((heights[names[:end]] for end in range(len(names), 0, -1) if names[:end] in heights), None)


def _direction(direction: Direction, explanation: Explanation) -> str:
    parts = [
        f'<h2 class="{direction.name}">{escape(heading(direction, explanation))}</h2>',
        "<table>",
        *map(_rule, direction.lines),
        "</table>",
        "<dl>",
        *_listed("lost", [loss(each) for each in direction.losses] or ["nothing"]),
        *_listed("refused", [shown(each) for each in direction.refusals]),
        *_listed("cost", cost(direction.cost)),
        "</dl>",
    ]
    return "\n".join(parts)


def _rule(line: Line) -> str:
    notes = _safe("; ".join(note.text for note in line.notes))
    return (
        f'<tr><td class="number">{line.line or ""}</td><td class="block">{_safe(line.file) or line.block}</td>'
        f'<td class="rule" style="padding-left: {line.depth * 1.4:.1f}rem">{_safe(line.text)}</td><td class="notes">{notes}</td></tr>'
    )


def _listed(name: str, items: Iterable[str]) -> list[str]:
    found = [f"<dd>{escape(item)}</dd>" for item in items]
    return [f"<dt>{name}</dt>", *found] if found else []
