"""Reports about arrays whose elements are not each set once, and about cases of unions against what their discriminators select."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.algebra.polynomial import Polynomial, TooComplexError, add, number
from rosetta_jit.language.check.tiling import Run, interval, join, overlap
from rosetta_jit.language.check.written_places import Write, enter
from rosetta_jit.language.limits import MAX_ELEMENTS_SHOWN
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Const
from rosetta_jit.model.initial_values import selected, selecting
from rosetta_jit.model.types import Field, Struct, Union
from rosetta_jit.source import Span


def coverage(path: str, runs: list[Run], length: Polynomial, span: Span | None, *, optional: bool) -> list[Diagnostic]:
    """What is wrong with the runs of elements that rules set, if they are not exactly 0 to ``length``.

    Parameters
    ----------
    span
        The rule that sets the length.
    optional
        Elements may be left out, but none set twice.
    """
    joined = join(runs)
    clash = overlap(joined)
    if clash is not None:
        return [words.overlap(clash[1].span, path, clash[0].span)]
    size = length.constant()
    if not joined and size == 0:
        return []
    if size is not None and (beyond := _beyond(path, [single for run in runs for single in join([run])], size)):
        return beyond
    intervals = [known for run in joined if (known := interval(run)) is not None]
    if size is not None and len(intervals) == len(joined):
        return [] if optional else _missing(path, intervals, size, span)
    if optional or _is_whole(joined, length):
        return []
    place = joined[0].span if joined else span
    if len(joined) == 1 and not joined[0].dimensions and joined[0].start == number(0):
        return [words.loop_of_other_length(place, path, str(length), str(joined[0].length))]
    return [words.coverage(place, path, str(length), tuple(_shown(run) for run in joined[:MAX_ELEMENTS_SHOWN]))]


def _is_whole(joined: list[Run], length: Polynomial) -> bool:
    return len(joined) == 1 and not joined[0].dimensions and joined[0].start == number(0) and joined[0].length == length


def _beyond(path: str, singles: list[Run], size: int) -> list[Diagnostic]:
    wrong = [(run, known) for run in singles if (known := interval(run)) is not None and (known[0] < 0 or known[1] > size)]
    return [words.element_beyond(run.span, path, start if start < 0 else max(start, size), size) for run, (start, _) in wrong]


def _missing(path: str, intervals: list[tuple[int, int]], size: int, span: Span | None) -> list[Diagnostic]:
    problems: list[Diagnostic] = []
    reached = 0
    for start, end in [*sorted(intervals), (size, size)]:
        if start > reached:
            problems.append(words.element_missing(span, path, reached, start - 1))
        reached = max(reached, end)
    return problems


def _shown(run: Run) -> str:
    text = f"{run.start} to {add(run.start, run.length)}"
    return text + "".join(f", {count} times, {stride} apart" for stride, count in run.dimensions)


if TYPE_CHECKING:
    Writes = Mapping[str, list[Write]]


def implied(struct: Struct, writes: Writes, step: int = 0) -> set[str]:
    """The discriminators in a struct of whose unions a case is set; ``step`` is the one of a write that names the case."""
    found = {
        each.type.discriminator
        for each in struct.fields
        if isinstance(each.type, Union) and any(_sets_case(write, step) for write in writes.get(each.name, []))
    }
    return found - {""}


def _sets_case(write: Write, step: int) -> bool:
    return len(write.steps) > step and (write.value is not None or write.length is not None)


def contradictions(path: str, struct: Struct, writes: Writes, message: Message) -> Iterator[Diagnostic]:
    """Constant discriminators that select another case than the one that is set; what is computed is checked when it is."""
    for each in struct.fields:
        if isinstance(each.type, Union) and each.type.discriminator in writes:
            teller = next(field for field in struct.fields if field.name == each.type.discriminator)
            case = next((write.steps[0] for write in writes.get(each.name, []) if _sets_case(write, 0)), None)
            if case is None or isinstance(case, Polynomial):
                continue
            number = 1 + each.type.cases.index(case)
            for write in writes[teller.name]:
                value = _constant(write)
                if value is not None and selected(each.type, value) != number:
                    label = selecting(each.type, message.value_type(teller.type), number)
                    yield words.other_case(write.span, f"{path}.{teller.name}", case.name, (value, label))


def contradictions_in_elements(path: str, struct: Struct, writes: list[Write], level: int, message: Message) -> Iterator[Diagnostic]:
    """The same of elements of an array, of those writes that set parts of the same elements; ``level`` is how many arrays are around it."""
    elements: dict[Run, dict[str, list[Write]]] = {}
    for write in writes:
        try:
            entered = enter(write, level)
        except TooComplexError:
            return  # which is said where elements are counted
        if entered is not None and isinstance(field := entered[1].steps[0], Field):
            elements.setdefault(entered[0], {}).setdefault(field.name, []).append(entered[1].below())
    for parts in elements.values():
        yield from contradictions(path, struct, parts, message)


def _constant(write: Write) -> int | None:
    """The value of a discriminator that is known; 0 is its default."""
    match write.value:
        case None:
            return 0
        case Const(value=int(value)):
            return int(value)
        case _:
            return None
