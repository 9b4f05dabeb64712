"""Fields of a tagged message may come in any order, and mostly come in that of their numbers: where the next one must come, it is guessed.

A guess that is right costs a comparison: the tag need not be taken apart, and no table be asked where its field is read. One that is wrong
costs several times what it saves, so that what may be absent is not guessed.

    case = tag; goes_on = true
    while goes_on:
      goes_on = false; guess = none
      switch case: … each reads its field and says which tag it expects behind it: guess = …
      if the message goes on with that tag: skip it; case = guess; goes_on = true
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Compare, Const, Convert, Expr, If, Load, Local, Select, Switch, While
from rosetta_jit.kernel.terms import BEGIN, END, add, index
from rosetta_jit.lowering.writer import Where, Writer, block
from rosetta_jit.startup.dataclass import dataclass

NONE = -1
"""The guess where there is none: no tag is negative."""

TWO_BYTE_TAGS = 1 << 14
"""Tags below this take one byte or two."""

RUN = 16
"""Fields in a row of which each guesses the next one. What compilers know of one field they work out from the one before."""

MOST_GUESSED = 350
"""Fields up to which they are guessed. Of more, guesses save a sixth of a message's time, and cost as much to compile as all else."""

NESTED = 12
"""Blocks within blocks from which on nothing is guessed: a kernel nests a hundred deep, and guessing adds to it."""

TRUE, FALSE = Const("bool", value=True), Const("bool", value=False)


@dataclass(frozen=True, slots=True)
class Case:
    """A tag, how what is behind it is read, and the tag that is expected behind that.

    ``is_long``: reading gets on, but by how much the proof cannot follow, and a check says it.
    """

    tag: int
    read: Callable[[], None]
    guess: int = NONE
    is_long: bool = False


def read_cases(writer: Writer, tag: Local, cases: Sequence[Case], unknown: Callable[[], None], where: Where, stop: Expr) -> None:
    """Read what is behind a tag, and on as long as guesses are right; ``unknown`` reads it if no case does."""
    start = writer.position
    after = writer.var("next", start)
    if len(writer.around) >= NESTED or len(cases) > MOST_GUESSED or all(case.guess == NONE for case in cases):
        known = tuple((case.tag, _body(writer, case.read, after)) for case in cases)
        writer.emit(Switch(tag, known, _body(writer, unknown, after)))
        writer.position = after
        return
    case, guess, goes_on = writer.var("case", tag), writer.var("guess", index(NONE)), writer.var("goes_on", TRUE)
    with writer.nested() as body:
        writer.assign(goes_on, FALSE)
        writer.assign(guess, index(NONE))
        writer.position = after
        known = tuple((each.tag, _guessing(writer, each, after, guess, number, where)) for number, each in enumerate(cases, 1))
        writer.emit(Switch(case, known, _further(writer, unknown, after, where)))
        _go_on(writer, guess, after, case, goes_on, stop)
    invariant = Compare("ge", after, BEGIN), Compare("ge", after, start), Compare("le", after, END)
    writer.emit(While(goes_on, block(body), invariant, after))
    writer.position = after


def _guessing(writer: Writer, case: Case, after: Local, guess: Local, number: int, where: Where) -> Block:
    """What is read, and the guess, unless a run ends here."""
    body = _further(writer, case.read, after, where) if case.is_long else _body(writer, case.read, after)
    ends_run = number % RUN == 0 and case.guess != case.tag
    if ends_run or not NONE < case.guess < TWO_BYTE_TAGS:
        return body
    return (*body, Assign(guess.name, index(case.guess)))


def _further(writer: Writer, read: Callable[[], None], after: Local, where: Where) -> Block:
    """What is read, and that it is something: true anyway, and said for the proof that each round gets on."""

    def surely() -> None:
        read()
        _expect_further(writer, after, where)

    return _body(writer, surely, after)


def _expect_further(writer: Writer, start: Expr, where: Where) -> None:
    is_further = Binary("and", Compare("gt", writer.position, start), Compare("le", writer.position, END))
    writer.expect(is_further, "truncated", where, "a field goes beyond its message")


def _body(writer: Writer, read: Callable[[], None], after: Local) -> Block:
    with writer.nested() as body:
        read()
        writer.assign(after, writer.position)
    return block(body)


def _go_on(writer: Writer, guess: Local, after: Local, case: Local, goes_on: Local, stop: Expr) -> None:
    """Start another round if the message goes on with the tag that was guessed: of one byte, or of two."""
    with writer.nested() as inside:
        bytes_ = writer.let("bytes", Convert("i64", Load("u16", after)))
        short = Compare("lt", guess, index(0x80))
        upper = Binary("shl", Binary("shr", guess, index(7)), index(8))
        long = Binary("or", Binary("or", Binary("and", guess, index(0x7F)), index(0x80)), upper)
        right = Compare("eq", Select(short, Binary("and", bytes_, index(0xFF)), bytes_), Select(short, guess, long))
        with writer.nested() as again:
            writer.assign(after, add(after, Select(short, index(1), index(2))))
            writer.assign(case, guess)
            writer.assign(goes_on, TRUE)
        writer.emit(If(right, block(again)))
    there = Compare("le", after, Binary("sub", stop, index(2)))
    writer.emit(If(Compare("ge", guess, index(0)), (If(there, block(inside)),)))
