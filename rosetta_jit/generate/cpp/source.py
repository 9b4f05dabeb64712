"""The source file of a unit in C++: what the class `codec` does, around the kernels, which are printed as in C."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.header import made, struct_text
from rosetta_jit.generate.c.holder.rows import Struct as RowStruct
from rosetta_jit.generate.c.source import NO_ROOM, by_order, part_tables, run, scratch_of, without_unused
from rosetta_jit.generate.c.support import support
from rosetta_jit.generate.c.texts import literal
from rosetta_jit.generate.c.words import RESERVED
from rosetta_jit.generate.cpp.decoding.arrays_in_place import arrays_in_place
from rosetta_jit.generate.cpp.decoding.lists_in_place import Opened, messages_of, opened_lists
from rosetta_jit.generate.cpp.decoding.messages_in_place import MessagesInPlace
from rosetta_jit.generate.cpp.decoding.packed import packed_structs
from rosetta_jit.generate.cpp.decoding.set_in_place import straight_numbers
from rosetta_jit.generate.cpp.encoding.messages_within import classes, collecting, collectors, has_lengths
from rosetta_jit.generate.cpp.encoding.read_in_place import is_local
from rosetta_jit.generate.cpp.encoding.reading import (
    copied,
    directs_of,
    emptying,
    encoder,
    reader,
    source_struct,
    unset,
    viewed_by,
    writes_apart,
)
from rosetta_jit.generate.cpp.header import filled_in
from rosetta_jit.generate.cpp.objects.between import between
from rosetta_jit.generate.cpp.objects.lists import row_name, row_struct, taken
from rosetta_jit.generate.cpp.objects.spots import Direct, Listed, Spot, container_type
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.passes.roundings import two_roundings
from rosetta_jit.generate.shares import WHOLE, changed_lanes
from rosetta_jit.generate.unit import Role, Unit, kind_of, wire_of, wires_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.model.types import Ref
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.c.language import Parts
    from rosetta_jit.generate.cpp.objects.manners import Manners

FOLDER = Path(__file__).parent
FILLED = "filled"
"""The memory that a decoder fills: `holder` is the class there, which compilers may warn of."""
HOLDER = "std::declval<holder &>()"
"""An object, for types."""
TOLD = {"now": "now", "number": "number", "most": "rosetta_jit::detail::most_rows(size)"}
"""What kernels are told by members of the holder, where they ask for it."""
SELDOM = re.compile(r"^static int64_t (?:fail|fail_here|full)\(", re.MULTILINE)
"""The functions that are called where something is wrong."""
SAID = """    if (where.scratch >= 0) { /* the mapping has put this text together */
        const std::size_t first = rosetta_jit::detail::indices_in(where.path);
        found.detail.assign(reinterpret_cast<const char *>(holder.scratch[where.scratch].bytes) + failure.indices[first],
                            static_cast<std::size_t>(failure.indices[first + 1]));
    }
