"""Names in stretches that are alike: those that each binds, those that it takes over from the one before it, and those that all share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm.outline import Slot
    from rosetta_jit.kernel.nodes import Scalar

    Rows = Sequence[Sequence[Slot]]


@dataclass(frozen=True, slots=True)
class Carried:
    """A name of the last stretch whose value comes from the stretch before it, where it is what ``last`` is here.

    In the first stretch it is what ``first`` is in front of the series.
    """

    name: str
    type: Scalar
    first: str
    last: str


def carried_names(rows: Rows) -> tuple[Carried, ...] | None:
    """What stretches take over; None if their names do not correspond to one another."""
    bound = {slot.name: at for at, slot in enumerate(rows[-1]) if slot.kind == "bound"}
    bound_before = {slot.name: at for at, slot in enumerate(rows[-2]) if slot.kind == "bound"}
    meanings = dict[str, Carried | None]()
    for at, slot in enumerate(rows[-1]):
        if not slot.is_use:
            continue
        names = [row[at].name for row in rows]
        if slot.name in bound:
            if names != [row[bound[slot.name]].name for row in rows]:
                return None
            continue
        meaning = None
        if any(each != slot.name for each in names):
            source = bound_before.get(slot.name)
            if source is None or slot.kind == "assigned" or names[1:] != [row[source].name for row in rows[:-1]]:
                return None
            meaning = Carried(slot.name, slot.type, names[0], rows[-1][source].name)
        if meanings.setdefault(slot.name, meaning) != meaning:
            return None
    return tuple(each for each in meanings.values() if each is not None)


def stay_inside(rows: Rows, uses: Counter[str]) -> bool:
    """Whether nobody but a stretch itself and the next one uses what it binds, of all ``uses``; the last one's names are everybody's."""
    counted = [Counter([slot.name for slot in row if slot.is_use]) for row in rows]
    return all(
        uses[slot.name] == here[slot.name] + after[slot.name]
        for row, here, after in zip(rows[:-1], counted[:-1], counted[1:], strict=True)
        for slot in row
        if slot.kind == "bound"
    )


def names_around(rows: Rows) -> list[dict[str, str]] | None:
    """What blocks use of what is bound around them: for each, what the names of the last one are there; None if they do not correspond."""
    last = rows[-1]
    bound = {slot.name: at for at, slot in enumerate(last) if slot.kind == "bound"}
    assigned = {slot.name for slot in last if slot.kind == "assigned" and slot.name not in bound}
    uses = [(at, slot.name, bound.get(slot.name)) for at, slot in enumerate(last) if slot.is_use]
    found: list[dict[str, str]] = []
    for row in rows:
        own, here = {slot.name for slot in row if slot.kind == "bound"}, dict[str, str]()
        for at, name, source in uses:
            if source is not None:
                if row[at].name != row[source].name:
                    return None
            elif row[at].name in own or here.setdefault(name, row[at].name) != row[at].name:
                return None
        times = Counter(here.values())
        if any(times[here[name]] > 1 for name in assigned):
            return None  # what is assigned is read by another name
        found.append(here)
    return found
