"""Messages after those that they contain. None contains itself, and none unfolds to more than a machine can hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.limits import MAX_DEPTH
from rosetta_jit.model.limits import MAX_SLOTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.tree import Definition, Field


def dependencies_first(found: Mapping[str, Definition], problems: list[Diagnostic]) -> tuple[Definition, ...]:
    """The definitions in an order in which each comes after those of its fields, as far as these are found."""
    needs = {name: {each.type.base for each in _nested(definition)} & found.keys() for name, definition in found.items()}
    users: dict[str, list[str]] = {name: [] for name in found}
    for name, needed in needs.items():
        for each in needed:
            users[each].append(name)
    open_ = {name: len(needed) for name, needed in needs.items()}
    ready = [name for name, count in open_.items() if not count]
    for name in ready:  # grows while it is read
        for user in users[name]:
            open_[user] -= 1
            if not open_[user]:
                ready.append(user)
    if len(ready) < len(found):
        problems.append(_cycle(found, {name for name, count in open_.items() if count}))
        return ()
    ordered = tuple(found[name] for name in ready)
    _measure(ordered, problems)
    return ordered


def _nested(definition: Definition) -> list[Field]:
    return [each for each in definition.fields if not each.type.builtin]


def _cycle(found: Mapping[str, Definition], among: set[str]) -> Diagnostic:
    """The report of one cycle: every one of those messages has a field of another one of them."""
    name, path = next(each for each in found if each in among), list[str]()
    field = None
    while name not in path:
        path.append(name)
        field = next(each for each in _nested(found[name]) if each.type.base in among)
        name = field.type.base
    assert field is not None
    return say.cycle(field.type.span, [*path[path.index(name) :], name])


def _measure(ordered: tuple[Definition, ...], problems: list[Diagnostic]) -> None:
    depths: dict[str, int] = {}
    sizes: dict[str, int] = {}
    for each in ordered:
        inner = [field.type.base for field in _nested(each) if field.type.base in depths]
        depths[each.name] = 1 + max((depths[name] for name in inner), default=0)
        sizes[each.name] = len(each.fields) - len(inner) + sum(sizes[name] for name in inner)
        if depths[each.name] > MAX_DEPTH or sizes[each.name] > MAX_SLOTS:
            problems.append(say.too_deep(each.span, each.name, MAX_DEPTH, MAX_SLOTS))
            return
