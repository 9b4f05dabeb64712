"""``default .place`` as rules: each field without a rule of its own is set to the value that the schema gives it.

What the schema requires is there (proto2): with its default, else 0 or empty.
"""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.language.conversions import is_textual
from rosetta_jit.language.limits import MAX_DEFAULT_DEPTH, MAX_DEFAULTS
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import INT64, Access, Assign, Call, Choice, Const, Default, Expr, FieldStep, Has, LenOf, Place, Rule
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Field, Float, Int, Optional, Schema, String, Struct, Type, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace


class ManyDefaultsError(Exception):
    """More than `MAX_DEFAULTS`; never leaves `rosetta_jit.language.resolve.rules`."""


def default_rules(place: Place, message: Message, span: Span | None) -> list[Rule]:
    """Assignments of the defaults at and below a place; the rest is left alone; raises ManyDefaultsError."""
    found: list[Rule] = []
    for rule in _rules(place, message, span):
        found.append(rule)
        if len(found) > MAX_DEFAULTS:
            raise ManyDefaultsError
    return found


def _rules(place: Place, message: Message, span: Span | None) -> Iterator[Rule]:
    last = place.steps[-1]
    known = _default(last.field, place, span) if isinstance(last, FieldStep) else None
    if isinstance(last, FieldStep) and _may_lack(last.field):
        yield Default(place, span)
    elif known is not None:
        yield known
    elif isinstance(place.type, Struct) and len(place.steps) < MAX_DEFAULT_DEPTH and _has_defaults(place.type, message):
        for field in place.type.fields:
            if field.constant is None:
                yield from _rules(_below(place, field, message), message, span)
    else:
        yield Default(place, span)


def _default(field: Field, place: Place, span: Span | None) -> Rule | None:
    """The rule for a field that has a default."""
    match place.type, field.default:
        case Enum(values=((_, number), *_), closed=True), None if field.required:
            return Assign(place, Const(number, place.type, span), span)
        case Enum(values=values), str(name):
            number = dict(values).get(name)
            return None if number is None else Assign(place, Const(number, place.type, span), span)
        case ((Bool() | Int() | Enum()), int(number)):
            return Assign(place, Const(number, place.type, span), span)
        case Float(), (int() | float()) as number:
            return Assign(place, Const(float(number), place.type, span), span)
        case ((String() | Bytes()), str(text)):
            return Assign(place, Const(text, String(), span), span)
        case Bytes(), bytes(data):
            return Assign(place, written(data, span), span)
        case _:
            return None


def _may_lack(field: Field) -> bool:
    return isinstance(field.type, Optional) and not field.required


def _has_defaults(struct: Struct, message: Message, depth: int = 0) -> bool:
    for field in struct.fields:
        if _may_lack(field):
            continue
        if field.required or field.default is not None:
            return True
        inner = message.schema.resolve(field.type)
        if isinstance(inner, Struct) and depth < MAX_DEFAULT_DEPTH and _has_defaults(inner, message, depth + 1):
            return True
    return False


def has_array(type_: Type, schema: Schema, *, counted: bool, seen: frozenset[str] = frozenset()) -> bool:
    """Whether there are always elements in a type: as many as other fields have ``counted``, or as the type fixes."""
    match schema.resolve(type_):
        case Array(length=length, element=element):
            return length is not None and (isinstance(length, int) != counted or has_array(element, schema, counted=counted, seen=seen))
        case Bytes(length=length):
            return length is not None and isinstance(length, int) != counted
        case Struct(name=name, fields=fields) if name not in seen:
            return any(has_array(field.type, schema, counted=counted, seen=seen | {name}) for field in fields)
        case _:
            return False


def _below(place: Place, field: Field, message: Message) -> Place:
    return Place(place.side, (*place.steps, FieldStep(field)), message.value_type(field.type), place.span)


def text_there(place: Place, span: Span | None) -> Expr:
    """What reading a place gives; anything but a text with a default is read as it is."""
    access = Access(place, place.type, span)
    default = default_of(place)
    return access if not default else _chosen(access, written(default, span), span)


def length_there(place: Place, span: Span | None) -> Expr:
    """How many bytes, or elements, reading a place gives."""
    length, default = LenOf(place, INT64, span), default_of(place)
    return length if not default else _chosen(length, Const(len(default), INT64, span), span)


def default_of(place: Place) -> bytes:
    """The bytes of a text that is absent, where it can be."""
    match place.type, place.steps:
        case ((String() | Bytes()), (*around, FieldStep(field))) if is_textual(place.type) and not field.required:
            case_of = around[-1].field.type if around and isinstance(around[-1], FieldStep) else None
            can_lack = isinstance(field.type, Optional) or isinstance(case_of, Union)
            known = field.default.encode() if isinstance(field.default, str) else field.default
            return known if can_lack and isinstance(known, bytes) else b""
        case _:
            return b""


def written(text: bytes, span: Span | None) -> Expr:
    """Bytes as an expression: a text that is written down, or one whose characters are the bytes."""
    try:
        return Const(text.decode(), String(), span)
    except UnicodeDecodeError:
        latin = Const(text.decode("latin-1"), String(), span)
        return Call("bytes", (latin, Const("latin-1", String(), span)), Bytes(), span)


def _chosen(there: Access | LenOf, otherwise: Expr, span: Span | None) -> Choice:
    return Choice(((Has(there.place, span=span), there),), replace(otherwise, span=span), "", there.type, span)