"""


def source(unit: Unit, parts: Parts, manners: Manners, decoder: Kernel | None, inner: MessagesInPlace | None) -> str:
    """The text of the source file. ``decoder`` is the kernel that sets fields where the object, and ``inner`` messages, have them."""
    printed, lanes = parts.printed, parts.lanes
    visited = frozenset[int]() if inner is None else inner.lanes
    walks = {"decode": Walk(unit, lanes, manners, "decode", visited=visited), "encode": reader(unit, lanes, manners)}
    emptied, opened = _opened(unit, walks["decode"], inner) if "borrow" in printed else ([], [])
    given = frozenset(each.lane for each in arrays_in_place(walks["decode"], "target"))
    walks["decode"].opened = given.union(*(each.lanes for each in opened))
    walks["encode"].opened = frozenset(lane for each in opened for lane in each.containers)
    directs = {name: directs_of(walk, at) for (name, walk), at in zip(walks.items(), ("target", "source"), strict=True)}
    containers = {each.lane: each.spot.at for each in directs_of(walks["decode"], HOLDER)}
    views, filled = viewed_by(walks["encode"]), _taken(walks["decode"], "target")
    walks["decode"].taken = frozenset(each.direct.lane for each in filled)
    directs["decode"] += [each.direct for each in filled]
    directs["encode"] += [each.direct for each in views]
    listed = {each.direct.lane: each.direct.spot.at for each in _taken(walks["decode"], HOLDER)}
    kinds = {lane: kind for each in opened for lane, kind in each.kinds.items()}
    called = {name for each in printed.values() for name in each.support} | {"failure"}
    said = any(site.detail_lane is not None for kernel in unit.kernels.values() for site in kernel.sites)
    between = _walks(unit, parts, walks, directs)
    return filled_in(
        "source.cpp",
        made=made(unit),
        roundings=two_roundings(unit.kernels.values()),
        name=unit.name,
        includes=_includes(called),
        structs="\n\n".join(_struct(unit, parts, each, walks["decode"].taken) for each in parts.structs),
        asserts="\n".join(f'static_assert(sizeof({each.identifier}) == {each.size}, "no padding is added");' for each in parts.structs),
        holder=classes(walks["encode"], visited | walks["encode"].visited)
        + _row_structs(walks["encode"], [*views, *filled])
        + ("" if decoder is None else packed_structs(walks["decode"], decoder, opened))
        + _holder(unit, parts, given, containers, listed, kinds, kinds.keys() & copied(parts, directs["encode"], walks["encode"]))
        + (source_struct(unit, parts, directs["encode"], walks["encode"]) + collectors(walks["encode"]) if "encode" in printed else ""),
        support=SELDOM.sub(r"ROSETTA_JIT_COLD \g<0>", support(without_unused(called, printed))),
        kernels=_kernels(unit, parts),
        walks=between,
        lanes=_lane_names(unit, parts),
        said=SAID if said else "",
        written=", written_(new memory)" if writes_apart(unit) else "",
        functions="\n".join(_methods(unit, parts, directs, given, emptied, walks["encode"])),
    )


def _opened(unit: Unit, walk: Walk, inner: MessagesInPlace | None) -> tuple[list[str], list[Opened]]:
    """The lists of the object that become empty where a message is refused, and those that a decoder opens, also in ``inner`` messages."""
    opened = opened_lists(walk, "target")
    emptied = [each.at for each in opened if each.containers]
    emptied += [spot.at for _, _, spot in messages_of(walk, 0, unit.type, "target")]
    return emptied, [*opened, *(() if inner is None else inner.rows)]


def _kernels(unit: Unit, parts: Parts) -> str:
    """The functions of all kernels, each behind the table of its sites."""
    roles = sorted(parts.printed, key=by_order)
    return "\n\n".join(text for role in roles for text in (_table(role, unit, parts), parts.printed[role].text.rstrip()))


def _lane_names(unit: Unit, parts: Parts) -> str:
    """The lanes as paths of errors name them; hidden ones have no name."""
    names = [*(f".{each.name}" if each.name else "" for each in unit.layout.lanes), *[""] * parts.hidden]
    return ",\n    ".join(map(literal, names))


def _taken(walk: Walk, at: str) -> list[Listed]:
    """The lists that a decoder puts into the object at once, if it can; none where rows stay."""
    return [] if wires_of(walk.unit) or "borrow" not in walk.unit.kernels else taken(walk, at)


def _row_structs(walk: Walk, lists: list[Listed]) -> str:
    """What is known of the elements of lists: first of all, of those that an encoder reads within others, how it reaches them."""
    walk = replace(walk, direct=frozenset(), straight=frozenset())
    each_once = {each.direct.lane: each for each in lists}
    texts = [row_struct(walk, each.listed, container_type(each.listed.direct.spot.at)) for each in walk.within.values()]
    return "\n".join([*texts, *(row_struct(walk, each) for _, each in sorted(each_once.items()))])


def _includes(called: set[str]) -> str:
    lines = ["<cfloat>", "<cstring>", "<algorithm>", "<variant>", "<optional>"]
    lines += ["<math.h>"] if "math" in called else []
    lines += ["<inttypes.h>", "<stdio.h>", "<stdlib.h>"] if "decimals" in called else []
    return "\n".join(f"#include {each}" for each in sorted(lines))


def _struct(unit: Unit, parts: Parts, struct: RowStruct, taken: frozenset[int]) -> str:
    """As in C, without what its header has for who builds messages by hand. As a row of a list that is taken it stands for a class."""
    text = struct_text(unit.name, parts.lanes, struct, cases=False)
    is_taken = any(parts.lanes.all[lane].element == struct for lane in taken)
    return text.replace("typedef struct ", "typedef struct ROSETTA_JIT_MAY_ALIAS ", 1) if is_taken else text


def _holder(
    unit: Unit,
    parts: Parts,
    given: frozenset[int],
    containers: dict[int, str],
    listed: dict[int, str],
    opened: dict[int, str],
    gathered: Collection[int],
) -> str:
    """What kernels work on: the message's row and the lanes. ``gathered`` are opened ones of which an encoder makes rows."""
    lanes = parts.lanes
    lines = [
        "/* A message, and the elements of its arrays and texts. */",
        f"struct {unit.name}_holder {{",
        f"    {lanes.type(0)} message = {{}};",
    ]
    for lane in (each for each in range(1, lanes.own) if each not in given):
        kind = f"rosetta_jit::detail::lane<{lanes.type(lane)}>"
        if lane in containers:
            kind = f"rosetta_jit::detail::field_lane<{lanes.type(lane)}, {container_type(containers[lane])}>"
        if lane in listed:
            container, rows = container_type(listed[lane]), row_name(lanes, lane)
            lies = f"{rows}::lies<rosetta_jit::detail::element_type<{container}>>()"
            kind = f"rosetta_jit::detail::list_lane<{lanes.type(lane)}, {container}, {lies}>"
        if lane in opened:
            kind = f"rosetta_jit::detail::{opened[lane]}"
        lines.append(f"    {kind} {lanes.rows(lane)};")
    if gathered and "encode" in parts.printed:
        rows = (f"        rosetta_jit::detail::lane<{lanes.type(lane)}> {lanes.rows(lane)};" for lane in sorted(gathered))
        lines += ["    struct {", *rows, "    } gathered; /* to write a message */"]
    lines += [f"    rosetta_jit::detail::scratch scratch[{parts.hidden}];"] if parts.hidden else []
    lines += ["    int64_t most = 0; /* rows that a message may ask for */", "    int64_t now = 0;", "    int64_t number = 0;"]
    if has_lengths(unit):
        lines += ["    std::vector<unsigned char> given_place; /* where a message may be written first */"]
        lines += ["    rosetta_jit::detail::longer given_longer = {};"]
        lines += ["    int given_waits = 0; /* so many messages are measured before one is written otherwise */"]
    lines += ["    codec::state *state = nullptr;"] if unit.state else []
    return "\n".join([*lines, "};", ""])


