"""Rows that may become objects without lists (see `late_rows`), and the classes of such objects."""

from __future__ import annotations

from collections.abc import Mapping

from rosetta_jit.generate.python.decoding.making import arrays_of
from rosetta_jit.generate.python.passes.direct import LateRow, groups_of
from rosetta_jit.generate.python.printing.late_lists import lists_of, lists_of_message, maker_without_lists, name_without_lists, print_maker
from rosetta_jit.generate.unit import Unit
from rosetta_jit.model.layout import Row
from rosetta_jit.model.types import Ref, Struct
from rosetta_jit.startup.dataclass import dataclass, field

LEAST = 16
"""Lists of a type from which on rows that have none get them late: half of the time is saved, and who asks for a list pays a sixth more."""


def late_rows(unit: Unit) -> dict[int, LateRow]:
    """The types of rows with many lists, by the lanes of arrays of them, and those of types that contain themselves."""
    found: dict[int, LateRow] = {}
    recursive = {lane: Ref(struct) for lane, struct in unit.layout.recursive}
    for lane, type_ in (arrays_of(unit) | recursive).items():
        struct, slot = unit.schema.resolve(type_), unit.layout.lanes[lane].element
        if isinstance(struct, Struct) and isinstance(slot, Row) and (lists := lists_of(struct, slot, unit, LEAST)):
            found[lane] = LateRow(struct, slot, lists)
    return found


@dataclass(frozen=True, slots=True)
class Late:
    """Classes of objects that lack lists in a module: the ``lines`` that define them, and the groups of the ``lists`` that they may lack.

    These are the fields for their numbers of elements, by lane and offset.
    """

    lines: tuple[str, ...] = ()
    lists: Mapping[tuple[int, int], int] = field(default_factory=dict[tuple[int, int], int])


def late_objects(unit: Unit, names: Mapping[str, str], decoder: str) -> Late:
    """The classes of objects that lack lists which the text of a decoder makes."""
    lines, lists = dict[str, None](), dict[tuple[int, int], int]()
    classes = [(0, names[unit.type], lists_of_message(unit), "")]
    classes += [
        (lane, names[each.struct.name], each.lists, print_maker(each, names[each.struct.name])) for lane, each in late_rows(unit).items()
    ]
    for lane, identifier, spans, maker in classes:
        without_lists = name_without_lists(identifier)
        if spans and (f"{maker_without_lists(identifier)}(" if maker else f", {without_lists}[") in decoder:
            groups = groups_of(spans)
            table = f"{without_lists} = _ByLists({identifier}, {len(groups[0])})"
            lines |= {table: None, **({f"\n\n{maker}\n": None} if maker else {})}
            lists |= {(lane, each.offset + 8): number for number, group in enumerate(groups) for each in group}
    return Late(tuple(lines), lists)
