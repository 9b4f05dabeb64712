"""Texts one behind the other, and what separators and known ends divide."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from rosetta_jit.functions.forms import constants_of, if_same_constants, of_texts, row, undone_by
from rosetta_jit.kernel.nodes import Binary, Expr, Local
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.affine_steps import Value
from rosetta_jit.language.function import SEVERAL, Texts
from rosetta_jit.language.functions.texts import concatenation, separates, type_texts, without_end
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import INT64
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.search import has_at, part, parts
from rosetta_jit.lowering.texts.separated import between_separators
from rosetta_jit.lowering.texts.values import expect, field, placed_of, quoted, text_of
from rosetta_jit.lowering.texts.views import Quoted, View, joined, placed, sound
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Array, Bool, Float, Int
from rosetta_jit.startup.dataclass import replace


class Separated(NamedTuple):
    """A text that separators divide."""

    text: View
    separator: bytes


# --- types ---------------------------------------------------------------------------------------------------------------

SPLIT = Texts(("text", "pattern"), None)


def _type_sum(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    left, right = arguments
    return concatenation(left, right, call.span, scope)


def _type_split(call: model.Call, arguments: list[typed.Expr], scope: Scope) -> typed.Expr | None:
    found = type_texts(call, arguments, scope, SPLIT)
    return None if found is None else replace(found, type=Array(found.type))


# --- kernels -------------------------------------------------------------------------------------------------------------


def _lower_sum(call: typed.Call, values: Evaluation) -> View:
    return joined(values.writer, [text_of(piece, values) for piece in _pieces(call)])


def _pieces(value: typed.Expr) -> Sequence[typed.Expr]:
    """The texts of a sum of sums."""
    match value:
        case typed.Call("+", (left, right)):
            return [*_pieces(left), *_pieces(right)]
        case _:
            return [value]


def _lower_behind(call: typed.Call, values: Evaluation) -> View:
    view, known = placed_of(call.arguments[0], values), quoted(call.arguments[1])
    there = has_at(values.writer, "starts_with", view, placed(values.writer, Quoted(known)))
    return _without(replace(view, first=Binary("add", view.first, index(len(known)))), there, "begin", values)


def _lower_before(call: typed.Call, values: Evaluation) -> View:
    view, known = placed_of(call.arguments[0], values), quoted(call.arguments[1])
    there = has_at(values.writer, "ends_with", view, placed(values.writer, Quoted(known)))
    return _without(replace(view, after=Binary("sub", view.after, index(len(known)))), there, "end", values)


def _without(rest: View, there: Expr, where: str, values: Evaluation) -> View:
    """A text without the begin, or the end, that it must have."""

    def must(condition: Expr) -> None:
        expect(values, condition, "text", f"the text does not {where} as it must")

    must(there)
    return sound(values.writer, rest, must)


def _lower_part(call: typed.Call, values: Evaluation) -> View:
    text, separator, number = call.arguments
    found, there = part(values.writer, placed_of(text, values), quoted(separator), values.of(number))
    expect(values, there, "index", "the text has no such part")
    return found


def _lower_parts(call: typed.Call, values: Evaluation) -> Expr:
    return parts(values.writer, placed_of(call.arguments[0], values), quoted(call.arguments[1]))


def _lower_split(call: typed.Call, values: Evaluation) -> Separated:
    return Separated(placed_of(call.arguments[0], values), quoted(call.arguments[1]))


def _lower_join(call: typed.Call, values: Evaluation) -> View:
    """The elements of an array as one text."""
    array, separator = call.arguments
    assert isinstance(array, typed.Access)
    assert isinstance(array.type, Array)
    place, variable = array.place, typed.Local(f"(text {len(values.variables)})")
    element = typed.Place(place.side, (*place.steps, typed.IndexStep(variable)), array.type.element)

    def of_number(number: Local) -> View:
        return field(element, values.with_local(variable.name, number))

    with values.source.forgetting():
        count = values.source.count(place, values)
        return between_separators(values.writer, count, quoted(separator), of_number, lambda good, why: expect(values, good, "text", why))


# --- the other direction -------------------------------------------------------------------------------------------------


def _joined(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    text, separator = call.arguments
    return text, model.Call("join", (value, separator), call.span)


def _split(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    texts, separator = call.arguments
    return texts, model.Call("split", (value, separator), call.span)


def _with_begin(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    text, begin = call.arguments
    return text, model.Binary("+", begin, value, call.span)


def _with_end(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    text, end = call.arguments
    return text, model.Binary("+", value, end, call.span)


# --- laws ----------------------------------------------------------------------------------------------------------------


def _added_again(opening: typed.Call, step: typed.Call, before: Value) -> Value | None:
    """`behind(s, "a")` and `"a" + s`, `before(s, "a")` and `s + "a"`, in this order or the other."""
    sum_, end = (opening, step) if opening.function == "+" else (step, opening)
    is_there = isinstance(sum_.arguments[0 if end.function == "behind" else 1], typed.Const | typed.Given)
    return before if is_there and constants_of(opening) == constants_of(step) else None


def _part_again(call: typed.Call) -> typed.Expr | None:
    """`part(a + "," + b, ",", 1)` is b, and `parts(a + "," + b, ",")` is 2, where neither holds the separator."""
    text, separator, *numbers = call.arguments
    pieces = _pieces(text)
    if not isinstance(separator, typed.Const) or any(piece != separator for piece in pieces[1::2]):
        return None
    found = [_without_separator(piece, str(separator.value)) for piece in pieces[::2]]
    if len(pieces) % 2 == 0 or None in found:
        return None
    match numbers:
        case [typed.Const(int(number))]:
            return found[number] if 0 <= number < len(found) else None
        case []:
            return typed.Const(len(found), INT64)
        case _:
            return None


def _without_separator(piece: typed.Expr, separator: str) -> typed.Expr | None:
    """A text that holds no separator where it is not refused."""
    match piece:
        case typed.Call("text", (number, *_)) if isinstance(number.type, Bool | Int | Float) and separates(separator):
            return piece
        case typed.Choice(((typed.Unary("not", typed.Call("contains", (text, typed.Const(known)))), value),), None) if text == value:
            return value if known == separator and len(separator.encode()) == 1 else None
        case _:
            return None


FUNCTIONS = (
    of_texts(
        "+",
        _type_sum,
        _lower_sum,
        SEVERAL,
        undone_by(behind=_added_again, before=_added_again),
        row('`.a + "/" + .b`', "texts one behind the other"),
    ),
    *(
        of_texts(
            name,
            without_end,
            lower,
            inverse,
            undone_by(**{"+": _added_again}),
            row(
                '`behind(s, "begin")`, `before(s, "end")`',
                "the rest of a text that begins, or ends, so; all of it where the other is empty",
                "`text`",
            ),
        )
        for name, lower, inverse in (("behind", _lower_behind, _with_begin), ("before", _lower_before, _with_end))
    ),
    of_texts(
        "part",
        Texts(("text", "pattern", "integer"), None),
        _lower_part,
        SEVERAL,
        undone_by(),
        row('`part(s, "/", n)`', "the part of that number, from 0, between separators", "`index`"),
        undoes=_part_again,
    ),
    of_texts(
        "parts",
        Texts(("text", "pattern"), INT64),
        _lower_parts,
        SEVERAL,
        undone_by(),
        row('`parts(s, "/")`', "how many parts there are, as int64"),
        undoes=_part_again,
    ),
    of_texts(
        "join",
        Texts(("texts", "pattern"), None),
        _lower_join,
        _split,
        undone_by(split=if_same_constants),
        row('`join(a, ", ")`', "the texts of an array, a field, with the separator between each two", "`text`"),
    ),
    of_texts(
        "split",
        _type_split,
        _lower_split,
        _joined,
        undone_by(join=if_same_constants),
        row(
            '`split(s, ", ")`',
            "the parts between separators, as an array of texts, which is assigned as a whole; none of an empty text",
        ),
    ),
)
