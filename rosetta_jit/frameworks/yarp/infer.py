"""Drafts a bottle schema from captured messages: what they have in common as types, what varies as comments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.errors import DecodeError, SchemaError
from rosetta_jit.frameworks.yarp import bottle_diagnostics as catalogue
from rosetta_jit.frameworks.yarp.bottle import read
from rosetta_jit.frameworks.yarp.detect import read_any
from rosetta_jit.frameworks.yarp.draft import draft
from rosetta_jit.frameworks.yarp.limits import MAX_PLACES
from rosetta_jit.frameworks.yarp.names import TYPE_NAME
from rosetta_jit.frameworks.yarp.shape import Clash, Fixed, Many, join_all, join_lists, join_places, shape
from rosetta_jit.frameworks.yarp.tags import DIALECTS
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosetta_jit.frameworks.yarp.shape import Shape
    from rosetta_jit.frameworks.yarp.tree import List

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
