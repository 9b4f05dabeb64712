"""The first of several bodies of a kernel as a part of the usual call, which decodes into row 0 of a holder that has the row."""

from __future__ import annotations

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Capacity, Compare, Const, Expect, Expr, Stmt
from rosetta_jit.kernel.terms import BEGIN, ROW
from rosetta_jit.startup.dataclass import replace

NOWHERE = Const("i64", -1)
"""The place of a failure that is told only where there is no other."""


def without_row(kernel: Kernel) -> tuple[Kernel, Expect | None]:
    """The kernel whose first body takes it that the holder has the row, and the check that this was.

    It stays where a failure before it may be told instead, as one without a place never is.
    """
    body, place = kernel.bodies[0], 0
    while place < len(body) and _fails(body[place], NOWHERE) and not _asks_for_row(body[place]):
        place += 1
    row = body[place] if place < len(body) else None
    if not isinstance(row, Expect) or not _asks_for_row(row):
        return kernel, None
    return replace(kernel, bodies=(body[:place] + body[place + 1 :], *kernel.bodies[1:])), row


def _asks_for_row(stmt: Stmt) -> bool:
    """Whether a statement is the check that the holder has the row."""
    return _fails(stmt, BEGIN) and isinstance(stmt, Expect) and stmt.condition == Compare("lt", ROW, Capacity(0))


def _fails(stmt: Stmt, at: Expr) -> bool:
    """Whether a statement is a check whose failure tells a place, and nothing besides."""
    return isinstance(stmt, Expect) and stmt.failure.at == at and not stmt.failure.indices
