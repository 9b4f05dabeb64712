"""Decoders of several wires, whose messages fill one object: `decode_WIRE(data, into)` and `age_WIRE()` for each.

What arrays hold that several wires fill, and which fields are there, stays in rows of the module from one message to the next.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.python.printing.classes import member_names
from rosetta_jit.generate.shares import Ways, changed_lanes, within
from rosetta_jit.generate.unit import Role, Unit, wire_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.model.layout import Row
from rosetta_jit.model.types import Optional, Struct

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes
    from rosetta_jit.generate.python.decoding.making import Make
    from rosetta_jit.generate.python.printing.printed import Attempt


def wires_of(unit: Unit) -> dict[str, Role]:
    """The wires, if there are several, whose messages are decoded, with the roles of their kernels."""
    return {wire: role for role in unit.kernels if (wire := wire_of(role))}


def staying(unit: Unit) -> tuple[int, ...]:
    """The lanes whose rows messages leave to those of other wires."""
    return tuple(sorted({0}.union(*(changed_lanes(unit.kernels[role]) for role in wires_of(unit).values()))))


def rows_at_first(unit: Unit, lanes: Lanes) -> str:
    """The rows that stay, by the names of their lanes."""
    _, *others = staying(unit)
    words = ", ".join([f'"message": bytes({lanes.stride(0)})', *(f'"{lanes.rows(lane)}": b""' for lane in others)])
    return f'_ROWS_AT_FIRST = {{{words}}}\n_rows: dict[str, Any] = dict(_ROWS_AT_FIRST)\n"""What messages of several wires have filled."""'


def filling(make: Make, kernel: Kernel, ways: Ways) -> list[str]:
    """The function within a decoder that sets the share of its wire, and keeps the rows."""
    make.scope.from_call.add("into")
    root, slot = make.unit.schema.types[make.unit.type], make.unit.layout.root
    assert isinstance(root, Struct)
    assert isinstance(slot, Row)
    lines = [f"    {line}" for line in _set(make, root, slot, ways, "call_into")]
    for lane in changed_lanes(kernel):
        rows = make.scope.lanes.rows(lane)
        part = f"[: {make.scope.used(lane)} * {make.scope.lanes.stride(lane)}]"
        lines.append(f'    _rows["{rows}"] = {make.scope.view(lane, "")}{part}')
    return ["def filled():", *lines, '    _rows["message"] = message', "    return call_into", ""]


def _set(make: Make, struct: Struct, slot: Row, ways: Ways, at: str) -> Iterator[str]:
    """The lines that set the fields of an object."""
    for each, member, name in zip(struct.fields, slot.members, member_names(struct), strict=True):
        part, place = within(ways, each.name), f"{at}.{name}"
        if not part:
            continue
        if () in part or not isinstance(member.slot, Row):
            yield f"{place} = {make.member(each, member, slot, 0, '0')}"
            continue
        inner = make.unit.schema.resolve(each.type.value if isinstance(each.type, Optional) else each.type)
        assert isinstance(inner, Struct)
        lines = [*_set(make, inner, member.slot, part, place)]
        if member.presence is None:
            yield from lines
            continue
        yield f"if not {make.is_there(member, slot, 0, '0')}:"
        yield f"    {place} = None"
        yield "else:"
        yield f"    {place} = {make.names[inner.name]}() if {place} is None else {place}"
        yield from (f"    {line}" for line in lines)


def decoder(root: str, wire: str, attempts: tuple[Attempt, ...], from_call: list[str], arrivals: tuple[int, int]) -> str:
    """The functions that a program calls; ``from_call`` are lines for what the mapping asks of its host."""
    writer, (every, last) = Writer(), arrivals
    writer.line(f"def decode_{wire}(data: bytes | bytearray | memoryview, into: {root}) -> {root}:")
    writer.depth = 1
    said = f"Read a message of `{wire}`, and set what its messages tell of an object; raises `DecodeError`, and changes nothing then."
    most = ["most = 1048576 + 64 * end"] if any(attempt.is_bounded for attempt in attempts) else []
    for line in (f'"""{said}"""', "data = bytes(data)", "end = len(data)", *most, "call_into = into", *from_call):
        writer.line(line)
    for number, attempt in enumerate(attempts):
        with writer.indented("try:"):
            writer.line(f"return {attempt.name}({attempt.arguments()})")
        with writer.indented("except _Failed as failed:"):
            if number == 0:
                writer.line("farthest = failed")
            else:
                writer.line("if failed.site == 0 or failed.at > farthest.at:")
                writer.line("    farthest = failed")
    writer.line(f"raise _error(_decode_{wire}_SITES, farthest, end)")
    writer.depth = 0
    writer.lines += ["", ""]
    with writer.indented(f"def age_{wire}() -> int | None:"):
        writer.line(f'"""How many messages of all wires have been decoded since the last one of `{wire}`; None before the first."""')
        writer.line(f"return _UNPACK[{every}] - _UNPACK[{last}] if _UNPACK[{last}] else None")
    return writer.text()
