"""Elements that are known by a key: one look at each element, which finds the number of the one, or that there is none or more than one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Compare, For, If, Local, Select
from rosetta_jit.kernel.terms import index
from rosetta_jit.language import typed
from rosetta_jit.language.algebra.normal_form import rebuilt
from rosetta_jit.language.places import shown_fields
from rosetta_jit.lowering.writer import block

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.kernel.ir import Expr
    from rosetta_jit.lowering.evaluation import Evaluation

NONE, SEVERAL = -1, -2
"""What is found instead of a number."""


def number_in(search: typed.Search, values: Evaluation) -> Expr:
    """The number of the element; an error of kind ``index`` unless there is one, where that is required."""
    if not search.required:
        return _looked_for(search, values)
    found = values.of(replace(search, required=False))
    array = shown_fields(search.place.steps)
    for wrong, what in ((NONE, "has no element"), (SEVERAL, "has more than one element")):
        is_right = Compare("ne", found, index(wrong))
        values.writer.expect(is_right, "index", values.where, f"`{array}` {what} {search.wanted}", line=values.line)
    return found


def _looked_for(search: typed.Search, values: Evaluation) -> Local:
    writer = values.writer
    count = values.source.count(search.place, values)
    found, number = writer.var("found", index(NONE)), Local("i64", writer.fresh("element"))
    with values.source.forgetting(), writer.nested() as body:
        inner = values.with_local(search.variable.name, number)
        holds = inner.of(search.condition)
        with writer.nested() as hit:
            writer.assign(found, Select(Compare("eq", found, index(NONE)), number, index(SEVERAL)))
        writer.emit(If(holds, block(hit)))
    writer.emit(For(number.name, count, block(body)))
    return found


def look_ahead(rules: tuple[typed.Rule, ...], values: Evaluation) -> None:
    """Search before a loop for what its rules search for in each round, where that is the same and cannot fail."""
    for search in _in_rules(rules):
        if _cannot_fail(search) and all(name in values.variables for name in _variables(search)):
            values.of(replace(search, required=False))


def _cannot_fail(search: typed.Search) -> bool:
    """Whether it is a text or number that is written down, as the key of an array of the message itself."""
    plain = not any(isinstance(step, typed.IndexStep) for step in search.place.steps)
    match search.condition:
        case typed.IsText():
            return plain
        case typed.Binary(_, typed.Access(), typed.Const()):
            return plain
        case _:
            return False


def _variables(search: typed.Search) -> Iterator[str]:
    return (each.name for each in _parts(search.condition) if isinstance(each, typed.Local) and each != search.variable)


def _in_rules(rules: tuple[typed.Rule, ...]) -> Iterator[typed.Search]:
    for rule in rules:
        match rule:
            case typed.Assign(place, value) | typed.SetLength(place, value):
                yield from _in((value, *(step.index for step in place.steps if isinstance(step, typed.IndexStep))))
            case typed.For(_, start, stop, body):
                yield from _in((start, stop))
                yield from _in_rules(body)
            case typed.When(condition, then, otherwise):
                yield from _in((condition,))
                yield from _in_rules((*then, *otherwise))
            case typed.Reject(pieces=pieces):
                yield from _in(pieces)
            case _:
                pass


def _in(values: tuple[typed.Expr, ...]) -> Iterator[typed.Search]:
    return (part for value in values for part in _parts(value) if isinstance(part, typed.Search))


def _parts(expr: typed.Expr) -> Iterator[typed.Expr]:
    yield expr
    below: list[typed.Expr] = []
    rebuilt(expr, lambda part: below.append(part) or part)
    for part in below:
        yield from _parts(part)
