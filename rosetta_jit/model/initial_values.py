"""Initial values of new rows, for types whose initial value is not all zeros.

    InitialValue = FixedArray | FirstCase

An array whose type fixes its length has that many elements from the start, all zero; and a union whose discriminator is zero has the case
that zero selects. What may be absent gets its initial value when it comes.
"""

from __future__ import annotations

from rosetta_jit.model.layout import Layout, Row, Slot, Span, Variant
from rosetta_jit.model.limits import MAX_INITIAL_BYTES
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Optional, Schema, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass


@dataclass(slots=True, eq=False)
class FixedArray:
    """Elements of an array of fixed length: span and elements for each row.

    Attributes
    ----------
    row, word : int
        The lane of the rows, and the word in each where the span begins.
    lane, length : int
        The lane of the elements, and how many each row has.
    within : tuple of InitialValue
        The initial values of each element.
    size_bytes : int
        What it takes for one row.
    """

    row: int
    word: int
    lane: int
    length: int
    within: tuple[InitialValue, ...]
    size_bytes: int


@dataclass(slots=True, eq=False)
class FirstCase:
    """The case of a union that a discriminator of zero selects: its number in the union's case word."""

    row: int
    word: int
    number: int


InitialValue = FixedArray | FirstCase


class InitialValues:
    """The initial values of every part of a layout.

    An array whose initial elements would be too many, or contain themselves without end, begins empty.
    """

    def __init__(self, schema: Schema, layout: Layout) -> None:
        self._schema = schema
        self._layout = layout
        self._rows: dict[int, tuple[InitialValue, ...]] = {}  # by the slot's identity: the layout keeps slots alive
        self._lanes: dict[int, tuple[InitialValue, ...] | None] = {}

    def of(self, type_: Type, slot: Slot, lane: int) -> tuple[InitialValue, ...]:
        """The initial values of a type whose value comes to lie at a slot of a lane's rows."""
        return self._of(type_, slot, lane) or ()

    def of_elements(self, element: Type, lane: int) -> tuple[InitialValue, ...]:
        """The initial values of each row of a lane."""
        return self._elements(element, lane) or ()

    def _of(self, type_: Type, slot: Slot, lane: int) -> tuple[InitialValue, ...] | None:
        """As `of`; None for an array that has to begin empty."""
        value = type_.value if isinstance(type_, Optional) else type_
        match self._schema.resolve(value), slot:
            case Struct() as struct, Row():
                if id(slot) not in self._rows:
                    self._rows[id(slot)] = _affordable(self._fields(struct, slot, lane))
                return self._rows[id(slot)]
            case Array(element, int(length)), Span():
                return self._array(element, length, slot, lane)
            case Bytes(_, int(length)), Span():
                return self._array(None, length, slot, lane)
            case _:
                return ()

    def _fields(self, struct: Struct, slot: Row, lane: int) -> list[InitialValue]:
        initial: list[InitialValue] = []
        for each, member in zip(struct.fields, slot.members, strict=True):
            if isinstance(each.type, Union) and isinstance(member.slot, Variant):
                initial += self._first_case(struct, each.type, member.slot, lane)
            elif not isinstance(each.type, Optional):
                initial += self.of(each.type, member.slot, lane)
        return initial

    def _first_case(self, struct: Struct, union: Union, slot: Variant, lane: int) -> list[InitialValue]:
        number = selected(union, 0) if any(each.name == union.discriminator for each in struct.fields) else 0
        if not number:
            return []
        inside = self.of(union.cases[number - 1].type, slot.members[number - 1].slot, lane)
        return [FirstCase(lane, slot.offset // 8, number), *inside]

    def _array(self, element: Type | None, length: int, slot: Span, lane: int) -> tuple[InitialValue, ...] | None:
        within = () if element is None else self._elements(element, slot.lane)
        if within is None:
            return None
        size = length * (self._layout.lanes[slot.lane].stride + _size(within))
        if not 0 < size <= MAX_INITIAL_BYTES:
            return None if size else ()
        return (FixedArray(lane, slot.offset // 8, slot.lane, length, within, size),)

    def _elements(self, element: Type, lane: int) -> tuple[InitialValue, ...] | None:
        """As `of_elements`; None also while they are being looked for, which is where a struct contains itself."""
        if lane not in self._lanes:
            self._lanes[lane] = None
            self._lanes[lane] = self._of(element, self._layout.lanes[lane].element, lane)
        return self._lanes[lane]


def selected(union: Union, value: int) -> int:
    """The number of the case that a value of the discriminator selects, from 1 on; 0 for none."""
    for number, labels in enumerate(union.labels, 1):
        if value in labels:
            return number
    return 0 if union.default is None else union.default + 1


def selecting(union: Union, discriminator: Type, number: int) -> int:
    """The value of the discriminator that selects a case: its first label, or the first that is no other case's."""
    labels = union.labels[number - 1]
    if labels:
        return labels[0]
    taken = {label for each in union.labels for label in each}
    match discriminator:
        case Enum(_, values):
            candidates = [value for _, value in values]
        case Bool():
            candidates = [0, 1]
        case _:
            candidates = list(range(len(taken) + 1))
    return next((each for each in candidates if each not in taken), 0)


def _size(initial: tuple[InitialValue, ...]) -> int:
    return sum(each.size_bytes for each in initial if isinstance(each, FixedArray))


def _affordable(initial: list[InitialValue]) -> tuple[InitialValue, ...]:
    """Those that fit together, in order."""
    kept: list[InitialValue] = []
    total = 0
    for each in initial:
        size = each.size_bytes if isinstance(each, FixedArray) else 0
        if total + size <= MAX_INITIAL_BYTES:
            kept.append(each)
            total += size
    return tuple(kept)
