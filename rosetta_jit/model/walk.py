"""What expressions and rules are made of, and the same ones of other parts: what every walk over them has in common.

What nothing changes in stays the object that it is. The depth of an expression is bounded by the parser, so that walks may be recursive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from operator import is_
from typing import Any, TypeVar, assert_never, cast

from rosetta_jit.model import mapping
from rosetta_jit.model.expr import (
    Binary,
    Call,
    Choice,
    Coerced,
    Expr,
    Given,
    Index,
    Item,
    Keyed,
    Len,
    List,
    Literal,
    Member,
    Name,
    Nearest,
    Path,
    Side,
    Slice,
    Step,
    Unary,
)
from rosetta_jit.model.mapping import Rule
from rosetta_jit.startup.dataclass import replace

Field = Path | Len
"""A field or its length."""

NodeT = TypeVar("NodeT")
"""An expression, a rule, or a part of one."""

ItemT = TypeVar("ItemT")
"""An item of a tuple."""


def renewed(old: NodeT, **parts: object) -> NodeT:
    """The same with other parts; itself where all of them are what it has, as most are for most that ask."""
    for name, part in parts.items():
        if getattr(old, name) is not part:
            return replace(cast("Any", old), **parts)
    return old


def changed(items: tuple[ItemT, ...], change: Callable[[ItemT], ItemT]) -> tuple[ItemT, ...]:
    """Items that are changed; the tuple itself where none is."""
    new = tuple(map(change, items))
    return items if all(map(is_, new, items)) else new


def _pair(pair: tuple[Expr, Expr], change: Callable[[Expr], Expr]) -> tuple[Expr, Expr]:
    first, second = pair
    new = change(first), change(second)
    return pair if new[0] is first and new[1] is second else new


def rebuilt(expr: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """The expression with each of its parts changed; a path's parts are the indices in it."""
    match expr:
        case Literal() | Name():
            return expr
        case Path():
            return with_indices(expr, change)
        case Len(path):
            return renewed(expr, path=with_indices(path, change))
        case Unary(operand=operand):
            return renewed(expr, operand=change(operand))
        case Binary(left=left, right=right):
            return renewed(expr, left=change(left), right=change(right))
        case Call(arguments=arguments):
            where = None if expr.where is None else change(expr.where)
            return renewed(expr, arguments=changed(arguments, change), where=where)
        case Choice(cases, otherwise):
            pairs = changed(cases, lambda pair: _pair(pair, change))
            pieces = changed(expr.pieces, change)
            return renewed(expr, cases=pairs, otherwise=None if otherwise is None else change(otherwise), pieces=pieces)
        case List(items):
            return renewed(expr, items=changed(items, change))
        case Item(items=items, index=index):
            return renewed(expr, items=change(items), index=change(index))
        case Given(arguments=arguments):
            return renewed(expr, arguments=changed(arguments, change))
        case Coerced(place, value):
            return renewed(expr, place=with_indices(place, change), value=change(value))
        case Nearest(value, again, origin):
            return renewed(expr, value=change(value), again=change(again), place=change(origin))
        case _:
            assert_never(expr)


def with_expressions(rule: Rule, change: Callable[[Expr], Expr]) -> Rule:
    """A rule with the expressions changed that it has itself; the rules within it are as they were."""
    match rule:
        case mapping.Assign(place, value, where=where):
            where = None if where is None else change(where)
            return renewed(rule, place=with_indices(place, change), value=change(value), where=where)
        case mapping.SetLength(place, value):
            return renewed(rule, place=with_indices(place, change), value=change(value))
        case mapping.Relation(place, value):
            return renewed(rule, place=_with_indices(place, change), value=change(value))
        case mapping.For(start=start, stop=stop):
            kept = None if rule.kept is None else renewed(rule.kept, condition=change(rule.kept.condition))
            return renewed(rule, start=change(start), stop=change(stop), kept=kept)
        case mapping.When(condition=condition):
            return renewed(rule, condition=change(condition))
        case mapping.Ignore(place) | mapping.Default(place):
            return renewed(rule, place=with_indices(place, change))
        case mapping.Arranged(place, flag, cases):
            pairs = changed(cases, lambda pair: _pair(pair, change))
            return renewed(rule, place=with_indices(place, change), flag=with_indices(flag, change), cases=pairs)
        case mapping.SetState(value=value):
            return renewed(rule, value=change(value))
        case mapping.Reject(pieces=pieces):
            return renewed(rule, pieces=changed(pieces, change))
        case mapping.Several(places, value):
            return renewed(rule, places=changed(places, lambda place: with_indices(place, change)), value=change(value))
        case mapping.SameNames() | mapping.Rest():
            return rule
        case _:
            assert_never(rule)


