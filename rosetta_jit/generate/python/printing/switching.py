"""Switches as Python: a match compares one case after the other, so that many cases are divided by a binary search first.

known = True                            so that the default stands once, behind the search
if tag < 130:
    match tag:
        case 10:
            ...
        case _:
            known = False
else:
    ...
if not known:
    ...
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.kernel.nodes import Block, Local, Switch

MOST = 16
"""Cases of one match: to look at half of them takes a tenth of a microsecond."""


def print_switch(function: Function, stmt: Switch, print_block: Callable[[Function, Block], None]) -> None:
    """The cases of a switch, and the default."""
    scope, value = function.scope, function.text(stmt.value)

    def case(block: Block) -> None:
        with scope.locals.case(block):
            print_block(function, block)

    def match(cases: Sequence[tuple[int, Block]], otherwise: Callable[[], None]) -> None:
        with function.writer.indented(f"match {value}:"):
            for number, block in cases:
                with function.writer.indented(f"case {number}:"):
                    case(block)
            with function.writer.indented("case _:"):
                otherwise()

    def parted(cases: Sequence[tuple[int, Block]], otherwise: Callable[[], None]) -> None:
        if len(cases) <= MOST:
            match(cases, otherwise)
            return
        middle = len(cases) // 2
        with function.writer.indented(f"if {value} < {cases[middle][0]}:"):
            parted(cases[:middle], otherwise)
        with function.writer.indented("else:"):
            parted(cases[middle:], otherwise)

    if len(stmt.cases) <= MOST or not isinstance(stmt.value, Local):
        match(stmt.cases, lambda: case(stmt.default))
        return
    known = scope.locals.identifier(f"{stmt.value.name}\0known")
    function.line(f"{known} = True")
    parted(sorted(stmt.cases, key=lambda each: each[0]), lambda: function.line(f"{known} = False"))
    with function.writer.indented(f"if not {known}:"):
        case(stmt.default)