def _table(role: Role, unit: Unit, parts: Parts) -> str:
    """The sites of a kernel, each with the parts of the message that it checks at once."""
    kernel, lines = unit.kernels[role], list[str]()
    sites = [*(kernel.sites[number] for number in parts.printed[role].sites), *([NO_ROOM] if role == "encode" else [])]
    tables = part_tables(role, sites)
    for table, name in tables.items():
        lines.append(f"const part {name}[] = {{")
        lines += [f"    {{{each.offset}, {each.size}, {each.step}, {literal(each.path)}}}," for each in table]
        lines += ["};", ""]
    lines.append(f"const site {role}_sites[] = {{")
    kinds = ["status::full", *(f"status::{each.kind}{'_' if each.kind in RESERVED else ''}" for each in sites[1:])]
    for kind, site in zip(kinds, sites, strict=True):
        texts = ", ".join(map(literal, (site.path, site.detail, site.line)))
        lines.append(f"    {{{kind}, {texts}, {scratch_of(site, parts.lanes)}, {len(site.parts)}, {tables.get(site.parts, 'nullptr')}}},")
    return "\n".join([*lines, "};"])


def _walks(unit: Unit, parts: Parts, walks: dict[str, Walk], directs: dict[str, list[Direct]]) -> str:
    """The functions between rows and classes: one for the message or a wire's share of it, and one for each lane of a recursive type."""
    texts: list[str] = []
    for name, walk in walks.items():
        roles = [role for role in unit.kernels if kind_of(role) in (("decode", "borrow") if name == "decode" else ("encode",))]
        if not roles:
            continue
        walk.direct = frozenset(each.lane for each in directs[name]) - walk.taken
        in_place = walk.visited if name == "decode" else ()
        inner = [_walk(unit, parts, walk, lane, Ref(struct)) for lane, struct in unit.layout.recursive if lane not in in_place]
        walk.straight = frozenset(row for row, _ in straight_numbers(walk).values())
        whole = [_walk(unit, parts, walk, 0, Ref(unit.type), role) for role in roles]
        texts += [*(f"{head};" for head, _ in inner), "", *(f"{head}\n{{\n{body}}}\n" for head, body in (*whole, *inner))]
    return "\n".join(texts)


def _walk(unit: Unit, parts: Parts, walk: Walk, lane: int, type_: Ref, role: Role = "") -> tuple[str, str]:
    lanes, name = parts.lanes, f"_{parts.lanes.rows(lane)}" if lane else ""
    element, row = lanes.all[lane].element, lanes.type(lane)
    if lane:
        assert isinstance(element, RowStruct)
        element = element.members[0].type
        assert isinstance(element, RowStruct)
        row = element.identifier
    reached = "row"
    if walk.direction == "decode":
        parameters = f"const {unit.name}_holder &from, const unsigned char *bytes, const {row} &row, Target &target"
        function = f"share_{wire_of(role)}" if wire_of(role) else f"fill{name}"
        head = f"template <class Target>\nvoid {function}({parameters})"
        target, unused = "target", ("from", "bytes", "row", "target")
    else:
        is_taken = lane and lane not in walk.visited
        reached = f"to.{parts.lanes.rows(lane)}.rows[at].value" if is_taken else "row"
        last = "std::int64_t at" if is_taken else f"{row} &row"
        head = f"template <class Source>\nvoid collect{name}(const Source &source, {unit.name}_source &to, {last})"
        head = head if lane not in walk.visited else collecting(walk, lane)
        target, unused = "source", ("source", "to", "at" if is_taken else "row")
    walk.writer.lines, walk.writer.depth, walk.depth, walk.in_rows = [], 1, 0, 1 if lane else 0
    walk.share = unit.shares.get(role, WHOLE)
    for each in unused:
        walk.writer.line(f"static_cast<void>({each});")
    if lane and walk.direction == "encode":
        # A row of a function's own gets a value and no bytes: a compiler then keeps its fields in registers.
        walk.writer.line("row = {};" if lane in walk.visited else f"rosetta_jit::detail::empty({reached});")
    between(walk, type_, unit.layout.lanes[lane].element, element, reached, Spot(target))
    if walk.direction == "encode" and is_local(walk, parts.printed["encode"].hidden):
        head = head.replace("\nvoid", "\nROSETTA_JIT_INLINE void")
    return head, walk.writer.text()


