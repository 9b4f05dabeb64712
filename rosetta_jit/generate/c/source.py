"""The source file of a unit: its functions, the tables of what can be wrong, and the calls that the header declares."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.header import STATUSES, made
from rosetta_jit.generate.c.holder.accessors import clear
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.holder.rows import Struct
from rosetta_jit.generate.c.support import support
from rosetta_jit.generate.c.texts import literal
from rosetta_jit.generate.passes.roundings import two_roundings
from rosetta_jit.generate.unit import Purpose, Role, Unit, kind_of, wire_of
from rosetta_jit.kernel.ir import Kernel, Part, Site

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.functions import Attempt, Printed

FREESTANDING = """#include <float.h>

/* Every compiler of C calls these two by itself, and needs them even where there is no library. */
void *memcpy(void *restrict target, const void *restrict source, size_t size);
void *memset(void *target, int byte, size_t size);

/* Without a library they are mere functions to a compiler; these become instructions where the bytes are few. */
#ifdef __GNUC__
#define memcpy __builtin_memcpy
#define memset __builtin_memset
#endif"""

SAID = """#ifndef {status}_NO_TEXTS
    if (site->scratch >= 0 && failure->site != 0) {{ /* the mapping has put this text together */
        const size_t first = indices_in(site->path);
        error->detail = (const char *)holder->scratch[site->scratch].bytes + failure->indices[first];
        error->detail_size = (size_t)failure->indices[first + 1];
    }}
#endif
"""
REACH = """/* As an offset; no object is larger than this. */
static int64_t reach(size_t size)
{
    const uint64_t given = size;
    return given < (UINT64_C(1) << 60) ? (int64_t)given : (INT64_C(1) << 60);
}"""
DECODE = """{name}_status {name}_{role}({name}_holder *holder, const void *bytes, size_t size, {name}_error *error)
{{
    struct failure failure = {{0, 0, {{0, 0, 0, 0}}}};
    const int64_t end = reach(size);
{unused}    int64_t result = {first};
{others}    if (result >= 0) {{
        return {status}_OK;
    }}
{emptied}    return report(error, {role}_sites, &failure, end - failure.offset, holder);
}}"""
ANOTHER = """    if (result < 0 && failure.site != 0) {{
        struct failure other = {{0, 0, {{0, 0, 0, 0}}}};
        result = {call};
        if (result < 0 && (other.site == 0 || other.offset > failure.offset)) {{
            failure = other;
        }}
    }}
"""
ENCODE = """{name}_status {name}_encode(const {name}_holder *holder, void *bytes, size_t capacity, size_t *size, {name}_error *error)
{{
    struct failure failure = {{0, 0, {{0, 0, 0, 0}}}};
    const int64_t end = reach(capacity);
{unused}    const int64_t result = {first};
{status_check}"""
MEASURED = """{name}_status {name}_encode(const {name}_holder *holder, void *bytes, size_t capacity, size_t *size, {name}_error *error)
{{
    struct failure failure = {{0, 0, {{0, 0, 0, 0}}}};
    const int64_t end = {measure}; /* which leaves the lengths of the message's parts in the scratch memory */
    if (end < 0) {{
        return report(error, size_sites, &failure, 0, holder);
    }}
    if (end > reach(capacity)) {{
        failure.site = {no_room};
        return report(error, encode_sites, &failure, 0, holder);
    }}
    const int64_t result = {first};
{status_check}"""
NO_ROOM = Site("length", "", "no room for the message", "")
SIZE = """{name}_status {name}_size(const {name}_holder *holder, size_t *size, {name}_error *error)
{{
    struct failure failure = {{0, 0, {{0, 0, 0, 0}}}};
    const int64_t result = {first};
{status_check}"""
STATUS_CHECK = """    if (result < 0) {{
        return report(error, {role}_sites, &failure, 0, holder);
    }}
    *size = (size_t)result;
    return {status}_OK;
}}"""


