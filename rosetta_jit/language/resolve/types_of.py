"""The types of expressions before their rules are typed: relations are turned round with them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from rosetta_jit.language.arrays.counts import LayoutError
from rosetta_jit.language.arrays.element_loops import element_at
from rosetta_jit.language.arrays.layouts import view_of
from rosetta_jit.language.arrays.parts import sources_in, substituted
from rosetta_jit.language.resolve.expressions import type_expr
from rosetta_jit.model.expr import Literal
from rosetta_jit.model.mapping import For, When

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.scope import Scope
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Rule
    from rosetta_jit.model.types import Type

FIRST = Literal(0)


def types_of(rules: tuple[Rule, ...], scope_of: Callable[[], Scope | None]) -> TypeOf:
    """The types of expressions in rules; none where there is no scope. What is wrong with them is reported when the rules are typed."""

    @cache
    def scope() -> Scope | None:
        found = scope_of()
        return None if found is None else replace(found, locals=tuple(_variables(rules)), problems=[], named=set())

    def type_of(expr: Expr) -> Type | None:
        known = scope()
        typed = None if known is None else type_expr(_of_first(expr), known)
        return None if typed is None else typed.type

    return type_of


def _of_first(expr: Expr) -> Expr:
    """An expression of the elements of arrays, for the first one of each."""
    try:
        views = {source: view_of(source) for source in sources_in(expr)}
    except LayoutError:
        return expr
    first: dict[Expr, Expr] = {source: element_at(view, [FIRST] * len(view.axes)) for source, view in views.items()}
    return substituted(expr, first, FIRST)


def _variables(rules: tuple[Rule, ...]) -> Iterator[str]:
    """The variables of all loops."""
    for rule in rules:
        match rule:
            case For(variable=variable, body=body):
                yield variable
                yield from _variables(body)
            case When(then=then, otherwise=otherwise):
                yield from _variables((*then, *otherwise))
            case _:
                pass
