"""Typed expressions of texts as places in memory."""

from __future__ import annotations

from typing import cast

from rosetta_jit.kernel.nodes import Address, Binary, Compare, Const, Expr, If, IsText, Local, Used, Wire
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.lowering.evaluation import Evaluation, lowered
from rosetta_jit.lowering.texts.views import LOST, TRUE, Quoted, Text, View, joined, lane_of, placed, sound
from rosetta_jit.lowering.writer import block


def text_of(value: typed.Expr, values: Evaluation) -> Text:
    """A text that is written down, lies in a field, or is computed."""
    match value:
        case typed.Const(str(text)):
            return Quoted(text.encode())
        case typed.Access(place):
            return field(place, values)
        case typed.Choice():
            return _chosen(value, values)
        case typed.Listed():
            return _listed(value, values)
        case typed.Call():
            return cast("Text", lowered(value, values))
        case _:
            raise AssertionError(value)


def field(place: typed.Place, values: Evaluation) -> View:
    """The text in a field."""
    size = values.writer.let("size", values.source.count(place, values))
    return _view(values.source.address(place, values), size, values)


def _view(address: Address, size: Expr, values: Evaluation) -> View:
    writer = values.writer
    if isinstance(address, Wire):
        writer.require(size, values.where, at=address.at)  # it is there: said again where the proof may have lost it
        return sound(writer, View(None, address.at, writer.let("after", Binary("add", address.at, size))))
    return sound(writer, View(address.lane, address.row, writer.let("after", Binary("add", address.row, size))))


def _chosen(choice: typed.Choice, values: Evaluation) -> View:
    """Only the text that is chosen is made, behind the others of the hidden lane."""
    writer = values.writer
    first, size, undecided = writer.var("first", index(0)), writer.var("size", index(0)), writer.var("undecided", TRUE)

    def choose(value: typed.Expr) -> None:
        made = joined(writer, (text_of(value, values),))
        writer.assign(first, made.first)
        writer.assign(size, made.size)
        writer.assign(undecided, Const("bool", value=False))

    for condition, value in choice.cases:
        with values.source.forgetting(), writer.nested() as step:
            holds = values.of(condition)
            with writer.nested() as then:
                choose(value)
            writer.emit(If(holds, block(then)))
        writer.emit(If(undecided, block(step)))
    if choice.otherwise is None:
        values.reject(choice.reason, choice.pieces, when=undecided)
    else:
        with values.source.forgetting(), writer.nested() as other:
            choose(choice.otherwise)
        writer.emit(If(undecided, block(other)))
    return chosen_text(first, size, values)


def _listed(listed: typed.Listed, values: Evaluation) -> View:
    """Only the text that is chosen is made, as above."""
    writer = values.writer
    first, size = writer.var("first", index(0)), writer.var("size", index(0))

    def choose(value: typed.Expr) -> None:
        made = joined(writer, (text_of(value, values),))
        writer.assign(first, made.first)
        writer.assign(size, made.size)

    values.switch(listed, choose)
    return chosen_text(first, size, values)


def chosen_text(first: Local, size: Local, values: Evaluation) -> View:
    """A text of the hidden lane that one of several ways has made."""
    writer, lane = values.writer, lane_of(values.writer)
    for known in (Compare("ge", first, index(0)), Compare("ge", size, index(0)), Compare("le", size, Used(lane))):
        writer.expect(known, "length", values.where, LOST)
    writer.expect(Compare("le", first, Binary("sub", Used(lane), size)), "length", values.where, LOST)
    return sound(writer, View(lane, first, writer.let("after", Binary("add", first, size))))


def placed_of(value: typed.Expr, values: Evaluation) -> View:
    """A text that lies somewhere, also where the mapping writes it down."""
    return placed(values.writer, text_of(value, values))


def quoted(value: typed.Expr) -> bytes:
    """A text that must be written down."""
    assert isinstance(value, typed.Const)
    assert isinstance(value.value, str)
    return value.value.encode()


def expect(values: Evaluation, condition: Expr, kind: str, detail: str) -> None:
    """Fail at the rule, unless something holds."""
    values.writer.expect(condition, kind, values.where, detail, line=values.line)


def checked(view: View, values: Evaluation) -> View:
    """A text that is UTF-8, or an error."""
    if not view.valid:
        expect(values, IsText(view.address, view.size), "text", "not valid UTF-8")
    return view
