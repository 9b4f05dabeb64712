"""Relations as rules for each direction, turned round with the types of their fields: names are looked up before rules are typed."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import wires as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.arrays.counts import LayoutError
from rosetta_jit.language.arrays.parts import sources_in, substituted
from rosetta_jit.language.both_ways.directions import in_each_direction
from rosetta_jit.language.resolve.expressions import type_expr
from rosetta_jit.language.resolve.messages import message_named, scope_between
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Const
from rosetta_jit.language.typed import Expr as Typed
from rosetta_jit.language.uses import UsableMappings
from rosetta_jit.model.expr import Call, Expr, Literal, Member, Path
from rosetta_jit.model.mapping import For, Mapping
from rosetta_jit.model.types import Schema, Type
from rosetta_jit.model.walk import every_rule, expressions_of, fields_of, parts
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.arrays import element_loops, layouts
else:
    element_loops = Late("rosetta_jit.language.arrays.element_loops")
    layouts = Late("rosetta_jit.language.arrays.layouts")

FIRST = Literal(0)


def derived(mapping: Mapping, schema: Schema, usable: UsableMappings, problems: list[Diagnostic]) -> Mapping:
    """The mapping with all rules of each direction in the block of that direction.

    Expressions whose names are wrong have no type; that is reported when the rules are typed.
    """

    @cache
    def scope() -> Scope | None:
        return _scope(mapping, schema, usable)

    def typed(expr: Expr) -> Typed | None:
        known = scope()
        return None if known is None else type_expr(_of_first(expr), known)

    def type_of(expr: Expr) -> Type | None:
        found = typed(expr)
        return None if found is None else found.type

    def constant_of(expr: Expr) -> int | None:
        found = typed(expr) if not fields_of(expr, "holder") and not fields_of(expr, "wire") else None
        return found.value if isinstance(found, Const) and type(found.value) is int else None

    refused = [words.arrival_to_pack(call.span) for call in _arrivals(mapping)]
    problems.extend(refused)
    return in_each_direction(mapping, type_of, constant_of, [] if refused else problems)


def _arrivals(mapping: Mapping) -> Iterator[Call]:
    """Where relations ask whether a message of a wire has arrived."""
    names = {each.name for each in mapping.wires}
    for rule in every_rule(mapping.rules or ()) if names else ():
        for expr in expressions_of(rule):
            for part in parts(expr):
                match part:
                    case Call("has", (Path("wire", (Member(name),)),)) if name in names:
                        yield part
                    case _:
                        pass


def _scope(mapping: Mapping, schema: Schema, usable: UsableMappings) -> Scope | None:
    """What rules that unpack can name, in all loops; None where a side has no message."""
    holder, wire = (message_named(schema, name) for name in (mapping.holder_type, mapping.wire_type))
    if holder is None or wire is None:
        return None
    found = scope_between({"holder": holder, "wire": wire}, mapping, usable, [])
    return replace(found, locals=tuple(rule.variable for rule in every_rule(mapping.rules or ()) if isinstance(rule, For)))


def _of_first(expr: Expr) -> Expr:
    """An expression of the elements of arrays, for the first one of each."""
    try:
        views = {source: layouts.view_of(source) for source in sources_in(expr)}
    except LayoutError:
        return expr
    first: dict[Expr, Expr] = {source: element_loops.element_at(view, [FIRST] * len(view.axes)) for source, view in views.items()}
    return substituted(expr, first, FIRST)
