"""State in C: a struct with the registers of both directions, beside the holder, which has its address."""

from __future__ import annotations

from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.unit import Purpose, Role, Unit, kind_of, wire_of

MEMBERS: dict[Purpose, str] = {"decode": "unpack", "borrow": "unpack", "encode": "pack", "size": "pack"}
"""The array of the struct that has the registers of a kernel."""


def register_word(role: Role, number: int) -> str:
    """A register as the functions of a kernel reach it."""
    return f"holder->state->{MEMBERS[kind_of(role)]}[{number}]"


def state_struct(unit: Unit) -> str:
    """The struct, and the function that lets it be what it is at first; nothing where the mapping declares no state."""
    if not unit.state:
        return ""
    name = unit.name
    lines = [
        "/* What the mapping keeps from one message to the next, for each direction: integers as they are, floats by their bits. */",
        f"typedef struct {name}_state {{",
        *(f"    int64_t {member}[{len(unit.state)}];" for member in dict.fromkeys(MEMBERS.values())),
        f"}} {name}_state;",
        "",
        "/* Forgets all messages: state is what the mapping says that it is at first. Call it before the first message. */",
        f"static inline void {name}_reset({name}_state *state)",
        "{",
    ]
    for number, (variable, word) in enumerate(unit.state):
        value = "INT64_MIN" if word == -(2**63) else f"INT64_C({word})"
        lines += [f"    state->{member}[{number}] = {value}; {comment(variable)}" for member in dict.fromkeys(MEMBERS.values())]
    return "\n".join([*lines, "}", *_ages(unit)])


def _ages(unit: Unit) -> list[str]:
    """For each of several wires a function that says how old its part of a holder is."""
    lines: list[str] = []
    for wire in filter(None, map(wire_of, unit.kernels)):
        every, last = unit.arrivals[wire]
        lines += [
            "",
            f"/* How many messages of all wires have been decoded since the last one of `{wire}`; -1 before the first. */",
            f"static inline int64_t {unit.name}_age_{wire}(const {unit.name}_state *state)",
            "{",
            f"    return state->unpack[{last}] == 0 ? -1 : state->unpack[{every}] - state->unpack[{last}];",
            "}",
        ]
    return lines
