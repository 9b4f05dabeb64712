"""Drafts a bottle schema from captured messages: what they have in common as types, what varies as comments."""

from __future__ import annotations

from collections.abc import Iterable

from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.drafting.draft import draft
from rosetta_jit.frameworks.yarp.drafting.shape import Clash, Fixed, Many, Shape, join_all, join_lists, join_places, shape
from rosetta_jit.frameworks.yarp.limits import MAX_PLACES
from rosetta_jit.frameworks.yarp.names import TYPE_NAME
from rosetta_jit.frameworks.yarp.tags import DIALECTS, YARP3, YARP4, YARP2012, Dialect, vocab
from rosetta_jit.frameworks.yarp.tree import Dict, Item, List, Value
from rosetta_jit.startup.dataclass import dataclass

ANY = "yarp"
"""The encoding that is any of the dialects."""


def infer(messages: Iterable[bytes], *, name: str, encoding: str = "yarp") -> str:
    """A bottle schema that describes every one of the messages, as text.

    Fields are named by their place: ``f0``, ``f1``, and ``f2.f0`` within a list. Elements of one type are a list, and of
    that length if it never varied; a vocab that never varied is a constant; comments say what else was seen.

    Parameters
    ----------
    messages
        One message each, of at least one message in all.
    name
        Of the type to declare.
    encoding
        ``yarp2012``, ``yarp3``, ``yarp4``, or ``yarp`` to find it out message by message.

    Raises
    ------
    DecodeError
        Where one is no bottle; the detail says which.
    SchemaError
        Where two have no type in common, with the number of the message and the place in it.
    """
    if not TYPE_NAME.fullmatch(name):
        raise SchemaError((catalogue.invalid_name(None, name),))
    if encoding != ANY and encoding not in DIALECTS:
        raise SchemaError((catalogue.unknown_dialect(encoding, (ANY, *DIALECTS)),))
    number = 0
    common: _Common | None = None
    for number, message in enumerate(messages, 1):
        seen = _look(_read(message, encoding, number), number)
        common = seen if common is None else _unite(common, seen, number)
    if common is None:
        raise SchemaError((catalogue.no_messages(),))
    return draft(name, _top(common), number)


@dataclass(frozen=True, slots=True)
class _Common:
    """What messages have in common, taken place by place, and taken as elements of one list."""

    places: Fixed | Clash
    elements: Many | Clash


def _read(message: bytes, encoding: str, number: int) -> List:
    try:
        return read_any(message)[1] if encoding == ANY else read(message, DIALECTS[encoding])
    except DecodeError as error:
        raise DecodeError(error.kind, error.path, f"message {number}: {error.detail}", error.offset) from None


def _look(bottle: List, number: int) -> _Common:
    places: list[Shape] = []
    for index, item in enumerate(bottle.items):
        seen = shape(item)
        if isinstance(seen, Clash):
            raise SchemaError((catalogue.undescribable_message(number, f".f{index}{seen.path}", seen.first, seen.second),))
        places.append(seen)
    empty = shape(bottle) if not places else None
    element = empty.element if isinstance(empty, Many) else join_all(places)
    many = element if isinstance(element, Clash) else Many(element, len(places), len(places))
    return _Common(Fixed(tuple(places)), many)


def _unite(common: _Common, seen: _Common, number: int) -> _Common:
    places = _unite_places(common.places, seen.places)
    elements = _unite_elements(common.elements, seen.elements)
    if isinstance(places, Clash) and isinstance(elements, Clash):
        raise SchemaError((catalogue.unlike_messages(number, places.path, places.first, places.second),))
    return _Common(places, elements)


def _unite_places(first: Fixed | Clash, second: Fixed | Clash) -> Fixed | Clash:
    match first, second:
        case (Fixed(places), Fixed(others)):
            return join_places(places, others)
        case (Clash(), _):
            return first
        case _:
            return second


def _unite_elements(first: Many | Clash, second: Many | Clash) -> Many | Clash:
    match first, second:
        case (Many(), Many()):
            return join_lists(first, second)
        case (Clash(), _):
            return first
        case _:
            return second


def _top(common: _Common) -> Fixed | Many:
    match common.places, common.elements:
        case (Fixed(places), Many(element)) if len(places) > MAX_PLACES or (element and not places):
            return common.elements
        case (Fixed(), _):
            return common.places
        case (_, Many()):
            return common.elements
        case _:
            raise AssertionError("what has neither was refused when it was united")


def read_any(data: bytes) -> tuple[Dialect, List]:
    """The dialect of a message, and its tree.

    Nothing on the wire says so. What decides, in this order: in which dialects the message is a bottle at all, to its last
    byte (tag 10 stands for eight bytes in YARP 3 and for four in YARP 4); a NUL after every string, which only 2012 writes;
    and in an image the high half of the quantum word. A message that means the same in all of them is called YARP 3.

    Raises
    ------
    DecodeError
        Where it is a bottle in no dialect: the error of the reading that came furthest.
    """
    readings: list[tuple[Dialect, List]] = []
    failures: list[DecodeError] = []
    for dialect in (YARP3, YARP4, YARP2012):
        try:
            readings.append((dialect, read(data, dialect)))
        except DecodeError as failure:
            failures.append(failure)
    if not readings:
        raise max(failures, key=lambda failure: failure.offset)
    return _likeliest(readings)


def _likeliest(readings: list[tuple[Dialect, List]]) -> tuple[Dialect, List]:
    *_, last = readings
    if last[0] is YARP2012 and _has_string(last[1]):
        return last
    dialect, bottle = readings[0]
    if _plain_quantum(bottle):
        return next(((known, tree) for known, tree in readings if known is YARP4), readings[0])
    return dialect, bottle


def _has_string(item: Item) -> bool:
    """A string was read with its NUL: 2012's reading has refused any other."""
    match item:
        case Value(tag):
            return tag == "string"
        case List(items):
            return any(_has_string(inner) for inner in items)
        case Dict(content):
            return _has_string(content)


def _plain_quantum(bottle: List) -> bool:
    """The message is an image, and its quantum word has no flag in the high half (yarp.md 3.5)."""
    match bottle.items:
        case (Value("vocab32", name), Value("vocab32"), List((_, _, Value("int32", int(quantum)), _, _)), Value("blob")):
            return name == vocab(b"mat") and quantum >> 16 == 0
        case _:
            return False
