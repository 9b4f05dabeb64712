"""Which of the nine operations of the paper's table 2 a mapping uses, decided by its typed rules.

A node of the rules that means an operation by itself stands in `_of_node`: a new one needs one line there.
What only a whole rule shows (elements in another order, a generated value, a moment that is computed) is decided in `_of_assignment`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Literal, TypeGuard, get_args

from rosetta_jit.explain.walk import names_of, nodes, places
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language import typed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.function import Operation
from rosetta_jit.language.installed import functions
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.language.typed import Expr, Place, Rule
from rosetta_jit.model.expr import COMPARISONS, LOGIC
from rosetta_jit.model.types import Array, Bytes, Float, Int, String
from rosetta_jit.parsing.search import SearchPath

OPERATIONS: tuple[Operation, ...] = get_args(Operation)

Direction = Literal["unpack", "pack"]
Uses = dict[Operation, tuple[Direction, ...]]

MOMENT = re.compile(r"(?:^|_)(time|timestamp|stamp|duration|date|n?secs?|nanosec|usecs?)(?:_|$)")
"""A field that holds a moment or a duration, by its name, or by that of a field around it."""


def operations(mapping: str, *, folders: Iterable[str] = ()) -> Uses:
    """The operations of a mapping, each with the directions that use it, in the order of `OPERATIONS`.

    Raises
    ------
    MappingError
        It is wrong.
    """
    search = SearchPath.of(folders)
    checked = check(parse(search.open(mapping)), Readers(installed()), search)
    blocks: dict[Direction, tuple[Rule, ...]] = {"unpack": checked.unpack or (), "pack": checked.pack or ()}
    used: dict[Direction, frozenset[Operation]] = {name: frozenset(operations_of(rules)) for name, rules in blocks.items()}
    uses: Uses = {each: tuple(name for name, some in used.items() if each in some) for each in OPERATIONS}
    return {each: found for each, found in uses.items() if found}


def operations_of(rules: tuple[Rule, ...], *, chosen: bool = False) -> Iterator[Operation]:
    """The operations of rules; they are ``chosen`` where they stand in a `when`."""
    for rule in rules:
        match rule:
            case typed.Assign() | typed.SetLength():
                yield from _of_nodes((rule.place, rule.value))
                if isinstance(rule, typed.Assign):
                    yield from _of_nodes(rule.by)
                    yield from _of_assignment(rule, chosen=chosen)
            case typed.For(_, start, stop, body, kept=kept):
                yield "subtype loops"
                if kept is not None:
                    yield "predicate assignment"
                    yield from _of_nodes(kept.condition)
                yield from _of_nodes((start, stop))
                yield from operations_of(body, chosen=chosen)
            case typed.When(condition, then, otherwise):
                if not all(isinstance(each, typed.Reject) for each in (*then, *otherwise)):
                    yield "predicate assignment"
                yield from _of_nodes(condition)
                yield from operations_of((*then, *otherwise), chosen=True)
            case typed.Reject():
                yield "rejection"
            case typed.SetState(_, value):
                yield from _of_nodes(value)
            case typed.Default():
                yield "generators"
            case _:
                yield from _of_nodes(rule)


def _of_nodes(root: object) -> Iterator[Operation]:
    for node in nodes(root):
        yield from _of_node(node)


def _of_node(node: object) -> Iterator[Operation]:
    match node:
        case typed.IsText():
            yield "string manipulation"
        case typed.Choice(otherwise=otherwise):
            yield "predicate assignment"
            if otherwise is None:
                yield "rejection"
        case typed.Call(function) | typed.Reduce(function):
            yield functions()[function].operation
        case typed.HostCall() | typed.StateVariable():
            yield "generators"
        case typed.Has() | typed.Search():
            yield "predicate assignment"
        case typed.Rescale():
            yield "arithmetic"
        case typed.Convert(rule="exact") | typed.Nearest():
            yield "rejection"
        case typed.Convert(rule=rule) if rule != "widen":
            yield "arithmetic"
        case typed.Unary("-"):
            yield "arithmetic"
        case typed.Binary(operator) if operator not in COMPARISONS | LOGIC:
            yield "arithmetic"
        case _:
            pass


def _of_assignment(rule: typed.Assignment, *, chosen: bool) -> Iterator[Operation]:
    """What shows only in a rule as a whole."""
    place, value = rule.place, rule.value
    read = places(value, "wire" if place.side == "holder" else "holder")
    if any(isinstance(_element(each.type), Float) for each in read):
        yield "arithmetic"
    if _reorders(place, value):
        yield "array reorder"
    if _makes_text(place, value, chosen=chosen):
        yield "string manipulation"
    if isinstance(place.type, Array) or any(_is_nested(each) for each in (place, *read)):
        yield "subtype loops"
    if not read and not chosen:
        yield "generators"
    if _computes(value) and any(MOMENT.search(name) for each in (place, *read) for name in names_of(each)):
        yield "date manipulation"


def _element(type_: object) -> object:
    return _element(type_.element) if isinstance(type_, Array) else type_


def _reorders(place: Place, value: Expr) -> bool:
    """Whether an element comes from one of another index, or elements and fields become each other."""
    read = [node.place for node in nodes(value) if isinstance(node, typed.Access)]
    return any(_indices(place) != _indices(each) for each in read)


def _indices(place: Place) -> tuple[Expr, ...]:
    return tuple(step.index for step in place.steps if isinstance(step, typed.IndexStep))


def _makes_text(place: Place, value: Expr, *, chosen: bool) -> bool:
    """Whether a text is chosen, or bytes and text become each other."""
    match place.type, value:
        case String() | Bytes(), typed.Const():
            return chosen
        case (String(), typed.Access(type=Bytes())) | (Bytes(), typed.Access(type=String())):
            return True
        case _:
            return False


def _is_nested(place: Place) -> bool:
    """Whether a place is in a message within the message, other than a moment."""
    names = names_of(place)
    return len(names) > 1 and not MOMENT.search(names[-2])


def _computes(value: Expr) -> bool:
    """Whether a number is made of others."""
    return any(_is_arithmetic(node) and isinstance(node.type, Int | Float) for node in nodes(value))


def _is_arithmetic(node: object) -> TypeGuard[typed.Binary | typed.Call]:
    return isinstance(node, typed.Binary) or (isinstance(node, typed.Call) and functions()[node.function].operation == "arithmetic")
