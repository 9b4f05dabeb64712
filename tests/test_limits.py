"""The security page lists the limits of each room as its `limits` has them, and no other module of those rooms has one."""

from __future__ import annotations

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

from tests.golden import check_golden

ROOT = Path(__file__).parents[1]
CODE = ROOT / "rosetta_jit"
PAGE = ROOT / "docs" / "security.md"
FRAMEWORKS = {
    "yarp": ("yarp",),
    "protobuf": ("protobuf",),
    "ros": ("ros", "ros1", "ros2"),
    "omg": ("omg", "corba"),
    "lcm": ("lcm",),
    "orocos": ("orocos",),
}
ROOMS = {
    "language": ("language", "functions"),
    **{f"frameworks/{name}": tuple(f"frameworks/{each}" for each in rooms) for name, rooms in FRAMEWORKS.items()},
    **{room: (room,) for room in ("parsing", "model", "lowering", "kernel", "runtime", "catalogue", "pipeline", "explain", "draft")},
    **{room: (room,) for room in ("transports", "bridge", "logs")},
}
"""Where limits stand, and the rooms that they are of."""


def rows(room):
    """Each limit with what it is of."""
    limits = import_module(f"rosetta_jit.{room.replace('/', '.')}.limits")
    body = ast.parse(Path(limits.__file__).read_text()).body
    for number, node in enumerate(body):
        if isinstance(node, ast.Assign):
            yield ast.get_docstring(ast.Module([body[number + 1]], [])), getattr(limits, node.targets[0].id)


def shown(value):
    if value > 1 << 60:
        return f"2^{value.bit_length() - 1}"
    for power, unit in ((40, "Ti"), (30, "Gi"), (20, "Mi")):
        if value >= 1 << power and not value % (1 << power) and value < 1 << power + 20:
            return f"{value >> power} {unit}"
    return f"{value:,}"


def with_table(text, room):
    table = "\n".join(["| of | at most |", "|---|---|", *(f"| {what} | {shown(value)} |" for what, value in rows(room))])
    marked = re.compile(rf"(<!-- limits of [^\n]*rosetta_jit/{room}/limits.py[^\n]*\n).*?(<!-- end of limits -->)", re.DOTALL)
    assert len(marked.findall(text)) == 1
    return marked.sub(lambda match: f"{match[1]}{table}\n{match[2]}", text)


def test_the_page_lists_them():
    text = PAGE.read_text("utf-8")
    for room in ROOMS:
        text = with_table(text, room)
    check_golden(PAGE, text)


@pytest.mark.parametrize("room", ROOMS)
def test_there_are_no_others(room):
    limits = CODE / room / "limits.py"
    files = [path for each in ROOMS[room] for path in (CODE / each).rglob("*.py") if path != limits]
    assert not [path for path in files if re.search(r"^MAX_\w+ *[=,]", path.read_text(), re.MULTILINE)]
