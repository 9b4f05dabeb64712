"""Texts that are made of others: cases, blanks, parts by place, NULs."""

from __future__ import annotations

from rosetta_jit.functions.forms import loses, of_texts, row, undone_by
from rosetta_jit.kernel.nodes import Binary, Compare, Const, If
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.function import SEVERAL, ByType, Texts
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.making import padded, replaced, with_case
from rosetta_jit.lowering.texts.search import find, stripped
from rosetta_jit.lowering.texts.values import expect, placed_of, quoted
from rosetta_jit.lowering.texts.views import View, byte_at, lies_in, sound
from rosetta_jit.lowering.writer import block
from rosetta_jit.model.expr import Call, Expr, Literal
from rosetta_jit.model.types import Array, Bytes, String, Type
from rosetta_jit.startup.dataclass import replace

BLANKS = " \t\n\r\v\f"
BEHIND_NUL = "what is behind the first NUL is dropped"


def _lower_case(call: typed.Call, values: Evaluation) -> View:
    return with_case(values.writer, placed_of(call.arguments[0], values), "lower" if call.function == "lower" else "upper")


def _lower_strip(call: typed.Call, values: Evaluation) -> View:
    characters = next(map(quoted, call.arguments[1:]), BLANKS.encode())
    return stripped(values.writer, placed_of(call.arguments[0], values), characters)


def _lower_replace(call: typed.Call, values: Evaluation) -> View:
    text, old, new = call.arguments
    return replaced(values.writer, placed_of(text, values), quoted(old), quoted(new))


def _lower_slice(call: typed.Call, values: Evaluation) -> View:
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


def _lower_until_nul(call: typed.Call, values: Evaluation) -> View:
    view = placed_of(call.arguments[0], values)
    return sound(values.writer, replace(view, after=find(values.writer, view.lane, view.first, view.after, b"\0")))


def _lower_padded(call: typed.Call, values: Evaluation) -> View:
    text, size = call.arguments
    assert isinstance(size, typed.Const)
    view = placed_of(text, values)
    expect(values, Compare("le", view.size, index(int(size.value))), "length", f"the text has more than {int(size.value)} bytes")
    return padded(values.writer, view, int(size.value))


def _filled(call: Call, value: Expr, type_: Type | None) -> tuple[Expr, Expr]:
    """NULs behind the text, where the field has one size."""
    size = type_.length if isinstance(type_, Array | Bytes) else None
    return call.arguments[0], Call("padded", (value, Literal(size, call.span)), call.span) if isinstance(size, int) else value


def _until_nul(call: Call, value: Expr) -> tuple[Expr, Expr]:
    return call.arguments[0], Call("until_nul", (value,), call.span)


OF_CASE = row("`lower(s)`, `upper(s)`", "ASCII letters in one case; all else stays as it is")
OF_BLANKS = row('`strip(s)`, `strip(s, "chars")`', "without blanks (space, `\\t\\n\\r\\v\\f`), or some ASCII characters, at its ends")
OF_REPLACING = row('`replace(s, "old", "new")`', "each occurrence replaced, from the left")
OF_BYTES = row("`slice(s, start, stop)`", "these bytes; a character must not be cut", "`index`, `text`")
BEFORE_NUL = row("`until_nul(b)`", "what comes before the first NUL, all if there is none")
WITH_NULS = row("`padded(s, 16)`", "the text with NULs behind it to that size", "`length`")

FUNCTIONS = (
    of_texts("lower", Texts(("text",), None), _lower_case, SEVERAL, undone_by(), OF_CASE),
    of_texts("upper", Texts(("text",), None), _lower_case, SEVERAL, undone_by(), OF_CASE),
    of_texts("strip", Texts(("text", "characters"), None, optional=1), _lower_strip, SEVERAL, undone_by(), OF_BLANKS),
    of_texts("replace", Texts(("text", "pattern", "quoted"), None), _lower_replace, SEVERAL, undone_by(), OF_REPLACING),
    of_texts("slice", Texts(("text", "integer", "integer"), None), _lower_slice, SEVERAL, undone_by(), OF_BYTES),
    of_texts(
        "until_nul",
        Texts(("text",), None),
        _lower_until_nul,
        ByType(_filled),
        undone_by(padded=loses(BEHIND_NUL)),
        BEFORE_NUL,
    ),
    of_texts("padded", Texts(("text", "size"), None), _lower_padded, _until_nul, undone_by(until_nul=loses(BEHIND_NUL)), WITH_NULS),
)
