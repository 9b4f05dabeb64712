"""Numbers that texts spell, names of constants, and texts as bytes of an encoding."""

from __future__ import annotations

from rosetta_jit.catalogue import resolve
from rosetta_jit.catalogue import texts as words
from rosetta_jit.functions.enum_names import NAMES, lower_name, read_name
from rosetta_jit.functions.forms import if_same_constants, loses, of_texts, row, undone_by
from rosetta_jit.kernel.nodes import Binary, Compare, Const, Expr, Unary
from rosetta_jit.language import typed
from rosetta_jit.language.affine_steps import Value
from rosetta_jit.language.conversions import FLOAT64, describe, is_textual
from rosetta_jit.language.function import ByType, Texts
from rosetta_jit.language.functions.texts import BYTES, NAMED, TEXT, argument, name_of
from rosetta_jit.language.limits import MAX_DECIMALS
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.encodings import Recoded, from_latin, from_utf16, is_ascii, to_latin, to_utf16
from rosetta_jit.lowering.texts.number_reading import Read, read_float, read_integer
from rosetta_jit.lowering.texts.number_writing import is_special, written_float, written_integer
from rosetta_jit.lowering.texts.values import checked, expect, placed_of, quoted
from rosetta_jit.lowering.texts.views import View
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Bool, Enum, Float, Int, String, Type
from rosetta_jit.startup.dataclass import replace

LARGEST = 18
"""Digits that a float of so many decimals may have in all."""

SPELLING = "a number is written in one way, however it was spelt"


# --- text ----------------------------------------------------------------------------------------------------------------


