"""How functions of C begin: their parameters, constants that are tables, and pointers to the rows of lanes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.c.printing.literals import constant
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.kernel.nodes import Direction

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes
    from rosetta_jit.generate.c.printing.scope import Scope


def head(writer: Writer, text: str, scope: Scope, direction: Direction, collected: tuple[str, ...] = ()) -> None:
    """The begin of a function, with a pointer to each lane's rows behind what is ``collected`` in its own."""
    if writer.lines:
        writer.line()
    writer.line(text)
    writer.line("{")
    writer.lines += [f"    {line}" for line in collected]
    _tables(writer, scope)
    for lane in sorted(scope.touched):
        constant = "const " if lane == scope.lanes.subject and direction != "decode" else ""
        fixed = "" if lane in scope.moved else " const"
        writer.line(f"    {constant}{scope.lanes.pointer(lane)}{fixed} {scope.lanes.rows(lane)} = {scope.lanes.member(lane)};")


def _tables(writer: Writer, scope: Scope) -> None:
    """The constants of a function that are tables."""
    for (type_, values), name in scope.tables.items():
        texts = [constant(scope, type_, value, wide=True) for value in values]
        writer.line(f"    static const {C_TYPES[type_]} {name}[{len(values)}] = {{")
        writer.lines += [f"        {', '.join(texts[at : at + 8])}," for at in range(0, len(texts), 8)]
        writer.line("    };")


def declared(parameters: tuple[str, ...], direction: Direction, lanes: Lanes) -> list[str]:
    """The shared parameters of a function."""
    reads = direction != "decode"
    holder = "_source" if reads and lanes.dialect == "c++" else "_holder"
    kinds = {
        "holder": f"{'const ' if reads and lanes.dialect == 'c' else ''}{lanes.prefix}{holder} *holder",
        "given_row": f"const {lanes.type(0)} &given_row",
        "given_object": f"{lanes.objects(lanes.subject) + '::type' if lanes.subject else f'::{lanes.prefix}::holder'} &given_object",
        "bytes": f"{'' if direction == 'encode' else 'const '}unsigned char *restrict bytes",
        "end": "int64_t end",
        "failure": "struct failure *failure",
    }
    return [kinds[each] for each in parameters]
