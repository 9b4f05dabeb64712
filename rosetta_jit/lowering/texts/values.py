"""Typed expressions of texts as places in memory."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from rosetta_jit.kernel.ir import Binary, Compare, Const, If, IsText, Place, Unary, Used, Wire
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.functions.texts import BLANKS
from rosetta_jit.lowering.images import bytes_of
from rosetta_jit.lowering.texts.encodings import Recoded, from_latin, from_utf16, is_ascii, to_latin, to_utf16
from rosetta_jit.lowering.texts.making import padded, replaced, with_case
from rosetta_jit.lowering.texts.moments import dated
from rosetta_jit.lowering.texts.number_writing import is_special, written_float, written_integer
from rosetta_jit.lowering.texts.search import find, has_at, part, stripped
from rosetta_jit.lowering.texts.separated import between_separators
from rosetta_jit.lowering.texts.views import LOST, TRUE, Quoted, Text, View, byte_at, joined, lane_of, lies_in, placed, sound
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.types import Array, Float, String

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.kernel.ir import Address, Expr, Local
    from rosetta_jit.lowering.evaluation import Evaluation

LARGEST = 18
"""Digits that a float of so many decimals may have in all."""


def text_of(value: typed.Expr, values: Evaluation) -> Text:
    """A text that is written down, lies in a field, or is computed."""
    match value:
        case typed.Const(str(text)):
            return Quoted(text.encode())
        case typed.Access(place):
            return _field(place, values)
        case typed.Choice():
            return _chosen(value, values)
        case typed.Listed():
            return _listed(value, values)
        case typed.TextCall("concatenated"):
            return joined(values.writer, [text_of(piece, values) for piece in _pieces(value)])
        case typed.TextCall():
            return _called(value, values)
        case typed.ImageCall():
            return _image(value, values)
        case _:
            raise AssertionError(value)


def _field(place: typed.Place, values: Evaluation) -> View:
    size = values.writer.let("size", values.source.count(place, values))
    return _view(values.source.address(place, values), size, values)


def _view(address: Address, size: Expr, values: Evaluation) -> View:
    writer = values.writer
    if isinstance(address, Wire):
        writer.require(size, values.where, at=address.at)  # it is there: said again where the proof may have lost it
        return sound(writer, View(None, address.at, writer.let("after", Binary("add", address.at, size))))
    return sound(writer, View(address.lane, address.row, writer.let("after", Binary("add", address.row, size))))


def _image(value: typed.ImageCall, values: Evaluation) -> View:
    """An image, or its pixels, in the hidden lane."""
    made = bytes_of(value, values)
    assert isinstance(made.address, Place)
    after = values.writer.let("after", Binary("add", made.address.row, made.size))
    return sound(values.writer, View(made.address.lane, made.address.row, after))


def _pieces(value: typed.Expr) -> Sequence[typed.Expr]:
    """The texts of a sum of sums."""
    match value:
        case typed.TextCall("concatenated", (left, right)):
            return [*_pieces(left), *_pieces(right)]
        case _:
            return [value]


def _chosen(choice: typed.Choice, values: Evaluation) -> View:
    """Only the text that is chosen is made, behind the others of the hidden lane."""
    writer, lane = values.writer, lane_of(values.writer)
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
    return _found(lane, first, size, values)


def _listed(listed: typed.Listed, values: Evaluation) -> View:
    """Only the text that is chosen is made, as above."""
    writer, lane = values.writer, lane_of(values.writer)
    first, size = writer.var("first", index(0)), writer.var("size", index(0))

    def choose(value: typed.Expr) -> None:
        made = joined(writer, (text_of(value, values),))
        writer.assign(first, made.first)
        writer.assign(size, made.size)

    values.switch(listed, choose)
    return _found(lane, first, size, values)


def _found(lane: int, first: Local, size: Local, values: Evaluation) -> View:
    """A text that one of several ways has made."""
    writer = values.writer
    for known in (Compare("ge", first, index(0)), Compare("ge", size, index(0)), Compare("le", size, Used(lane))):
        writer.expect(known, "length", values.where, LOST)
    writer.expect(Compare("le", first, Binary("sub", Used(lane), size)), "length", values.where, LOST)
    return sound(writer, View(lane, first, writer.let("after", Binary("add", first, size))))


def _called(call: typed.TextCall, values: Evaluation) -> Text:
    writer, arguments = values.writer, call.arguments
    match call.function:
        case "written":
            return _written(call, values)
        case "lower" | "upper" as case:
            return with_case(writer, placed_of(arguments[0], values), case)
        case "strip":
            characters = next(map(quoted, arguments[1:]), BLANKS.encode())
            return stripped(writer, placed_of(arguments[0], values), characters)
        case "replace":
            return replaced(writer, placed_of(arguments[0], values), quoted(arguments[1]), quoted(arguments[2]))
        case "slice":
            return _slice(call, values)
        case "part":
            found, there = part(writer, placed_of(arguments[0], values), quoted(arguments[1]), values.of(arguments[2]))
            expect(values, there, "index", "the text has no such part")
            return found
        case "behind" | "before" as side:
            return _without(side, placed_of(arguments[0], values), quoted(arguments[1]), values)
        case "join":
            return _joined_elements(call, values)
        case "until_nul":
            view = placed_of(arguments[0], values)
            return sound(writer, replace(view, after=find(writer, view.lane, view.first, view.after, b"\0")))
        case "padded":
            return _padded(call, values)
        case "decoded" | "bytes":
            return _recoded(call, values)
        case "iso8601":
            return dated(call, values)
        case _:
            raise AssertionError(call)


def _joined_elements(call: typed.TextCall, values: Evaluation) -> View:
    """The elements of an array as one text."""
    array, pattern = call.arguments
    assert isinstance(array, typed.Access)
    assert isinstance(array.type, Array)
    place, variable = array.place, typed.Local(f"(text {len(values.variables)})")
    element = typed.Place(place.side, (*place.steps, typed.IndexStep(variable)), array.type.element)

    def of_number(number: Local) -> View:
        return _field(element, values.with_local(variable.name, number))

    with values.source.forgetting():
        count = values.source.count(place, values)
        return between_separators(values.writer, count, quoted(pattern), of_number, lambda good, why: expect(values, good, "text", why))


def _written(call: typed.TextCall, values: Evaluation) -> View:
    number, decimals = call.arguments[0], call.arguments[1:]
    value = values.of(number)
    if not isinstance(number.type, Float):
        return written_integer(values.writer, value)
    places = next((int(each.value) for each in decimals if isinstance(each, typed.Const)), None)
    if places is None:
        return written_float(values.writer, value, None)
    known = values.writer.let("number", value)
    fits = Compare("lt", Unary("abs", known), Const(known.type, 10.0 ** (LARGEST - places)))
    expect(values, Binary("or", fits, is_special(known)), "range", f"a number of more than {LARGEST} digits")
    return written_float(values.writer, known, places)


def _slice(call: typed.TextCall, values: Evaluation) -> View:
    """A part by its first and last byte, where characters begin."""
    writer = values.writer
    text, start, stop = call.arguments
    view = placed_of(text, values)
    size = writer.let("size", view.size)
    low, high = writer.let("start", values.of(start)), writer.let("stop", values.of(stop))
    for within in (Compare("ge", low, index(0)), Compare("le", low, high), Compare("le", high, size)):
        expect(values, within, "index", "the text has no such bytes")
    first, after = (writer.let(name, Binary("add", view.first, at)) for name, at in (("first", low), ("after", high)))
    found = sound(writer, View(view.lane, first, after, view.valid and isinstance(call.type, String)))
    for at in (first, after) if isinstance(call.type, String) else ():
        with writer.nested() as inside:
            begins = Compare("ne", Binary("and", byte_at(view.lane, at), Const("u8", 0xC0)), Const("u8", 0x80))
            expect(values, begins, "text", "a character is cut")
        writer.emit(If(Binary("and", Compare("lt", at, view.after), lies_in(view.lane, at)), block(inside)))
    return found


def _without(side: Literal["behind", "before"], view: View, known: bytes, values: Evaluation) -> View:
    """A text without the begin, or the end, that it must have."""
    end, where = ("starts_with", "begin") if side == "behind" else ("ends_with", "end")
    there = has_at(values.writer, end, view, placed(values.writer, Quoted(known)))

    def must(condition: Expr) -> None:
        expect(values, condition, "text", f"the text does not {where} as it must")

    must(there)
    size = index(len(known))
    if side == "behind":
        return sound(values.writer, replace(view, first=Binary("add", view.first, size)), must)
    return sound(values.writer, replace(view, after=Binary("sub", view.after, size)), must)


def _padded(call: typed.TextCall, values: Evaluation) -> View:
    text, size = call.arguments
    assert isinstance(size, typed.Const)
    view = placed_of(text, values)
    expect(values, Compare("le", view.size, index(int(size.value))), "length", f"the text has more than {int(size.value)} bytes")
    return padded(values.writer, view, int(size.value))


def _recoded(call: typed.TextCall, values: Evaluation) -> View:
    """Bytes read as text, or text as bytes of an encoding."""
    writer, encoding = values.writer, quoted(call.arguments[1]).decode()
    view = placed_of(call.arguments[0], values)
    if call.function == "bytes" or encoding == "utf-8":
        view = checked(view, values)
    match encoding, call.function:
        case "utf-8", _:
            return view
        case "ascii", _:
            made = Recoded(replace(view, valid=True), is_ascii(writer, view))
        case "latin-1", "decoded":
            made = from_latin(writer, view)
        case "latin-1", _:
            made = to_latin(writer, view)
        case _, "decoded":
            made = from_utf16(writer, view, big=encoding.endswith("be"))
        case _:
            made = to_utf16(writer, view, big=encoding.endswith("be"))
    expect(values, made.good, "text", f"not valid {encoding}" if call.function == "decoded" else f"a character that {encoding} lacks")
    return made.view


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
