"""A unit as C++: `NAME.hpp`, `NAME.cpp`, and the header that all such files share."""

from __future__ import annotations

from pathlib import Path

from rosetta_jit.catalogue import generate as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.language import parts_of
from rosetta_jit.generate.c.printing.functions import Printed, print_kernel
from rosetta_jit.generate.cpp.decoding.at_once import at_once, of_no_elements_at_once
from rosetta_jit.generate.cpp.decoding.decoder import decoder_of, open_decoder_of
from rosetta_jit.generate.cpp.decoding.messages_in_place import MessagesInPlace, messages_in_place
from rosetta_jit.generate.cpp.encoding.messages_within import descents_of
from rosetta_jit.generate.cpp.encoding.put_at_once import put_at_once
from rosetta_jit.generate.cpp.encoding.reading import copied_lanes, directs_of, reader, viewed_by
from rosetta_jit.generate.cpp.header import AtOnce, header
from rosetta_jit.generate.cpp.objects.manners import MANNERS, Manners
from rosetta_jit.generate.cpp.passes.opened import without_asking, without_counting
from rosetta_jit.generate.cpp.source import source
from rosetta_jit.generate.passes.cleared import without_clearing
from rosetta_jit.generate.passes.undamaged import SPANS, undamaged_kernel
from rosetta_jit.generate.unit import Role, Unit, kind_of, wire_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.model.types import Struct
from rosetta_jit.startup.dataclass import replace

INCLUDE = Path(__file__).with_name("include")
SHARED = "rosetta_jit/rosetta_jit.hpp"


def files(unit: Unit) -> dict[str, str]:
    """The texts of the files by their names."""
    manners = _manners(unit)
    inner = messages_in_place(unit, manners)
    unit = without_clearing(unit) if inner is None else without_clearing(inner.of_message(unit), inner.unused)
    parts = parts_of(unit, lambda kernel, lanes, role: _printed(unit, manners, kernel, lanes, role, inner), dialect="c++")
    decoder = decoder_of(unit, manners, unit.kernels["borrow"], parts.lanes, inner) if "borrow" in unit.kernels else None
    short = decoder if decoder is None or inner is None else inner.without(*decoder)
    reads_empty, apart = "" if short is None else of_no_elements_at_once(*short), short
    if inner is None and short is not None:
        apart = open_decoder_of(unit, manners, parts.lanes)
    there = AtOnce(
        *(("", 0) if short is None or apart is None else at_once(*short, apart, reads_empty)),
        reads_empty,
        *(put_at_once(unit, manners, parts.lanes) if "encode" in unit.kernels else ("", "", ())),
    )
    return {
        f"{unit.name}.hpp": header(unit, manners, there),
        f"{unit.name}.cpp": source(unit, parts, manners, None if decoder is None else decoder[0], inner),
        SHARED: (INCLUDE / SHARED).read_text("utf-8"),
    }


def _manners(unit: Unit) -> Manners:
    """Whose classes are filled, if the unit's type has such, and what stands around them goes with its kernels."""
    manners = {each.name: each for each in MANNERS}.get(unit.holder or "own")
    if manners is None:
        raise SchemaError((words.unknown_holder(unit.holder, tuple((each.name, each.summary) for each in MANNERS)),))
    if unit.include and manners.header is None:
        raise SchemaError((words.needless_header(manners.name),))
    if manners.framework not in ("", unit.framework) and not unit.include:
        known = tuple(each.name for each in MANNERS if each.name == "own" or each.framework == unit.framework)
        raise SchemaError((words.of_another_framework(manners.name, unit.type, unit.framework, known),))
    structs = [each for each in unit.schema.types.values() if isinstance(each, Struct)]
    if manners.type is not None and f"::{unit.name}" in map(manners.type, structs):
        raise SchemaError((words.name_of_a_class(unit.name),))
    if manners.around and any(map(wire_of, unit.kernels)):
        raise SchemaError((words.wires_around(manners.name),))
    if manners.around and (lacking := [each for each in ("encode", "borrow") if each not in unit.kernels]):
        raise SchemaError((words.one_way_around(manners.name, "decode" if lacking[0] == "borrow" else "encode"),))
    return manners


def _printed(unit: Unit, manners: Manners, kernel: Kernel, lanes: Lanes, role: Role, inner: MessagesInPlace | None) -> Printed:
    """The functions of a kernel; those of encoders are given the message's row, and addresses, those of decoders the object.

    ``inner`` are messages within others that decoders read in place.
    """
    origins = unit.origins.get(role, ())
    if kind_of(role) in ("encode", "size"):
        walk, kernel = reader(unit, lanes, manners), undamaged_kernel(kernel)
        views, within = frozenset(each.direct.lane for each in viewed_by(walk)), {lane: each.within for lane, each in walk.within.items()}
        descents = descents_of(unit).get(role)
        forward = descents is not None or not unit.layout.recursive
        lanes = replace(lanes, addressed=walk.addressed, viewed=views, within=within, row=True, forward=forward)
        moving = frozenset(copied_lanes(lanes, directs_of(walk, "source"), walk)) - views
        return print_kernel(kernel, replace(lanes, moving=moving), role, origins, () if descents is None else (descents,))
    found, lanes = decoder_of(unit, manners, kernel, lanes, inner)
    found = without_asking(undamaged_kernel(found, SPANS), lanes.opened)
    found = found if wire_of(role) else without_counting(found, lanes.given)
    return print_kernel(found, lanes, role, origins, () if inner is None else inner.parted(found))
