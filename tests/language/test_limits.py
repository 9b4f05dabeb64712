"""The security page lists the limits of the language as `language.limits` has them, and no other module of the language has one."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from rosetta_jit.language import limits
from tests.golden import check_golden

ROOT = Path(__file__).parents[2]
LIMITS = ROOT / "rosetta_jit" / "language" / "limits.py"
PAGE = ROOT / "docs" / "security.md"


def rows():
    """Each limit with what it is of."""
    body = ast.parse(LIMITS.read_text()).body
    for number, node in enumerate(body):
        if isinstance(node, ast.Assign):
            yield ast.get_docstring(ast.Module([body[number + 1]], [])), getattr(limits, node.targets[0].id)


def shown(value):
    if value > 1 << 60:
        return f"2^{value.bit_length() - 1}"
    for power, unit in ((40, "Ti"), (20, "Mi")):
        if value >= 1 << power and not value % (1 << power) and value < 1 << power + 20:
            return f"{value >> power} {unit}"
    return f"{value:,}"


def test_the_page_lists_them():
    table = "\n".join(["| of | at most |", "|---|---|", *(f"| {what} | {shown(value)} |" for what, value in rows())])
    text = PAGE.read_text("utf-8")
    marked = re.compile(r"(<!-- limits of the language[^\n]*\n).*?(\n<!-- end of limits -->)", re.DOTALL)
    assert len(marked.findall(text)) == 1
    check_golden(PAGE, marked.sub(lambda match: f"{match[1]}{table}{match[2]}", text))


def test_there_are_no_others():
    wrong = [
        path
        for room in ("language", "functions")
        for path in (ROOT / "rosetta_jit" / room).rglob("*.py")
        if path != LIMITS and re.search(r"^MAX_\w+ *=", path.read_text(), re.MULTILINE)
    ]
    assert not wrong