HEAD = re.compile(r"^/\* == (.*) == \*/\n", re.MULTILINE)
ORDER: tuple[Purpose, ...] = ("decode", "borrow", "size", "encode")


def by_order(role: Role) -> int:
    """Where the functions of a role stand among the others."""
    return ORDER.index(kind_of(role))


def source(unit: Unit, lanes: Lanes, structs: tuple[Struct, ...], printed: Mapping[Role, Printed]) -> str:
    """The text of the source file."""
    called = {name for each in printed.values() for name in each.support} | {"fail", "failure"}
    ordered = sorted(printed, key=by_order)
    functions = [
        text
        for role in ordered
        for text in (_table(role, unit, lanes, printed[role].sites), printed[role].text.rstrip(), _call(unit, role, printed))
    ]
    text = Template(Path(__file__).with_name("source.c").read_text("utf-8")).substitute(
        made=made(unit),
        roundings=two_roundings(unit.kernels.values()),
        name=unit.name,
        status=unit.name.upper(),
        number=_number(unit),
        step=f"    {_number(unit)} step;\n" if _has_steps(unit) else "",
        includes=_includes(unit, called),
        asserts="\n".join(f'_Static_assert(sizeof({each.identifier}) == {each.size}, "no padding is added");' for each in structs),
        support=support(without_unused(called, printed), small=unit.freestanding),
        lanes=",\n    ".join([*(text_literal(_shown(each.name)) for each in unit.layout.lanes), *_scratch(lanes)]),
        scratch=f"    {_number(unit)} scratch;\n" if _says(unit) else "",
        locate=_locate(unit),
        said=SAID.format(status=unit.name.upper()) if _says(unit) else "",
        functions="\n\n".join([clear(unit.name, lanes), REACH, *functions]),
        texts="\n".join(f'        "{each}\\0"' for each in STATUSES),
        last=len(STATUSES) - 1,
        count=len(STATUSES),
    )
    return re.sub(r"\n{3,}", "\n\n", text)


def without_unused(called: set[str], printed: Mapping[Role, Printed]) -> set[str]:
    """The functions that the printed ones call."""
    used = {name for each in printed.values() for name in each.support}
    return {each for each in called if each in used or each == "failure"}


def _scratch(lanes: Lanes) -> list[str]:
    return [text_literal(f"scratch[{number}]") for number in range(len(lanes.all) - lanes.own)]


def _shown(name: str) -> str:
    return f".{name}" if name else ""


def _includes(unit: Unit, called: set[str]) -> str:
    lines = [FREESTANDING] if unit.freestanding else ["#include <float.h>", "#include <string.h>"]
    lines += ["#include <math.h>"] if "math" in called else []
    lines += ["#include <inttypes.h>", "#include <stdio.h>", "#include <stdlib.h>"] if "decimals" in called else []
    return "\n".join(sorted(lines) if not unit.freestanding else lines)


def _call(unit: Unit, role: Role, printed: Mapping[Role, Printed]) -> str:
    """The function of the header that runs a kernel."""
    attempts = printed[role].attempts
    words = {"name": unit.name, "role": role, "status": unit.name.upper(), "first": run(attempts[0], "failure")}
    taken = {parameter for each in attempts for parameter in each.parameters}
    needed = {"decode": ("bytes",), "borrow": ("bytes",), "encode": ("bytes", "end"), "size": ()}[kind_of(role)]
    unused = "".join(f"    (void){each};\n" for each in needed if each not in taken)
    match kind_of(role):
        case "decode" | "borrow":
            others = "".join(ANOTHER.format(call=run(each, "other")) for each in attempts[1:])
            emptied = "" if wire_of(role) else f"    {unit.name}_clear(holder);\n"
            return DECODE.format(**words, others=others, unused=unused, emptied=emptied)
        case "encode" | "size":
            if role == "encode" and printed[role].hidden:
                words |= {"measure": run(printed["size"].attempts[0], "failure"), "no_room": str(len(printed[role].sites))}
                return MEASURED.format(**words, status_check=STATUS_CHECK.format(**words))
            return (ENCODE if role == "encode" else SIZE).format(**words, status_check=STATUS_CHECK.format(**words), unused=unused)