def expressions_of(rule: Rule) -> list[Expr]:
    """The expressions that a rule has itself, those of the rules within it left out."""
    found: list[Expr] = []
    with_expressions(rule, lambda expr: found.append(expr) or expr)
    return found


RuleT = TypeVar("RuleT")
"""A rule of a mapping as it is written, or a typed one."""


def rules_in(rule: RuleT) -> tuple[RuleT, ...]:
    """The rules of a block; none of another rule."""
    if isinstance(rule, mapping.For):
        return cast("mapping.For[RuleT, object]", rule).body
    if isinstance(rule, mapping.When):
        block = cast("mapping.When[RuleT, object]", rule)
        return (*block.then, *block.otherwise)
    return ()


def every_rule(rules: tuple[RuleT, ...]) -> Iterator[RuleT]:
    """Rules, and those within their blocks: a block comes before what is in it."""
    for rule in rules:
        yield rule
        yield from every_rule(rules_in(rule))


def _with_indices(place: Field | List, change: Callable[[Expr], Expr]) -> Field | List:
    """A place, or several, with its indices changed."""
    match place:
        case Len(path):
            return renewed(place, path=with_indices(path, change))
        case List(items):
            return renewed(place, items=changed(items, lambda each: rebuilt(each, change)))
        case Path():
            return with_indices(place, change)


def with_indices(path: Path, change: Callable[[Expr], Expr]) -> Path:
    """A path with its indices changed."""
    if INDEXED.isdisjoint(map(type, path.steps)):
        return path
    return renewed(path, steps=changed(path.steps, lambda step: _with_indices_in(step, change)))


INDEXED = frozenset((Index, Keyed, Slice))
"""The steps that have expressions in them; most paths have none."""


def _with_indices_in(step: Step, change: Callable[[Expr], Expr]) -> Step:
    match step:
        case Index(index):
            return renewed(step, index=change(index))
        case Keyed(value=value):
            return renewed(step, value=change(value))
        case Slice(start, stop, by):
            return renewed(step, start=change(start), stop=None if stop is None else change(stop), step=change(by))
        case _:
            return step


def parts(expr: Expr) -> Iterator[Expr]:
    """Every part of an expression, itself first, those within indices included."""
    yield expr
    below: list[Expr] = []
    rebuilt(expr, lambda part: below.append(part) or part)
    for part in below:
        yield from parts(part)


def fields_of(expr: Expr, side: Side) -> list[Field]:
    """The fields of one side that an expression reads, each once, those within indices included."""
    found = (part for part in parts(expr) if isinstance(part, Path | Len) and side_of(part) == side)
    return list(dict.fromkeys(found))


def side_of(field: Field) -> Side:
    """The side that a field is on."""
    return path_of(field).side


def path_of(field: Field) -> Path:
    """The field that a length is of; the field itself otherwise."""
    return field.path if isinstance(field, Len) else field


def names_of(path: Path) -> tuple[str, ...]:
    """The fields on the way, without indices."""
    return tuple(step.name for step in path.steps if isinstance(step, Member))


def renamed(expr: Expr, names: Mapping[str, Expr]) -> Expr:
    """The expression with expressions in place of names."""
    if isinstance(expr, Name):
        return names.get(expr.name, expr)
    return rebuilt(expr, lambda part: renamed(part, names)) if names else expr
