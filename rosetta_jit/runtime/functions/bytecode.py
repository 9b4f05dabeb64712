"""What code names: `pkg.consts.K * SCALE` names the global `pkg` with the attributes `consts` and `K`, and the global `SCALE`.

Code of nested functions is part of the code that contains them. Only instructions that are known are believed: a name that any other
instruction uses is given as `strange`.
"""

from __future__ import annotations

import dis
from itertools import takewhile
from types import CodeType
from typing import TYPE_CHECKING, Literal

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ATTRIBUTES = frozenset(("LOAD_ATTR", "LOAD_METHOD"))
SILENT = frozenset(("EXTENDED_ARG", "CACHE", "NOP"))
"""Instructions that may stand between a value and the attribute that is taken of it."""

LOCAL = frozenset(("MAKE_CELL", "LOAD_CLOSURE", "STORE_DEREF", "DELETE_DEREF", "STORE_ATTR"))
"""Instructions that have a name and reach nothing outside by it."""

_NAMING = frozenset((*dis.hasname, *dis.hasfree))


@dataclass(frozen=True, slots=True)
class Named:
    """One use of a name: of a global, of a cell of the closure, or in an instruction that is not known."""

    kind: Literal["global", "cell", "strange"]
    name: str
    attributes: tuple[str, ...] = ()


def named(code: CodeType) -> Iterator[Named]:
    """All uses of names, in code and in the code within it."""
    instructions = [each for each in dis.get_instructions(code) if each.opname not in SILENT]
    for position, instruction in enumerate(instructions):
        if instruction.opcode in _NAMING:
            yield from _use(instructions, position)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from named(constant)


def _use(instructions: Sequence[dis.Instruction], position: int) -> Iterator[Named]:
    operation, name = instructions[position].opname, str(instructions[position].argval)
    if operation in ("LOAD_GLOBAL", "LOAD_DEREF"):
        following = takewhile(lambda each: each.opname in ATTRIBUTES, instructions[position + 1 :])
        yield Named("global" if operation == "LOAD_GLOBAL" else "cell", name, tuple(str(each.argval) for each in following))
    elif operation not in ATTRIBUTES and operation not in LOCAL:
        yield Named("strange", name)
