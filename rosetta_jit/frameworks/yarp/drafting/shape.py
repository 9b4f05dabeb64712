"""What captured values have in common: the smallest type that describes them all, and how they vary.

    Shape  = Scalar | Many | Fixed | Keyed | Entries
    Scalar = tag, how many, least and greatest value or length, the value where it never varied
    Many   = one Shape for all elements, least and greatest number of them
    Fixed  = one Shape a place             a list whose elements differ in type
    Keyed  = one Shape a key               a dict with these keys
    Entries = one Shape for all values     a dict with any keys

`shape` looks at one item, `join` unites what two looks have seen. A list of one kind of element is Many even where its
length never varied: the writer of the schema says which.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from math import isnan
from struct import pack
from typing import assert_never

from rosetta_jit.frameworks.yarp.tree import Dict, Item, List, Value
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Scalar:
    """``seen`` values of one type. The bounds are of numbers, or of lengths in bytes; None where all are NaN."""

    tag: str
    seen: int
    least: int | float | None
    greatest: int | float | None
    always: Value | None


@dataclass(frozen=True, slots=True)
class Many:
    """Lists of one kind of element, ``least`` to ``greatest`` of them; no element was seen where it is None."""

    element: Shape | None
    least: int
    greatest: int


@dataclass(frozen=True, slots=True)
class Fixed:
    """Lists whose elements differ in type, place by place."""

    places: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Keyed:
    """Dicts that all have the same keys."""

    values: tuple[tuple[str, Shape], ...]


@dataclass(frozen=True, slots=True)
class Entries:
    """Dicts of various keys; no value was seen where ``value`` is None."""

    value: Shape | None


Shape = Scalar | Many | Fixed | Keyed | Entries


@dataclass(frozen=True, slots=True)
class Clash:
    """Two shapes that have nothing in common, and where: a path in field names."""

    path: str
    first: str
    second: str

    def below(self, name: str) -> Clash:
        return Clash(f".{name}{self.path}", self.first, self.second)


def shape(item: Item) -> Shape | Clash:
    """The shape of one item. Only a dict can have none: one whose elements are not (key value)."""
    match item:
        case Value():
            return _scalar(item)
        case List(items, unit):
            return _list(items, unit)
        case Dict(content):
            return _dict(content)
        case _:
            assert_never(item)


def join(first: Shape | Clash, second: Shape | Clash) -> Shape | Clash:
    """What describes everything that either of two shapes does. Takes time linear in the smaller of them."""
    match first, second:
        case (Clash(), _):
            return first
        case (_, Clash()):
            return second
        case (Scalar(), Scalar()) if first.tag == second.tag:
            return _join_scalars(first, second)
        case (Many(), Many()):
            return join_lists(first, second)
        case (Fixed(places), Fixed(others)):
            return join_places(places, others)
        case (Fixed(places), Many(element, least, greatest)) if element and least == greatest == len(places):
            return join_places(places, (element,) * least)
        case (Many(element, least, greatest), Fixed(places)) if element and least == greatest == len(places):
            return join_places((element,) * least, places)
        case (Keyed() | Entries(), Keyed() | Entries()):
            return _join_dicts(first, second)
        case _:
            return Clash("", describe(first), describe(second))


def join_lists(first: Many, second: Many) -> Many | Clash:
    """Two lists of elements of one kind each."""
    element = join_present(first.element, second.element)
    if isinstance(element, Clash):
        return element.below("[]")
    return Many(element, min(first.least, second.least), max(first.greatest, second.greatest))


def join_present(first: Shape | None, second: Shape | None) -> Shape | Clash | None:
    """The same where nothing may have been seen yet."""
    if first is None or second is None:
        return first or second
    return join(first, second)


def join_all(shapes: Iterable[Shape | Clash]) -> Shape | Clash | None:
    """What describes all shapes; None where there is none."""
    return reduce(lambda united, more: more if united is None else join(united, more), shapes, None)


def join_places(first: Sequence[Shape], second: Sequence[Shape]) -> Fixed | Clash:
    """Two lists place by place."""
    if len(first) != len(second):
        return Clash("", f"{len(first)} elements", str(len(second)))
    places: list[Shape] = []
    for index, (one, other) in enumerate(zip(first, second, strict=True)):
        joined = join(one, other)
        if isinstance(joined, Clash):
            return joined.below(f"f{index}")
        places.append(joined)
    return Fixed(tuple(places))


def describe(seen: Shape) -> str:
    """A shape in the words of a report."""
    match seen:
        case Scalar(tag):
            return tag
        case Many(None):
            return "an empty list"
        case Many(_, least, greatest):
            return f"a list of {least}" if least == greatest else f"a list of {least} to {greatest}"
        case Fixed(places):
            return f"a list of {len(places)} elements that differ in type"
        case Keyed() | Entries():
            return "a dict"
        case _:
            assert_never(seen)


def _scalar(value: Value) -> Scalar:
    extent = len(value.value) if isinstance(value.value, bytes) else value.value
    if isnan(extent):
        return Scalar(value.tag, 1, None, None, value)
    return Scalar(value.tag, 1, extent, extent, value)


def _join_scalars(first: Scalar, second: Scalar) -> Scalar:
    least = [bound for bound in (first.least, second.least) if bound is not None]
    greatest = [bound for bound in (first.greatest, second.greatest) if bound is not None]
    always = first.always if _same(first.always, second.always) else None
    return Scalar(first.tag, first.seen + second.seen, min(least, default=None), max(greatest, default=None), always)


def _same(first: Value | None, second: Value | None) -> bool:
    """Equal to the last bit: 0.0 is not -0.0, and a NaN is itself."""
    match first, second:
        case (Value(_, float(one)), Value(_, float(other))):
            return pack("<d", one) == pack("<d", other)
        case _:
            return first is not None and first == second


def _list(items: tuple[Item, ...], unit: str | None) -> Shape | Clash:
    if not items:
        return Many(None if unit is None else Scalar(unit, 0, None, None, None), 0, 0)
    shapes = [shape(item) for item in items]
    element = join_all(shapes)
    if element is not None and not isinstance(element, Clash):
        return Many(element, len(items), len(items))
    places = [place for place in shapes if not isinstance(place, Clash)]
    if len(places) == len(shapes):
        return Fixed(tuple(places))
    index, clash = next((at, place) for at, place in enumerate(shapes) if isinstance(place, Clash))
    return clash.below(f"f{index}")


def _dict(content: List) -> Shape | Clash:
    keys: list[str | None] = []
    values: list[Shape] = []
    for item in content.items:
        match item:
            case List((Value("string", bytes(key)), value)):
                seen = shape(value)
                if isinstance(seen, Clash):
                    return seen
                keys.append(_printable(key))
                values.append(seen)
            case _:
                return Clash("", "a dict of keys with one value each", "another kind of dict")
    names = [key for key in keys if key is not None]
    if names and len(set(names)) == len(keys):
        return Keyed(tuple(zip(names, values, strict=True)))
    value = join_all(values)
    return value if isinstance(value, Clash) else Entries(value)


def _printable(octets: bytes) -> str | None:
    try:
        text = octets.decode()
    except UnicodeDecodeError:
        return None
    return text if text.isprintable() else None


def _join_dicts(first: Keyed | Entries, second: Keyed | Entries) -> Shape | Clash:
    match first, second:
        case (Keyed(values), Keyed(others)) if values and dict(values).keys() == dict(others).keys():
            known = dict(others)
            joined = {key: join(value, known[key]) for key, value in values}
            seen = {key: value for key, value in joined.items() if not isinstance(value, Clash)}
            if len(seen) == len(joined):
                return Keyed(tuple(seen.items()))
            return next(value.below(key) for key, value in joined.items() if isinstance(value, Clash))
        case _:
            value = join_all(one for side in (first, second) for one in _values(side))
            return value if isinstance(value, Clash) else Entries(value)


def _values(side: Keyed | Entries) -> list[Shape]:
    match side:
        case Keyed(values):
            return [value for _, value in values]
        case Entries(value):
            return [] if value is None else [value]
