"""Constants of enums by name: `text(.mode)` is the name of a constant, `pkg.Enum(.name)` the constant of that name."""

from __future__ import annotations

from rosetta_jit.functions.forms import of_texts, row, undone_by
from rosetta_jit.kernel.nodes import Block, Const, Convert, Expr, If, Switch
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.affine_steps import LostError, Value
from rosetta_jit.language.conversions import describe
from rosetta_jit.language.function import SEVERAL
from rosetta_jit.language.functions.texts import NAMED
from rosetta_jit.language.scope import Scope
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.search import are_bytes
from rosetta_jit.lowering.texts.values import chosen_text, expect, placed_of
from rosetta_jit.lowering.texts.views import TRUE, Quoted, View, joined
from rosetta_jit.lowering.writer import block
from rosetta_jit.model import expr as model
from rosetta_jit.model.layout import scalar_of
from rosetta_jit.model.types import Enum

FALSE = Const("bool", value=False)


def enum_of(value: typed.Expr) -> Enum:
    """The enum that a value is of."""
    assert isinstance(value.type, Enum)
    return value.type


def lower_name(call: typed.Call, values: Evaluation) -> View:
    """The name of a constant: of several names of one number, the first."""
    (constant,) = call.arguments
    enum, writer = enum_of(constant), values.writer
    number = Convert("i64", writer.let("number", values.of(constant)))
    first, size = writer.var("first", index(0)), writer.var("size", index(0))
    cases: list[tuple[int, Block]] = []
    for known, name in {known: name for name, known in reversed(enum.values)}.items():
        with values.source.forgetting(), writer.nested() as body:
            made = joined(writer, (Quoted(name.encode()),))
            writer.assign(first, made.first)
            writer.assign(size, made.size)
        cases.append((known, block(body)))
    with writer.nested() as unnamed:
        expect(values, FALSE, "range", f"{describe(enum)} has no constant of this number")
    writer.emit(Switch(number, tuple(cases), block(unnamed)))
    return chosen_text(first, size, values)


def _lower_named(call: typed.Call, values: Evaluation) -> Expr:
    """The constant of a name, compared with one name after another."""
    assert isinstance(call.type, Enum)
    writer, scalar = values.writer, scalar_name(scalar_of(call.type))
    text = placed_of(call.arguments[0], values)
    found, unknown = writer.var("constant", Const(scalar, 0)), writer.var("unknown", TRUE)
    for name, number in call.type.values:
        with writer.nested() as step:
            same = are_bytes(values, text.size, text.address, name.encode())
            with writer.nested() as then:
                writer.assign(found, Const(scalar, number))
                writer.assign(unknown, FALSE)
            writer.emit(If(same, block(then)))
        writer.emit(If(unknown, block(step)))
    with writer.nested() as unnamed:
        expect(values, FALSE, "range", f"{describe(call.type)} has no constant of this name")
    writer.emit(If(unknown, block(unnamed)))
    return found


def _not_written(_call: model.Call, _arguments: list[typed.Expr], _scope: Scope) -> typed.Expr | None:
    raise AssertionError("no mapping can write this name: conversions to enums are made of it")


def read_name(opening: typed.Call, step: typed.Call, before: Value) -> Value | None:
    """A constant that was written by its name, and read as one of the same enum."""
    return before if opening.arguments[0].type == step.type else None


def _written_name(opening: typed.Call, step: typed.Call, before: Value) -> Value | None:
    """A name that was read as a constant, which is written by its first name."""
    enum = enum_of(step.arguments[0])
    if enum != opening.type:
        return None
    numbers = [number for _, number in enum.values]
    if len(set(numbers)) < len(numbers):
        raise LostError("of several names of one number the first is written")
    return before


NAMES = row("`text(.mode)`, `pkg.Enum(s)`", "the name of an enum's constant, and the constant of a name", "`range`")

FUNCTIONS = (of_texts(NAMED, _not_written, _lower_named, SEVERAL, undone_by(text=_written_name), NAMES),)
