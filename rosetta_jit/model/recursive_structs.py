"""Which structs contain themselves, through whatever fields."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rosetta_jit.model import types


def recursive_structs(type_: types.Type, schema: types.Schema) -> frozenset[str]:
    """Names of the structs that contain themselves, through whatever fields."""
    reached: dict[str, frozenset[str]] = {}
    pending = sorted(_references(type_, schema))
    while pending:
        name = pending.pop()
        if name not in reached:
            reached[name] = _references(schema.types[name], schema)
            pending += sorted(reached[name])
    return frozenset(name for group in _cycles(reached) for name in group)


def _cycles(edges: dict[str, frozenset[str]]) -> list[list[str]]:
    """Groups of names that all reach each other, and single ones that reach themselves (Tarjan's strongly connected components)."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []
    for start in sorted(edges):
        path = [(start, iter(sorted(edges[start])))] if start not in order else []
        while path:
            name, targets = path[-1]
            if name not in order:
                order[name] = lowest[name] = len(order)
                stack.append(name)
            following = next(targets, None)
            if following is None:
                path.pop()
                if path:
                    lowest[path[-1][0]] = min(lowest[path[-1][0]], lowest[name])
                if lowest[name] == order[name]:
                    group = [*_popped(stack, name)]
                    lowest |= dict.fromkeys(group, len(edges))  # a finished group is no way back
                    groups += [group] if len(group) > 1 or name in edges[name] else []
            elif following not in order:
                path.append((following, iter(sorted(edges[following]))))
            else:
                lowest[name] = min(lowest[name], lowest[following])
    return groups


def _popped(stack: list[str], name: str) -> Iterator[str]:
    """Take a stack down to a name."""
    while True:
        top = stack.pop()
        yield top
        if top == name:
            return


def _references(type_: types.Type, schema: types.Schema) -> frozenset[str]:
    """Names of the structs that a type refers to directly; the fields of an unnamed reference count as its own."""
    match type_:
        case types.Ref(name):
            return frozenset([name]) if isinstance(schema.types[name], types.Struct) else frozenset()
        case types.Array(element) | types.Optional(element):
            return _references(element, schema)
        case types.Map(key, value):
            return _references(key, schema) | _references(value, schema)
        case types.Struct(_, fields) | types.Union(_, fields):
            return frozenset[str]().union(*(_references(each.type, schema) for each in fields))
        case types.Bool() | types.Int() | types.Float() | types.String() | types.Bytes() | types.Enum():
            return frozenset()
        case _:
            assert_never(type_)