def _type_text(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    """What a number is written as, the name of a constant, or bytes read as text."""
    match arguments:
        case [constant] if isinstance(constant.type, Enum):
            return name_of(constant, call.span)
        case [number] if isinstance(number.type, Bool | Int | Float):
            return typed.Call("text", (number,), TEXT, call.span)
        case [number, typed.Const(value=int(decimals), type=Int())] if isinstance(number.type, Float) and 0 <= decimals <= MAX_DECIMALS:
            return typed.Call("text", (number, arguments[1]), TEXT, call.span)
        case [data, encoding] if is_textual(data.type) and not isinstance(data.type, String):
            known = argument("text", "encoding", encoding, scope)
            return None if known is None else typed.Call("text", (data, known), TEXT, call.span)
        case [_] | [_, _]:
            scope.problems.append(words.not_written(call.span, [describe(each.type) for each in arguments], MAX_DECIMALS))
        case _:
            scope.problems.append(
                resolve.arguments(call.span, "text", "a number, a constant of an enum, or bytes and their encoding", len(arguments))
            )
    return None


def _lower_text(call: typed.Call, values: Evaluation) -> View:
    number, *rest = call.arguments
    if is_textual(number.type):
        return _read_as_text(call, values)
    if isinstance(number.type, Enum):
        return lower_name(call, values)
    value = values.of(number)
    if not isinstance(number.type, Float):
        return written_integer(values.writer, value)
    decimals = next((int(each.value) for each in rest if isinstance(each, typed.Const)), None)
    if decimals is None:
        return written_float(values.writer, value, None)
    known = values.writer.let("number", value)
    fits = Compare("lt", Unary("abs", known), Const(known.type, 10.0 ** (LARGEST - decimals)))
    expect(values, Binary("or", fits, is_special(known)), "range", f"a number of more than {LARGEST} digits")
    return written_float(values.writer, known, decimals)


def _read_as_text(call: typed.Call, values: Evaluation) -> View:
    writer, encoding = values.writer, quoted(call.arguments[1]).decode()
    view = placed_of(call.arguments[0], values)
    match encoding:
        case "utf-8":
            return checked(view, values)
        case "ascii":
            made = Recoded(replace(view, valid=True), is_ascii(writer, view))
        case "latin-1":
            made = from_latin(writer, view)
        case _:
            made = from_utf16(writer, view, big=encoding.endswith("be"))
    expect(values, made.good, "text", f"not valid {encoding}")
    return made.view


def _text_of(call: model.Call, value: model.Expr, type_: Type | None) -> tuple[model.Expr, model.Expr]:
    """The number that a text spells, the constant that it names, or its bytes."""
    match call.arguments:
        case (inner, model.Literal(str()) as encoding):
            return inner, model.Call("bytes", (value, encoding), call.span)
        case (inner, *_):
            return inner, model.Call(_reading(type_), (value,), call.span)
        case _:
            raise AssertionError(call)


def _reading(type_: Type | None) -> str:
    """What reads a value of a type from its text: a constant by its name, a number as it is spelt."""
    match type_:
        case Enum(name=name):
            return name
        case Bool() | Int():
            return "integer"
        case _:
            return "number"


def _read_integer(opening: typed.Call, _step: typed.Call, before: Value) -> Value | None:
    """A number that was written in decimal, with all of its digits."""
    return before if len(opening.arguments) == 1 and not isinstance(opening.arguments[0].type, Float) else None


def _read_float(opening: typed.Call, _step: typed.Call, before: Value) -> Value | None:
    """A float64 in as few digits as read back."""
    number, *decimals = opening.arguments
    return before if not decimals and isinstance(number.type, Float) and number.type.bits == 64 else None


def _rounded_number(before: Value) -> Value | None:
    """The float32 whose text was read: `kernel.decimals.shortest` chooses digits that, read so, are rounded to it."""
    match before.opened:
        case (*_, (typed.Call("text", (number,)), value)) if before.is_itself and isinstance(number.type, Float) and number.type.bits == 32:
            return value
        case _:
            return None


# --- bytes, integer, number ----------------------------------------------------------------------------------------------


def _lower_bytes(call: typed.Call, values: Evaluation) -> View:
    writer, encoding = values.writer, quoted(call.arguments[1]).decode()
    view = checked(placed_of(call.arguments[0], values), values)
    match encoding:
        case "utf-8":
            return view
        case "ascii":
            made = Recoded(replace(view, valid=True), is_ascii(writer, view))
        case "latin-1":
            made = to_latin(writer, view)
        case _:
            made = to_utf16(writer, view, big=encoding.endswith("be"))
    expect(values, made.good, "text", f"a character that {encoding} lacks")
    return made.view


def _bytes_of(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    text, encoding = call.arguments
    return text, model.Call("text", (value, encoding), call.span)


def _lower_integer(call: typed.Call, values: Evaluation) -> Expr:
    return _read(read_integer(values.writer, placed_of(call.arguments[0], values)), "an integer", "int64", values)


def _lower_number(call: typed.Call, values: Evaluation) -> Expr:
    return _read(read_float(values.writer, placed_of(call.arguments[0], values)), "a number", "float64", values)


def _read(read: Read, what: str, target: str, values: Evaluation) -> Expr:
    expect(values, Unary("not", read.is_none), "text", f"the text is not {what}")
    expect(values, Unary("not", read.is_too_large), "range", f"the number does not fit {target}")
    return read.value


def _spelt(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    return call.arguments[0], model.Call("text", (value,), call.span)


ENCODED = row(
    '`text(b, "latin-1")`, `bytes(s, "utf-16le")`',
    "bytes as text and back: `utf-8`, `ascii`, `latin-1`, `utf-16le`, `utf-16be`",
    "`text`",
)
SPELT = row(
    "`integer(s)`, `number(s)`",
    "the int64, or the nearest float64 (also `nan`, `inf`), that the whole text spells",
    "`text`, `range`",
)
DECIMAL = row("`text(n)`", "an integer or a bool (0, 1) in decimal, a float in as few digits as read back, as Python writes it")
DECIMALS = row("`text(x, 3)`", f"a float with so many decimals, at most {MAX_DECIMALS}, rounded correctly")

FUNCTIONS = (
    of_texts(
        "text",
        _type_text,
        _lower_text,
        ByType(_text_of),
        undone_by(integer=_read_integer, number=_read_float, bytes=if_same_constants, **{NAMED: read_name}),
        (*ENCODED, *DECIMAL, *DECIMALS, *NAMES),
    ),
    of_texts("bytes", Texts(("text", "encoding"), BYTES), _lower_bytes, _bytes_of, undone_by(text=if_same_constants), ENCODED),
    of_texts("integer", Texts(("text",), INT64), _lower_integer, _spelt, undone_by(text=loses(SPELLING)), SPELT),
    of_texts(
        "number",
        Texts(("text",), FLOAT64),
        _lower_number,
        _spelt,
        replace(undone_by(text=loses(SPELLING)), rounded=_rounded_number),
        SPELT,
    ),
)
