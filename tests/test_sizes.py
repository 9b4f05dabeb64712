"""A module is read in one sitting, a function at one look: this holds how long they are."""

from __future__ import annotations

import ast
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "rosetta_jit"

MODULE_LINES, FUNCTION_LINES = 400, 40


def test_modules_are_short():
    long = {path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.py") if path.read_bytes().count(b"\n") > MODULE_LINES}
    assert not long


def test_functions_are_short():
    """Docstrings do not count; functions within functions do."""
    long = [
        f"{path.relative_to(PACKAGE.parent)}:{node.lineno} {node.name}"
        for path in PACKAGE.rglob("*.py")
        for node in functions(ast.parse(path.read_text()))
        if lines_of(node) > FUNCTION_LINES
    ]
    assert not long, "\n".join(long)


def functions(node):
    """Those within a node, without a look into expressions, of which there are a hundred times as many."""
    for blocks in ("body", "orelse", "finalbody", "handlers", "cases"):
        for inner in getattr(node, blocks, ()):
            if isinstance(inner, ast.FunctionDef | ast.AsyncFunctionDef):
                yield inner
            yield from functions(inner)


def lines_of(function):
    first = function.body[0]
    docstring = first.end_lineno - first.lineno + 1 if ast.get_docstring(function, clean=False) is not None else 0
    return function.end_lineno - function.lineno + 1 - docstring
