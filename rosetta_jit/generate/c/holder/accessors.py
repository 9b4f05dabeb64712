"""Functions of the header that make a holder pleasant: memory of a fixed size, new elements, and fields that may be absent."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.words import RESERVED
from rosetta_jit.generate.passes.bounds import reserved
from rosetta_jit.generate.unit import Unit, wire_of

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes
    from rosetta_jit.generate.c.holder.rows import Struct

ROWS, BYTES, SCRATCH_BYTES = 64, 1024, 4096
"""Room in a `memory` where nothing bounds what a message needs: elements, bytes of texts, bytes of scratch."""

WORDS = (
    *("span", "holder", "memory", "state", "error", "status", "decode", "borrow", "encode", "size", "use", "clear", "reset"),
    *("error_path", "status_text"),
)


def words_of(unit: Unit) -> frozenset[str]:
    """What the names of the header's types and calls are, each behind that of the unit."""
    wires = [wire for role in unit.kernels if (wire := wire_of(role))]
    return frozenset(f"{unit.name}_{word}" for word in (*WORDS, *(f"{verb}_{wire}" for verb in ("decode", "age") for wire in wires)))


def memory(unit: Unit, lanes: Lanes, hidden: int) -> str:
    """The struct of arrays for all lanes, and the function that gives them to a holder."""
    name, rooms = unit.name, [lane for lane in range(1, lanes.own) if unit.bounds[lane] != 0]
    lines = [*_constants(unit, lanes, rooms, hidden), ""]
    lines += ["/* Room for the lanes of one holder, where it need not grow. */", f"typedef struct {name}_memory {{"]
    lines += [f"    {lanes.type(lane)} {lanes.rows(lane)}[{_constant(unit, lanes, lane)}];" for lane in rooms]
    lines += [f"    int64_t scratch_{number}[({name.upper()}_SCRATCH_{number}_BYTES + 7) / 8];" for number in range(hidden)]
    lines += [f"    {name}_state state;"] if unit.state else []
    lines += [] if rooms or hidden or unit.state else ["    unsigned char nothing;"]
    lines += [f"}} {name}_memory;", "", "/* Makes a holder an empty message with that memory. */"]
    lines += [f"static inline void {name}_use({name}_holder *holder, {name}_memory *memory)", "{"]
    for lane in range(1, lanes.own):
        member = f"holder->{lanes.rows(lane)}"
        lines.append(f"    {member}.rows = {f'memory->{lanes.rows(lane)}' if lane in rooms else 'NULL'};")
        lines.append(f"    {member}.capacity = {_constant(unit, lanes, lane) if lane in rooms else 0};")
    for number in range(hidden):
        lines.append(f"    holder->scratch[{number}].bytes = (unsigned char *)memory->scratch_{number};")
        lines.append(f"    holder->scratch[{number}].size = {name.upper()}_SCRATCH_{number}_BYTES;")
    lines += [f"    {name}_reset(&memory->state);", "    holder->state = &memory->state;"] if unit.state else []
    lines += ["    holder->now = 0;", "    holder->number = 0;", f"    {name}_clear(holder);"]
    return "\n".join([*lines, *([] if rooms or hidden or unit.state else ["    (void)memory;"]), "}"])


def _constant(unit: Unit, lanes: Lanes, lane: int) -> str:
    return f"{unit.name.upper()}_{lanes.rows(lane).upper()}_ROWS"


def _constants(unit: Unit, lanes: Lanes, rooms: list[int], hidden: int) -> list[str]:
    lines = ["/* How many rows a memory has. What nothing bounds may be defined before this header is included. */"]
    for lane in rooms:
        bound = unit.bounds[lane]
        if bound is not None:
            lines.append(f"#define {_constant(unit, lanes, lane)} {bound} /* no message needs more */")
        else:
            lines += _overridable(_constant(unit, lanes, lane), BYTES if lanes.stride(lane) == 1 else ROWS)
    for number in range(hidden):
        needed = [_scratch(unit, number, lanes.own, kernel) for kernel in unit.kernels]
        known = [each for each in needed if each is not None]
        most = max(1, *known) if len(known) == len(needed) else None
        constant = f"{unit.name.upper()}_SCRATCH_{number}_BYTES"
        lines += [f"#define {constant} {most}"] if most is not None else _overridable(constant, SCRATCH_BYTES)
    return lines


def _scratch(unit: Unit, number: int, own: int, role: str) -> int | None:
    """The bytes of a hidden lane that a kernel needs at most."""
    kernel = next(each for name, each in unit.kernels.items() if name == role)
    if own + number >= len(kernel.strides):
        return 0
    rows = reserved(kernel)[own + number]
    return None if rows is None else rows * kernel.strides[own + number]


def _overridable(constant: str, value: int) -> list[str]:
    return [f"#ifndef {constant}", f"#define {constant} {value}", "#endif"]


def accessors(unit: Unit, lanes: Lanes, structs: tuple[Struct, ...]) -> str:
    """What builds messages, and asks for what may be absent."""
    taken = Namespace(RESERVED | words_of(unit) | {each.identifier for each in structs})
    parts = [_add(unit.name, lanes, lane, taken) for lane in range(1, lanes.own)]
    parts += [text for struct in structs for text in _presence(struct, taken)]
    return "".join(f"{part}\n\n" for part in parts)


def clear(name: str, lanes: Lanes) -> str:
    """The function that empties a holder."""
    lines = [f"void {name}_clear({name}_holder *holder)", "{", "    memset(&holder->message, 0, sizeof holder->message);"]
    lines += [f"    holder->{lanes.rows(lane)}.used = 0;" for lane in range(1, lanes.own)]
    return "\n".join([*lines, "}"])


def _add(name: str, lanes: Lanes, lane: int, taken: Namespace) -> str:
    rows = lanes.rows(lane)
    function = taken.identifier(f"{name}_add_{rows}")
    return f"""/* Takes rows of `{rows}` for an array or text of `count` elements. NULL where there is no room. */
static inline {lanes.type(lane)} *{function}({name}_holder *holder, {name}_span *span, int64_t count)
{{
    if (count < 0 || count > holder->{rows}.capacity - holder->{rows}.used) {{
        return NULL;
    }}
    span->start = holder->{rows}.used;
    span->count = count;
    holder->{rows}.used += count;
    return holder->{rows}.rows + span->start;
}}"""


def _presence(struct: Struct, taken: Namespace) -> list[str]:
    """Two functions for each field that may be absent."""
    texts: list[str] = []
    for member in struct.members:
        if member.presence is None:
            continue
        word, bit = divmod(member.presence, 64)
        getter, setter = (taken.identifier(f"{struct.identifier}_{verb}_{member.identifier}") for verb in ("has", "set_has"))
        texts.append(f"""static inline bool {getter}(const {struct.identifier} *row)
{{
    return (row->presence[{word}] & UINT64_C({1 << bit})) != 0;
}}

static inline void {setter}({struct.identifier} *row, bool is_there)
{{
    row->presence[{word}] &= ~UINT64_C({1 << bit});
    row->presence[{word}] |= is_there ? UINT64_C({1 << bit}) : 0u;
}}""")
    return texts
