"""Questions about texts: how long they are, what they hold, which one comes first."""

from __future__ import annotations

from typing import Literal, cast

from rosetta_jit.functions.forms import of_texts, row, undone_by
from rosetta_jit.kernel.nodes import Compare, Expr
from rosetta_jit.language.function import SEVERAL, Texts
from rosetta_jit.language.typed import BOOL, INT64, Call
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.texts.search import compared, find, has_at
from rosetta_jit.lowering.texts.values import placed_of, quoted

HOLDS = row('`starts_with(s, t)`, `ends_with(s, t)`, `contains(s, "t")`', "a bool")


def _lower_size(call: Call, values: Evaluation) -> Expr:
    return values.writer.let("size", placed_of(call.arguments[0], values).size)


def _lower_order(call: Call, values: Evaluation) -> Expr:
    left, right = (placed_of(each, values) for each in call.arguments)
    return compared(values.writer, left, right)


def _lower_end(call: Call, values: Evaluation) -> Expr:
    end = cast("Literal['starts_with', 'ends_with']", call.function)
    return has_at(values.writer, end, placed_of(call.arguments[0], values), placed_of(call.arguments[1], values))


def _lower_contains(call: Call, values: Evaluation) -> Expr:
    view = placed_of(call.arguments[0], values)
    return Compare("lt", find(values.writer, view.lane, view.first, view.after, quoted(call.arguments[1])), view.after)


FUNCTIONS = (
    of_texts(
        "len",
        Texts(("text",), INT64),
        _lower_size,
        SEVERAL,
        undone_by(),
        row("`len(s)`", "how many bytes a text has that is computed, as int64"),
    ),
    of_texts(
        "<=>",
        Texts(("text", "text"), INT64),
        _lower_order,
        SEVERAL,
        undone_by(),
        row("`.a == .b`, `.a < lower(.b)`, …", "a bool: texts are compared byte by byte"),
    ),
    of_texts("starts_with", Texts(("text", "text"), BOOL), _lower_end, SEVERAL, undone_by(), HOLDS),
    of_texts("ends_with", Texts(("text", "text"), BOOL), _lower_end, SEVERAL, undone_by(), HOLDS),
    of_texts("contains", Texts(("text", "pattern"), BOOL), _lower_contains, SEVERAL, undone_by(), HOLDS),
)
