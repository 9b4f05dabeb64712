"""Checks of the cases that rules give unions, against what their discriminators select."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import check as words
from rosetta_jit.language.algebra.polynomial import Polynomial, TooComplexError
from rosetta_jit.language.check.written_places import enter
from rosetta_jit.language.typed import Const
from rosetta_jit.model.initial_values import selected, selecting
from rosetta_jit.model.types import Field, Union

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.language.check.tiling import Run
    from rosetta_jit.language.check.written_places import Write
    from rosetta_jit.language.scope import Message
    from rosetta_jit.model.types import Struct

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
