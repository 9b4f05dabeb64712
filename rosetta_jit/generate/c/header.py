"""The header of a unit: its structs, the holder, the errors, and what calls it has."""

from __future__ import annotations

import re
from pathlib import Path
from string import Template
from textwrap import shorten
from typing import get_args

from rosetta_jit.errors import Kind
from rosetta_jit.generate.c.constants import named_values
from rosetta_jit.generate.c.holder.accessors import accessors, memory
from rosetta_jit.generate.c.holder.lanes import Lanes, row_type
from rosetta_jit.generate.c.holder.rows import Member, SpanType, Struct
from rosetta_jit.generate.c.state import state_struct
from rosetta_jit.generate.c.texts import comment
from rosetta_jit.generate.c.words import C_ROWS, C_TYPES
from rosetta_jit.generate.unit import MADE, Purpose, Unit, kind_of, wire_of

WORD = re.compile(r"\w+")
MAX_SAID = 120
"""Characters of a comment of the schema that stand beside a member."""
STATUSES = ("ok", "full", *get_args(Kind))

OF_WIRE = """/*
 * Reads a message of `{wire}` and fills its part of the holder; what messages of other wires have filled stays. Clear and reset both, as
 * {name}_use does, before the first message. FULL: a lane lacks room; give it more and call again. After another failure this part is not
 * to be read before the next message of `{wire}`.
 */
{name}_status {name}_decode_{wire}({name}_holder *holder, const void *bytes, size_t size, {name}_error *error);"""

CALLS: dict[Purpose, str] = {
    "decode": """/* Reads a message. FULL: a lane lacks room; give it more and call again. After a failure the holder is empty. */
{name}_status {name}_decode({name}_holder *holder, const void *bytes, size_t size, {name}_error *error);""",
    "borrow": """/* The same, but bytes fields stay in the message: their spans have its offset as `start`, and -1 - the size as `count`. */
{name}_status {name}_borrow({name}_holder *holder, const void *bytes, size_t size, {name}_error *error);""",
    "encode": """/* Writes a message to `bytes`, which has `capacity` of them, and says how many it took. */
{name}_status {name}_encode(const {name}_holder *holder, void *bytes, size_t capacity, size_t *size, {name}_error *error);""",
    "size": """/* How many bytes the message takes. */
{name}_status {name}_size(const {name}_holder *holder, size_t *size, {name}_error *error);""",
}


def header(unit: Unit, lanes: Lanes, structs: tuple[Struct, ...], hidden: int) -> str:
    """The text of the header."""
    template = Template(Path(__file__).with_name("header.h").read_text("utf-8"))
    status = unit.name.upper()
    filled = {
        "status": status,
        "made": made(unit),
        "name": unit.name,
        "guard": f"{status}_H",
        "statuses": "\n".join(f"    {status}_{each.upper()} = {number}," for number, each in enumerate(STATUSES)),
        "structs": "\n\n".join(struct_text(unit.name, lanes, struct) for struct in structs),
        "root": lanes.type(0),
        "state": "".join(f"{text}\n\n" for text in [state_struct(unit)] if text),
        "members": "\n".join(_members(unit, lanes, hidden)),
        "declarations": "\n\n".join(_calls(unit)),
        "memory": memory(unit, lanes, hidden),
        "accessors": accessors(unit, lanes, structs),
    }
    words = frozenset(WORD.findall(template.substitute(filled, values="")))
    return template.substitute(filled, values=named_values(unit, words))


def made(unit: Unit) -> str:
    """Comments that say from what the file was made."""
    lines = (MADE, *unit.made_from)
    return "\n".join(map(comment, lines))


def _calls(unit: Unit) -> list[str]:
    kinds = tuple(CALLS)
    roles = sorted(unit.kernels, key=lambda role: kinds.index(kind_of(role)))
    called = [(OF_WIRE if wire_of(role) else CALLS[kind_of(role)]).format(name=unit.name, wire=wire_of(role)) for role in roles]
    for function in unit.functions:
        parameters = "".join(f"{C_TYPES[each]} number_{number}, " for number, each in enumerate(function.parameters, 1))
        text = f"bool {unit.name}_{function.name}({parameters}{C_TYPES[function.result]} *result);"
        called.append(f"/* You write this function, which the mapping calls: false refuses the message. */\n{text}")
    return called


def struct_text(name: str, lanes: Lanes, struct: Struct, *, cases: bool = True) -> str:
    """The struct of a row; ``cases``: with an enum of those of a union."""
    lines = [comment(struct.shown or "an entry of a map"), f"typedef struct {struct.identifier} {{"]
    lines += [f"    {_member(name, lanes, member)}" for member in struct.members]
    lines.append(f"}} {struct.identifier};")
    if struct.cases and cases:
        lines += ["", "enum {", f"    {struct.identifier}_none = 0,"]
        lines += [f"    {struct.identifier}_is_{case} = {number}," for number, case in enumerate(struct.cases, 1)]
        lines.append("};")
    return "\n".join(lines)


def _member(name: str, lanes: Lanes, member: Member) -> str:
    match member.type:
        case str():
            text = f"{C_ROWS[member.type]} {member.identifier}{'' if member.many is None else f'[{member.many}]'};"
        case SpanType():
            text = f"{row_type(name, member.type)} {member.identifier};"
        case Struct():
            text = f"{member.type.identifier} {member.identifier};"
    said = [shorten(member.comment, MAX_SAID, placeholder=" (...)").rstrip(". ")]
    if member.lanes:
        of_path = "" if len(member.lanes) == 1 else "the lane of its path, as "
        said.append(f"in {of_path}`{lanes.rows(member.lanes[0])}`")
    if member.type == "bool":
        said.append("0, or else true")
    if member.presence is not None:
        said.append(f"only if its bit {member.presence} is set")
    told = "; ".join(filter(None, said))
    return f"{text} {comment(told)}" if told else text


def _members(unit: Unit, lanes: Lanes, hidden: int) -> list[str]:
    """The holder's members behind the message."""
    lines: list[str] = []
    for lane in range(1, lanes.own):
        lines += ["    struct {", f"        {lanes.type(lane)} *rows;", "        int64_t capacity;", "        int64_t used;"]
        lines.append(f"    }} {lanes.rows(lane)}; {comment(f'{lane}: .{unit.layout.lanes[lane].name}')}")
    if hidden:
        lines += ["    struct {", "        unsigned char *bytes;", "        int64_t size;"]
        lines.append(f"    }} scratch[{hidden}]; /* {lanes.own}: memory for the functions alone */")
    lines += [f"    {unit.name}_state *state; /* of earlier messages */"] if unit.state else []
    lines += [f"    int64_t {word}; {comment(said)}" for word, said in TOLD.items()]
    return lines


TOLD = {"now": "ns since 1970, for mappings that ask for it", "number": "of the message, for mappings that count"}
