"""The checks of decoders and encoders that stand in the header: what fails ends them, and says nothing of what is wrong."""

from __future__ import annotations

from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.c.printing.function import Function, lacks
from rosetta_jit.generate.c.printing.scope import Scope
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.cpp.passes.checks import IMPLIED
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.generate.passes.positions import after_binding, after_require
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.passes.fold import folded

SHARED = "rosetta_jit::detail::"
"""Where the header that all units share has what such functions call."""
MOST = 64
"""How many statements are worth to be printed wherever a message is read."""
FEW_CHECKS = 8
"""Behind more of them a compiler takes code for such as seldom runs, and makes it short, not quick, unless it is said that none fails.

Of fewer that is said where no text is looked at: a compiler then calls functions of a text that it would else put in their place."""
PARAMETERS = frozenset({"given_object", "bytes", "end"})
"""What such a function is given."""


def pointers(scope: Scope) -> list[str]:
    """The lines that declare pointers to arrays of the object whose elements statements reach."""
    lanes = scope.lanes
    return [
        f"        {lanes.type(lane)} *{'' if lane in scope.moved else 'const '}{lanes.rows(lane)} = {lanes.member(lane)};"
        for lane in sorted(scope.touched)
        if lanes.member(lane)
    ]


def is_shared(function: str) -> bool:
    """Whether the header that all units share has a function of the support."""
    return function.startswith(("load_", "store_")) or function in ("lacks", "lacks_behind", "copy_bytes")


def are_marked(block: nodes.Block) -> bool:
    """Whether the checks of a block are said to fail seldom."""
    checks = [stmt for stmt in block if isinstance(stmt, nodes.Require | nodes.Expect)]
    has_text = any(isinstance(stmt, nodes.Expect) and isinstance(stmt.condition, nodes.IsText) for stmt in checks)
    return len(checks) > FEW_CHECKS or not has_text


def check(function: Function, stmt: nodes.Stmt, otherwise: str, *, marked: bool) -> None:
    """A check, which may be said to fail seldom, or a local that one needs; ``otherwise`` is what is done where it fails.

    Of texts those that are ASCII are read at once.
    """
    condition = _failing(function, stmt)
    if condition is None:
        return
    with function.block(f"if (ROSETTA_JIT_UNLIKELY({bare(condition)}))" if marked else f"if ({bare(condition)})"):
        function.line(otherwise)


def _failing(function: Function, stmt: nodes.Stmt) -> str | None:
    """The condition under which a check fails; None of a local, which is printed, and of what other checks say."""
    scope = function.scope
    match stmt:
        case nodes.Require(at, size, failure):
            condition = None if failure == IMPLIED else lacks(function, at, size)
            function.known = after_require(function.known, at, size)
            return condition
        case nodes.Expect(nodes.IsText(nodes.Wire(at), size), _):
            where = ", ".join((scope.takes("bytes"), bare(expression(scope, at)), bare(expression(scope, size))))
            return f"!{SHARED}is_ascii({where})"
        case nodes.Expect(condition, _):
            return expression(scope, folded(nodes.Unary("not", condition)))
        case nodes.Let(name, value):
            print_block(function, (stmt,))
            function.known = after_binding(function.known, name, value)
            return None
        case _:
            raise AssertionError(stmt)
