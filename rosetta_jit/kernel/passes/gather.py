"""Checks that stand together become one; only where that one fails, they are made one by one, so that the first that fails says so.

Of a list that must have the elements 0, 1, 2, … the last is asked for. Two numbers of 4 bytes, one behind the other in the message, are
compared as one of 8. As in `hoist` a check may move up; between those that move nothing else may fail, so that which failure comes first
stays as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Compare, Const, Copy, Expect, Expr, Fill, If, Let, Load, Local, SetField, Stmt, Store, Unary
from rosetta_jit.kernel.rewrite import locals_in, reads_memory, with_blocks, with_bodies
from rosetta_jit.kernel.terms import add
from rosetta_jit.startup.dataclass import dataclass, field

FEWEST = 3
"""Elements for which it pays to ask for the last one first."""

_HALF = (1 << 32) - 1

_CANNOT_FAIL = Let | Store | SetField | Copy | Fill
"""What may stand between checks that move. None of it changes a variable."""


@dataclass(slots=True)
class _Chain:
    """Checks, each that a number lies below a count, one number above the other: by their places in a block.

    ``bound`` are the names that were bound since the first of them.
    """

    count: Local
    highest: int
    checks: dict[int, Expect]
    bound: set[str] = field(default_factory=set[str])

    def takes(self, check: Expect, number: int, count: Local) -> bool:
        """Whether a check is one more, and can stand where the first does."""
        told = (check.failure.at, *check.failure.indices)
        return count == self.count and number > self.highest and not any(map(self._depends, told))

    def _depends(self, expr: Expr) -> bool:
        return reads_memory(expr) or not self.bound.isdisjoint(locals_in(expr))


def gather(kernel: Kernel) -> Kernel:
    """The kernel with fewer checks on the usual way."""
    return with_bodies(kernel, tuple(map(_block, kernel.bodies)))


def _block(block: Block) -> Block:
    made = _in_pairs(block)
    for chain in _chains(block):
        if len(chain.checks) >= FEWEST:
            made |= dict.fromkeys(chain.checks, ())
            made[min(chain.checks)] = _last_first(tuple(chain.checks.values()))
    return tuple(part for place, stmt in enumerate(block) for part in made.get(place, (with_blocks(stmt, _block),)))


# --- elements of a list --------------------------------------------------------------------------------------------------


def _chains(block: Block) -> list[_Chain]:
    found: list[_Chain] = []
    chain: _Chain | None = None
    for place, stmt in enumerate(block):
        match stmt:
            case Expect(Compare("lt", Const("i64", value), Local("i64") as count)):
                number = int(value)
                if chain is None or not chain.takes(stmt, number, count):
                    chain = _Chain(count, number, {})
                    found.append(chain)
                chain.checks[place], chain.highest = stmt, number
            case Let(name) if chain is not None:
                chain.bound.add(name)
            case _ if not isinstance(stmt, _CANNOT_FAIL):
                chain = None
            case _:
                pass
    return found


def _last_first(checks: Sequence[Expect]) -> Block:
    """All of them where that of the highest number fails."""
    return (If(Unary("not", checks[-1].condition), tuple(checks)),)


# --- numbers side by side ------------------------------------------------------------------------------------------------


def _in_pairs(block: Block) -> dict[int, Block]:
    """What stands in place of checks of two numbers, by the checks' places."""
    made: dict[int, Block] = {}
    for place, (first, second) in enumerate(pairwise(block)):
        if type(first) is type(second) is Expect and place not in made and (whole := _compared(first, second)) is not None:
            made[place], made[place + 1] = (If(Unary("not", whole), (first, second)),), ()
    return made


def _compared(first: Stmt, second: Stmt) -> Compare | None:
    """The comparison of 8 bytes that holds where both checks do, of 4 bytes each, one behind the other."""
    match first, second:
        case (
            Expect(Compare("eq", Load("i32", at, "<"), Const(_, low))),
            Expect(Compare("eq", Load("i32", behind, "<"), Const(_, high))),
        ) if behind == add(at, 4):
            return Compare("eq", Load("u64", at), Const("u64", (int(high) & _HALF) << 32 | (int(low) & _HALF)))
        case _:
            return None
