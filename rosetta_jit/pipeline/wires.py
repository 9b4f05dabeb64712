"""One of several wires of a mapping: its message, its rules, its share of the holder, and which messages have arrived.

What has arrived is state, in registers behind those that the mapping declares: how many messages in all, and of each wire the number of its
last one, from 1 on; then what rules that read several wires need of each one's last message. All programs of the mapping have the same
registers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import wires as words
from rosetta_jit.errors import MappingError
from rosetta_jit.language.check.across_wires import Memory, type_name
from rosetta_jit.language.check.wire_shares import share_of
from rosetta_jit.language.check.wires import kept_values, rules_of, value_of_wire
from rosetta_jit.language.parameters.state import Declared
from rosetta_jit.language.typed import BOOL, INT64, Binary, Const, Expr, Rule, SetState
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.pipeline.types import Types
from rosetta_jit.runtime.arrivals import ALL, variable_of, variable_of_value

if TYPE_CHECKING:
    from rosetta_jit.language.check.mapping import Checked
    from rosetta_jit.pipeline.request import Request


def wire_named(mapping: Mapping, request: Request) -> str:
    """The wire that a request means.

    Raises
    ------
    MappingError
        It says none, though there are several, or one that there is not; or it leaves bytes in messages.
    """
    names = [each.name for each in mapping.wires]
    if request.wire is None:
        raise MappingError((words.unsaid(mapping.wire_span, names),))
    if request.wire and request.wire not in names:
        raise MappingError((words.unknown(mapping.wire_span, request.wire, names),))
    if request.borrow:
        raise MappingError((words.cannot_borrow(mapping.wire_span),))
    return request.wire or names[0]


def arrival_registers(state: Sequence[str], wires: Sequence[str]) -> dict[str, tuple[int, int]]:
    """For each wire the registers of the numbers of the last message of all, and of its own last one; ``state`` are all variables."""
    return {wire: (state.index(ALL), state.index(variable_of(wire))) for wire in wires if ALL in state}


def types_of_wire(checked: Checked, request: Request, schema: Schema, rules: tuple[Rule, ...]) -> Types:
    """The types of the program of one wire; ``rules`` are those of all wires for its direction."""
    wire, holder = wire_named(checked.mapping, request), checked.holder
    struct = checked.wire.value_type(next(each.type for each in checked.wire.root.fields if each.name == wire))
    assert isinstance(struct, Struct)
    if request.direction == "encode":
        return Types(holder.root, struct, schema, rules_of(rules, wire, "wire", holder), checked.functions, checked.state)
    wires = [each.name for each in checked.mapping.wires]
    kept = kept_values(rules)
    state = _state(checked.state, wires, kept)
    memory = _memory(state, wires, kept)
    own = rules_of(rules, wire, "holder", holder, memory)
    keeping = (SetState(memory.values[value], value_of_wire(value, wire), value.span) for owner, value in kept if owner == wire)
    share = share_of(rules, wire, wires, holder)
    return Types(holder.root, struct, schema, (*_counting(wire, state), *own, *keeping), checked.functions, state, share)


def _state(declared: Declared, wires: Sequence[str], kept: Sequence[tuple[str, Expr]]) -> Declared:
    """The state of all programs of a mapping."""
    types = {**dict.fromkeys((ALL, *map(variable_of, wires)), "int64")}
    types |= {variable_of_value(number): type_name(value) or "" for number, (_, value) in enumerate(kept)}
    return Declared({**declared.initial, **dict.fromkeys(types, 0)}, {**declared.types, **types})


def _memory(state: Declared, wires: Sequence[str], kept: Sequence[tuple[str, Expr]]) -> Memory:
    """The state variables in which values of messages are kept."""
    variables = state.variables("holder")
    values = {value: variables[variable_of_value(number)] for number, (_, value) in enumerate(kept)}
    return Memory(values, {wire: Binary(">", variables[variable_of(wire)], Const(0, INT64), BOOL) for wire in wires})


def _counting(wire: str, state: Declared) -> tuple[Rule, ...]:
    """The rules that count a message that has arrived."""
    variables = state.variables("holder")
    every, last = variables[ALL], variables[variable_of(wire)]
    number = Binary("+", every, Const(1, INT64), INT64)
    return SetState(every, number), SetState(last, number)
