"""Lists within lists whose elements an encoder of C++ reads where an object has them: the start of such a span is the address of its list.

The index of one of its rows is therefore that address plus the number of an element: `address + i`.
"""

from __future__ import annotations

from rosetta_jit.generate.passes.positions import difference
from rosetta_jit.kernel.nodes import Binary, Expr, Get, Local, Place
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import index
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Within:
    """The lists of a lane: ``view`` is the type of what shows one; their spans lie at ``offset`` in rows of ``lane``.

    ``starts`` are the locals of kernels that have the address of one.
    """

    view: str
    lane: int
    offset: int
    starts: frozenset[str]

    def is_start(self, expr: Expr) -> bool:
        """Whether an expression reads the address of such a list."""
        match expr:
            case Get("i64", Place(lane, _, offset)):
                return (lane, offset) == (self.lane, self.offset)
            case _:
                return False


def element_of(row: Expr, within: Within) -> tuple[Expr, Expr] | None:
    """The address of a list, and the number of its element that is a row; None where a row does not say these."""
    match row:
        case Get() if within.is_start(row):
            return row, index(0)
        case Binary("add", start, number) if within.is_start(start):
            return start, number
        case _:
            starts = [Local("i64", name) for name in sorted(locals_in(row) & within.starts)]
            parts = ((start, difference(row, start)) for start in starts)
            return next(((start, number) for start, number in parts if number is not None), None)
