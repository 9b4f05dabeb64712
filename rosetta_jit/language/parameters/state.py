"""State variables as a mapping declares them: their types, and what they are before the first message.

A variable has a number, which is that of the kernel's register that holds it. Both directions have variables of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import state as words
from rosetta_jit.catalogue import suggestions
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_STATE
from rosetta_jit.language.typed import StateVariable
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Given, Literal, Side
from rosetta_jit.model.scalars import Scalar
from rosetta_jit.model.types import String
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.parameters import values
else:
    values = Late("rosetta_jit.language.parameters.values")


@cache
def known_types() -> Mapping[str, Scalar]:
    """The types of state variables by name."""
    return {name: type_ for name, type_ in values.SCALARS.items() if not isinstance(type_, String)}


@dataclass(frozen=True, slots=True)
class Declared:
    """The state of a mapping: each variable's initial value by its name, in the order of the text."""

    initial: Mapping[str, bool | int | float]
    types: Mapping[str, str]

    def variables(self, target: Side) -> dict[str, StateVariable]:
        """Those of one direction."""
        return {name: StateVariable(name, number, target, known_types()[self.types[name]]) for number, name in enumerate(self.initial)}


NO_STATE = Declared({}, {})


def declared(mapping: model.Mapping, problems: list[Diagnostic]) -> Declared:
    """What a mapping declares, whose parameters have their values; what is wrong is reported, and the variable has some value."""
    initial: dict[str, bool | int | float] = {}
    types: dict[str, str] = {}
    known = {each.name: "a parameter" for each in mapping.parameters} | {each.name: "a function" for each in mapping.functions}
    problems.extend(words.many(each.span, MAX_STATE) for each in mapping.state[MAX_STATE : MAX_STATE + 1])
    for each in mapping.state[:MAX_STATE]:
        if each.name in known or each.name in initial or each.name == "pi":
            other = known.get(each.name, "a constant" if each.name == "pi" else "a state variable")
            problems.append(words.repeated(each.span, each.name, other))
        elif each.type not in known_types():
            problems.append(words.unknown_type(each.span, each.type, known_types()))
            initial[each.name], types[each.name] = 0, suggestions.closest(each.type, known_types()) or "float64"  # what is probably meant
        else:
            initial[each.name], types[each.name] = _initial(each, problems), each.type
    return Declared(initial, types)


def _initial(state: model.State, problems: list[Diagnostic]) -> bool | int | float:
    """The value at first; nothing is said of one that a parameter is going to tell."""
    if isinstance(state.initial, Given):
        return 0
    if not isinstance(state.initial, Literal):
        problems.append(words.unfit(state.initial.span, state.name, "it is not known before the first message"))
        return 0
    found = values.accepted(values.written(state.initial), model.Parameter(state.name, state.type, is_list=False, default=None))
    if isinstance(found, Literal) and isinstance(found.value, bool | int | float):
        return found.value
    problems.append(words.unfit(state.initial.span, state.name, found if isinstance(found, str) else "it is no number"))
    return 0
