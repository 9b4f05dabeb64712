"""How deep types are written inside each other: bounded, since whatever walks a type later calls itself for what is inside."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.limits import MAX_NESTING
from rosetta_jit.model.types import Array, Declaration, Ref, Struct, Type


def reference(type_: Type) -> tuple[str | None, int, bool]:
    """The declared type that a type is or has elements of, within how many arrays, and whether all of those have a fixed length."""
    depth, by_value = 0, True
    while isinstance(type_, Array):
        type_, depth, by_value = type_.element, depth + 1, by_value and type_.length is not None
    return (type_.name if isinstance(type_, Ref) else None), depth, by_value


def references(declaration: Declaration) -> Iterator[tuple[str, int, bool]]:
    """The `reference` of each field that has one."""
    if isinstance(declaration, Struct):
        for each in declaration.fields:
            name, depth, by_value = reference(each.type)
            if name is not None:
                yield name, depth, by_value


def reached(names: Iterable[str], types: Mapping[str, Declaration]) -> set[str]:
    """The names, and all that their types refer to."""
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name not in found and name in types:
            found.add(name)
            pending += (each for each, _, _ in references(types[name]))
    return found


def dependents(names: Iterable[str], types: Mapping[str, Declaration]) -> set[str]:
    """The names, and all whose types refer to them."""
    users: dict[str, list[str]] = {}
    for name, declaration in types.items():
        for each, _, _ in references(declaration):
            users.setdefault(each, []).append(name)
    found: set[str] = set()
    pending = list(names)
    while pending:
        name = pending.pop()
        if name not in found:
            found.add(name)
            pending += users.get(name, ())
    return found


def nesting_problems(types: Mapping[str, Declaration]) -> list[Diagnostic]:
    """Structs that are part of themselves, and those that nest too deep; a vector may lead back to its own struct."""
    endless = _endless(types)
    if endless:
        return [words.contains_itself(types[name].span, name) for name in endless]
    depths: dict[str, int] = {}
    for root in types:
        _measure(root, types, depths)
    deep = [name for name in types if depths[name] > MAX_NESTING]
    first = [name for name in deep if all(depths[each] <= MAX_NESTING for each, _, _ in references(types[name]))]
    return [words.nested_too_deep(types[name].span, name, MAX_NESTING) for name in first or deep]


def _endless(types: Mapping[str, Declaration]) -> list[str]:
    """The types that are left when all are taken away that hold nothing but what was taken away."""
    held = {name: {each for each, _, by_value in references(types[name]) if by_value} for name in types}
    holders: dict[str, list[str]] = {}
    for name, parts in held.items():
        for each in parts:
            holders.setdefault(each, []).append(name)
    ready = [name for name, parts in held.items() if not parts]
    while ready:
        done = ready.pop()
        del held[done]
        for name in holders.get(done, ()):
            held[name].discard(done)
            if not held[name]:
                ready.append(name)
    return list(held)


def _measure(root: str, types: Mapping[str, Declaration], depths: dict[str, int]) -> None:
    """Depth first, with the path as a list; the way back to a type that is being measured counts nothing."""
    path: list[tuple[str, list[str]]] = []
    pending = [root]
    while pending or path:
        if pending:
            name = pending.pop()
            if name not in depths:
                depths[name] = 0
                path.append((name, [each for each, _, _ in references(types[name])]))
                continue
        if path:
            name, left = path[-1]
            if left:
                pending.append(left.pop())
                continue
            path.pop()
            depths[name] = 1 + max((depths[each] + arrays for each, arrays, _ in references(types[name])), default=0)
