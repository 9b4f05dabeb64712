"""Texts that may be absent, and that the schema gives a default: where they are not there, reading gives that.

A number that is absent is its default in its lane, or is asked there; the bytes of a text lie elsewhere, so that one is chosen of the two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.language.functions.texts import is_textual
from rosetta_jit.language.typed import INT64, Access, Call, Choice, Const, FieldStep, Has, LenOf
from rosetta_jit.model.types import Bytes, Optional, String, Union

if TYPE_CHECKING:
    from rosetta_jit.language.typed import Expr, Place
    from rosetta_jit.source import Span


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
