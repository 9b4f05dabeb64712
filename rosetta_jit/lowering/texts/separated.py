"""Texts between separators: an array of them as one text, and one text as its parts.

An empty text has no parts, and no element holds a separator, so that what was joined is what is split again.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager

from rosetta_jit.kernel.nodes import Binary, Compare, Expr, For, Local, Select, Unary, Used
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.texts.search import find, parts
from rosetta_jit.lowering.texts.views import Quoted, View, append, between, lane_of, sound
from rosetta_jit.lowering.writer import Writer, block


def count_of_parts(writer: Writer, view: View, pattern: bytes) -> Expr:
    """In how many parts a text is split."""
    return Select(Compare("eq", view.size, index(0)), index(0), parts(writer, view, pattern))


@contextmanager
def parts_of(writer: Writer, view: View, pattern: bytes, count: Expr) -> Generator[tuple[Local, View]]:
    """A block that has each part of a text in turn, with its number."""
    start, number = writer.var("start", view.first), Local("i64", writer.fresh("part"))
    with writer.nested() as body:
        first = writer.let("first", between(start, view.first, view.after))
        after = find(writer, view.lane, first, view.after, pattern)
        yield number, sound(writer, View(view.lane, first, after, view.valid))
        writer.assign(start, Binary("min", add(after, len(pattern)), view.after))
    writer.emit(For(number.name, count, block(body)))


def between_separators(
    writer: Writer, count: Expr, pattern: bytes, element: Callable[[Local], View], must: Callable[[Expr, str], None]
) -> View:
    """The elements of an array with a separator between each two; ``must`` refuses those that could not be split again."""
    lane, number = lane_of(writer), Local("i64", writer.fresh("element"))
    start = writer.let("text", Used(lane))
    with writer.nested() as body:
        first = writer.let("first", Used(lane))
        append(writer, element(number))
        after = writer.let("after", Used(lane))
        append(writer, Quoted(pattern))
        whole = sound(writer, View(lane, first, writer.let("end", Used(lane))))
        found = find(writer, lane, whole.first, whole.after, pattern)
        is_last = Compare("eq", add(number, 1), count)
        beyond = Binary("and", is_last, Compare("gt", found, add(after, -len(pattern))))  # behind the last one stands none
        must(Binary("or", Compare("eq", found, after), beyond), "an element holds the separator, or ends as it begins")
        alone = Binary("and", Compare("eq", count, index(1)), Compare("eq", first, after))
        must(Unary("not", alone), "one empty text cannot be told from none")
    writer.emit(For(number.name, count, block(body)))
    behind = Select(Compare("eq", count, index(0)), index(0), index(len(pattern)))
    return sound(writer, View(lane, start, writer.let("after", Binary("sub", Used(lane), behind))))
