"""The definitions of a function of several values: lines of `name = expression` → pairs of the model.

Expressions are those of the mapping language. Its names are what lines before define, and the components of the parameters: `q.x`.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError
from rosetta_jit.language.parse.rules import Context, read_expression
from rosetta_jit.language.parse.templates import expression_tree
from rosetta_jit.model.expr import Expr
from rosetta_jit.source import Source, Span


def read_definitions(name: str, text: str) -> Iterator[tuple[str, Expr]]:
    """The names that a text defines, each with its expression, in order; ``name`` is the function's.

    Raises
    ------
    MappingError
        A line is no definition.
    """
    source = Source(name, text)
    at = 0
    for line in text.splitlines(keepends=True):
        defined, _, expression = line.partition(" = ")
        problems: list[Diagnostic] = []
        if expression:
            start = at + len(line) - len(expression)
            tree = expression_tree(expression.rstrip("\n"), Span(source, start, at + len(line)), problems)
            if tree is None:
                raise MappingError(tuple(problems))
            yield defined.strip(), read_expression(tree, Context(source, "holder", "wire", problems))
        at += len(line)