def run(attempt: Attempt, failure: str, holder: str = "holder") -> str:
    """The call of a printed function, with the names that variables have there."""
    names = {"failure": f"&{failure}", "given_object": "target", "holder": holder}
    arguments = (names.get(each, each) for each in attempt.parameters)
    return f"{attempt.name}({', '.join(arguments)})"


def _has_steps(unit: Unit) -> bool:
    """Whether elements of arrays are among the parts that are checked at once."""
    return any(part.step for kernel in unit.kernels.values() for site in kernel.sites for part in site.parts)


def _says(unit: Unit) -> bool:
    """Whether the mapping puts texts of errors together."""
    return any(site.detail_lane is not None for kernel in unit.kernels.values() for site in kernel.sites)


def _locate(unit: Unit) -> str:
    """The function that tells parts apart, and what it and others need."""
    _, *parts = HEAD.split(Path(__file__).with_name("locate.c").read_text("utf-8"))
    texts = {name: Template(text).substitute(name=unit.name) for name, text in zip(parts[::2], parts[1::2], strict=True)}
    if _has_steps(unit):
        return texts["indices"] + texts["elements"]
    indices = f"#ifndef {unit.name.upper()}_NO_TEXTS\n{texts['indices'].rstrip()}\n#endif\n\n" if _says(unit) else ""
    return indices + texts["fields"]


def part_tables(role: Role, sites: Iterable[Site]) -> dict[tuple[Part, ...], str]:
    """The tables of parts by what they have: sites that check the same parts share one."""
    tables: dict[tuple[Part, ...], str] = {}
    for number, site in enumerate(sites):
        if site.parts:
            tables.setdefault(site.parts, f"{role}_parts_{number}")
    return tables


def _table(role: Role, unit: Unit, lanes: Lanes, named: tuple[int, ...]) -> str:
    """The sites of a kernel, each with the parts of the message that it checks at once."""
    kernel: Kernel = unit.kernels[role]
    lines, steps = list[str](), _has_steps(unit)
    sites = [*(kernel.sites[number] for number in named), *([NO_ROOM] if role == "encode" else [])]
    tables = part_tables(role, sites)
    for parts, table in tables.items():
        lines.append(f"static const struct part {table}[] = {{")
        lines += [f"    {{{each.offset}, {each.size}, {f'{each.step}, ' if steps else ''}{text_literal(each.path)}}}," for each in parts]
        lines += ["};", ""]
    lines.append(f"static const struct site {role}_sites[] = {{")
    kinds = ["FULL", *(site.kind.upper() for site in sites[1:])]
    for kind, site in zip(kinds, sites, strict=True):
        scratch = f"{scratch_of(site, lanes)}, " if _says(unit) else ""
        texts = ", ".join(map(text_literal, (site.path, site.detail, site.line)))
        lines.append(f"    {{{unit.name.upper()}_{kind}, {scratch}{len(site.parts)}, {texts}, {tables.get(site.parts, 'NULL')}}},")
    return "\n".join([*lines, "};"])


def _number(unit: Unit) -> str:
    """The smallest type for the numbers of all tables."""
    parts = [part for kernel in unit.kernels.values() for site in kernel.sites for part in site.parts]
    lengths = [len(site.parts) for kernel in unit.kernels.values() for site in kernel.sites]
    most = max((number for part in parts for number in (part.offset, part.size, part.step)), default=0)
    return next(f"int{width}_t" for width in (16, 32, 64) if max(most, *lengths, 0) < 1 << width - 1)


def text_literal(text: str) -> str:
    """A text of an error as a literal, which a macro leaves out; an empty one as it is."""
    return f"TEXT({literal(text)})" if text else literal(text)


def scratch_of(site: Site, lanes: Lanes) -> int:
    """The scratch memory that has the text of a site; -1 where the table has it."""
    return -1 if site.detail_lane is None else site.detail_lane - lanes.own
