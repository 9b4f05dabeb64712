"""Filters: a loop over elements, of which those that are kept are set one behind the other.

How many they are was counted before, so that their array has room. What sets an element and cannot fail runs in every round: the next
element that is kept takes its place. So nothing waits for a branch that the processor cannot foresee.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import partial, reduce
from typing import Protocol

from rosetta_jit.kernel.nodes import (
    Assign,
    Binary,
    Compare,
    Convert,
    Expect,
    Expr,
    For,
    Get,
    If,
    Let,
    Load,
    Local,
    Require,
    SetField,
    Stmt,
    Unary,
)
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.kernel.walk import bound_names, subexpressions
from rosetta_jit.language import typed
from rosetta_jit.language.places import places_in
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.rules.look_ahead import look_ahead
from rosetta_jit.lowering.rules.values import Values
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.model.rules import Kept
from rosetta_jit.startup.dataclass import replace


class Runs(Protocol):
    """What runs rules from one side to the other: `rosetta_jit.lowering.rules.statements.Runner`."""

    @property
    def writer(self) -> Writer: ...

    def run(self, rules: tuple[typed.Rule, ...], values: Values) -> None: ...

    def forgetting(self) -> AbstractContextManager[None]: ...

    def count_of(self, place: typed.Place, values: Values) -> Expr: ...


def filtered(runner: Runs, rule: typed.For[typed.Rule, typed.Expr], kept: Kept[typed.Expr], values: Values) -> None:
    """The rounds of a loop that are kept; their arrays have their lengths."""
    writer, stop = runner.writer, values.of(rule.stop)
    counts = [runner.count_of(array, values) for array in filtered_arrays(rule, kept)]
    number, row = Local("i64", writer.fresh(rule.variable)), writer.var(kept.variable, index(0))
    look_ahead((rule,), values)
    writer.certain.add(inside(number, stop))
    with runner.forgetting(), writer.nested() as body:
        inner = replace(values, variables={**values.variables, rule.variable: number, kept.variable: row})
        holds = writer.let("holds", inner.of(kept.condition))
        with runner.forgetting(), writer.nested() as then:
            runner.run(rule.body, inner)
        room = [inside(row, count) for count in dict.fromkeys(counts)]
        checks = _checks(then, room)
        if checks is None:
            then.append(Assign(row.name, add(row, index(1))))
            writer.emit(If(holds, block(then)))
        else:
            then.append(Assign(row.name, add(row, Convert("i64", holds))))
            dropped = Unary("not", holds)
            writer.emit(*(replace(check, condition=Binary("or", dropped, check.condition)) for check in checks))
            can_run = reduce(partial(Binary, "and"), [*(check.condition for check in checks), *room])
            writer.emit(If(can_run, block(then)))
    writer.emit(For(number.name, stop, block(body)))
    for count in dict.fromkeys(counts):
        writer.expect(Compare("eq", row, count), "count", values.where, "the condition held for other elements before", line=values.line)


def filtered_arrays(rule: typed.For[typed.Rule, typed.Expr], kept: Kept[typed.Expr]) -> list[typed.Place]:
    """The arrays that have an element for each round that is kept."""
    step = typed.IndexStep(typed.Local(kept.variable))
    found = [(place, place.steps.index(step)) for place in places_in(rule.body) if step in place.steps]
    return list(dict.fromkeys(typed.Place(place.side, place.steps[:number], place.type) for place, number in found))


def _checks(then: list[Stmt], known: list[Expr]) -> list[Expect] | None:
    """What must be checked before statements may run for elements that are dropped, too, where there is room for one more.

    None where they are no plain moves of numbers, or a check asks for a number of the element. What is ``known`` is not asked again.
    """
    own = {name for stmt in then for name in bound_names(stmt)}
    found: list[Expect] = []
    for stmt in then:
        match stmt:
            case Let() | SetField():
                pass
            case Expect(condition) if condition in known:
                pass
            case Expect(condition) if not _depends(condition, own):
                found.append(stmt)
            case Require(at, size) if not _depends(at, own) and not _depends(size, own):
                pass  # the check before it says so, too
            case _:
                return None
    return found


def _depends(expr: Expr, names: set[str]) -> bool:
    """Whether an expression reads memory, or what has one of these names."""
    return any(isinstance(part, Get | Load) or (isinstance(part, Local) and part.name in names) for part in subexpressions(expr))