def _methods(
    unit: Unit, parts: Parts, directs: dict[str, list[Direct]], given: frozenset[int], emptied: list[str], walk: Walk
) -> list[str]:
    template = (FOLDER / "methods.cpp").read_text("utf-8")
    _, *sections = re.split(r"^/\* == (\w+) == \*/\n", template, flags=re.MULTILINE)
    known = dict(zip(sections[::2], sections[1::2], strict=True))
    words = {"name": unit.name, "kept": "    holder->state = &kept;" if unit.state else ""}
    into = words | {"kept": words["kept"].replace("holder", FILLED)}
    texts: list[str] = []
    lanes, printed = parts.lanes, parts.printed
    if "borrow" in printed:
        first, *others = printed["borrow"].attempts
        bound = {each.lane for each in directs["decode"]} | given
        finish = [f"    {FILLED}->{lanes.rows(each.lane)}.finish({each.row}, bytes);" for each in directs["decode"]]
        empty = [*finish, *(f"    rosetta_jit::detail::resize_to({each}, 0);" for each in emptied)]
        reset = _emptied(parts, walk, bound)
        asks = printed["borrow"].text + reset.replace(FILLED, "holder")
        texts.append(
            Template(known["decode"]).substitute(
                into,
                begin="\n".join(_told(asks)),
                bind="\n".join(f"    {FILLED}->{lanes.rows(each.lane)}.fill({each.spot.at});" for each in directs["decode"]),
                reset=reset,
                unset=unset(first),
                first=run(first, "failure", FILLED),
                others="".join(Template(known["other"]).substitute(call=run(each, "other", FILLED)) for each in others),
                finish="\n".join(finish),
                empty="\n".join(f"    {line}" for line in empty),
            )
        )
    texts += [_of_wire(unit, parts, known, role) for role in printed if wire_of(role)]
    texts += [known["reset"]] if wires_of(unit) else []
    texts += [encoder(unit, parts, known, words, directs["encode"], walk)] if "encode" in printed else []
    return [re.sub(r"\n+(\n    |\n})", r"\1", text) for text in texts]


def _emptied(parts: Parts, walk: Walk, bound: set[int]) -> str:
    """The statements that leave the lanes of a decoder without rows, but those that are ``bound`` to the object."""
    lanes, borrow = parts.lanes, parts.printed["borrow"]
    most = dict.fromkeys(walk.opened, f"{FILLED}->most")
    own = [lane for lane in range(1, lanes.own) if lane not in bound and lane in borrow.named]
    own = [lane for lane in own if lane not in most or lanes.capacity(lane) in borrow.text]
    how = {lane: f"reset({most[lane]})" if lane in most else emptying(walk, lane) for lane in own}
    return "\n".join(f"    {FILLED}->{lanes.rows(lane)}.{each};" for lane, each in how.items())


def _told(text: str) -> Iterator[str]:
    """The statements that tell a kernel, whose text this is, what it asks of the holder."""
    for name, value in TOLD.items():
        if re.search(rf"\bholder->{name}\b", text):
            yield f"    {FILLED}->{name} = {value};"


def _of_wire(unit: Unit, parts: Parts, known: dict[str, str], role: Role) -> str:
    """The decoder of one of several wires."""
    first, *others = parts.printed[role].attempts
    changed = [f"    {FILLED}->{parts.lanes.rows(lane)}.{{}}();" for lane in changed_lanes(unit.kernels[role])]
    return Template(known["wire"]).substitute(
        name=unit.name,
        wire=wire_of(role),
        kept=f"    {FILLED}->state = &kept;",
        unset=unset(first),
        first=run(first, "failure", FILLED),
        others="".join(Template(known["other"]).substitute(call=run(each, "other", FILLED)) for each in others),
        save="\n".join(each.format("save") for each in changed),
        restore="\n".join(f"    {each.format('restore')}" for each in changed),
    )
