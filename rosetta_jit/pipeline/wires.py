"""One of several wires of a mapping: its message, its rules, its share of the holder, and which messages have arrived.

What has arrived is state, in registers behind those that the mapping declares: how many messages in all, and of each wire the number of its
last one, from 1 on. All programs of the mapping have the same registers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import wires as words
from rosetta_jit.errors import MappingError
from rosetta_jit.language.check.wires import rules_of, share_of
from rosetta_jit.language.parameters.state import Declared
from rosetta_jit.language.typed import INT64, Binary, Const, SetState, StateVariable
from rosetta_jit.model.types import Struct
from rosetta_jit.pipeline.types import Types
from rosetta_jit.runtime.arrivals import ALL, variable_of

if TYPE_CHECKING:
    from rosetta_jit.language.check.mapping import Checked
    from rosetta_jit.language.typed import Rule
    from rosetta_jit.model.mapping import Mapping
    from rosetta_jit.model.types import Schema
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


def types_of_wire(checked: Checked, request: Request, schema: Schema, rules: tuple[Rule, ...]) -> Types:
    """The types of the program of one wire; ``rules`` are those of all wires for its direction."""
    wire, holder = wire_named(checked.mapping, request), checked.holder
    struct = checked.wire.value_type(next(each.type for each in checked.wire.root.fields if each.name == wire))
    assert isinstance(struct, Struct)
    if request.direction == "encode":
        return Types(holder.root, struct, schema, rules_of(rules, wire, "wire", holder), checked.functions, checked.state)
    own, state = rules_of(rules, wire, "holder", holder), checked.state
    wires = [each.name for each in checked.mapping.wires]
    names = [ALL, *map(variable_of, wires)]
    state = Declared({**state.initial, **dict.fromkeys(names, 0)}, {**state.types, **dict.fromkeys(names, "int64")})
    share = share_of(rules, wire, wires, holder)
    return Types(holder.root, struct, schema, (*_counting(wire, state), *own), checked.functions, state, share)


def _counting(wire: str, state: Declared) -> tuple[Rule, ...]:
    """The rules that count a message that has arrived."""
    numbers = list(state.initial)
    every, last = (StateVariable(name, numbers.index(name), "holder", INT64) for name in (ALL, variable_of(wire)))
    number = Binary("+", every, Const(1, INT64), INT64)
    return SetState(every, number), SetState(last, number)
