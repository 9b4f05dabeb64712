"""The lanes of a unit: those of its holder, named and with the structs of their rows, and the hidden ones of a kernel."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from itertools import count

from rosetta_jit.backends.printing import Namespace, joined
from rosetta_jit.generate.c.holder.accessors import words_of
from rosetta_jit.generate.c.holder.lanes import OWN_WORDS, Lane, Lanes
from rosetta_jit.generate.c.holder.rows import Structs, elements_of, paths_of
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.c.words import RESERVED, of_unit
from rosetta_jit.generate.inner_types import said_of_fields
from rosetta_jit.generate.unit import Unit
from rosetta_jit.model.layout import UNKNOWN, Number
from rosetta_jit.model.layout import Lane as LayoutLane
from rosetta_jit.startup.dataclass import replace


def own_lanes(unit: Unit) -> tuple[Structs, list[Lane]]:
    """The holder's, and the structs of their rows."""
    structs = Structs(unit.name, Namespace(RESERVED | words_of(unit) | {f"{unit.name}_source"}), said_of_fields(unit))
    named = _named(_told_apart(unit.layout.lanes), unit.name)
    elements = elements_of(unit.layout, structs, tuple(name for name, _ in named))
    return structs, [Lane(*names, lane.stride, element) for names, lane, element in zip(named, unit.layout.lanes, elements, strict=True)]


def named_lanes(unit: Unit, reserved: frozenset[str]) -> Callable[[Sequence[int]], Lanes]:
    """All of them for kernels whose rows take so many bytes each, called otherwise than what is reserved."""
    own = [replace(each, identifier=f"{each.identifier}_lane") if each.identifier in reserved else each for each in own_lanes(unit)[1]]
    renamed = _renamed(own[0])
    return lambda strides: Lanes(unit.name, (*own, *hidden_lanes(strides[len(own) :])), len(own), renamed=renamed)


def _renamed(lane: Lane) -> dict[int, str]:
    """Names for the fields of a row whose words together are those of another one: ``a.b`` and ``a_b``, a text ``s`` and ``s_start``."""
    words = {offset: joined(path) for offset, path in paths_of(lane.element)}
    times, taken = Counter(words.values()), set(words.values())
    found = dict[int, str]()
    for offset, name in words.items():
        if times[name] > 1:
            found[offset] = next(each for number in count(offset) if (each := f"{name}_{number}") not in taken)
            taken.add(found[offset])
    return found


def _named(names: Sequence[str], unit: str) -> list[tuple[str, str]]:
    """For each lane the identifiers of its pointer and of its count: variables, which hide no type of the unit's and no function."""
    scope = Namespace(RESERVED | OWN_WORDS | function_names() | of_unit(unit, names))
    pointers = ["message" if number == 0 else scope.identifier(name) for number, name in enumerate(names)]
    return [(pointer, scope.identifier(f"{pointer}\0used")) for pointer in pointers]


def _told_apart(lanes: Sequence[LayoutLane]) -> list[str]:
    """For each lane another name: an array of texts is ``name``, what its elements consist of ``name_bytes``."""
    own = [lane.name.replace(UNKNOWN, "unknown") or ("rows" if number else "") for number, lane in enumerate(lanes)]
    found, taken = list[str](), set(own)
    for lane, name in zip(lanes, own, strict=True):
        if name in found:
            wanted = f"{name}_bytes" if isinstance(lane.element, Number) and lane.element.scalar == "u8" else f"{name}_elements"
            name = next(each for number in count(1) if (each := wanted if number == 1 else f"{wanted}_{number}") not in taken)  # noqa: PLW2901
            taken.add(name)
        found.append(name)
    return found


def hidden_lanes(strides: Iterable[int]) -> list[Lane]:
    """The lanes of a kernel that are not the holder's."""
    return [Lane(f"scratch_{number}", f"scratch_{number}_used", stride, None) for number, stride in enumerate(strides)]
