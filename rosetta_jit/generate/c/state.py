"""State in C: a struct with the registers of both directions, beside the holder, which has its address."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.texts import comment

if TYPE_CHECKING:
    from rosetta_jit.generate.unit import Role, Unit

MEMBERS: dict[Role, str] = {"decode": "unpack", "borrow": "unpack", "encode": "pack", "size": "pack"}
"""The array of the struct that has the registers of a kernel."""


def register_word(role: Role, number: int) -> str:
    """A register as the functions of a kernel reach it."""
    return f"holder->state->{MEMBERS[role]}[{number}]"


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
    return "\n".join([*lines, "}"])
