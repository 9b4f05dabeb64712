"""Components of functions of several values as kernel expressions: what their definitions share is computed once."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Expr
from rosetta_jit.language.groups import group_functions
from rosetta_jit.language.resolve.definitions import arguments_in, definitions_of
from rosetta_jit.language.typed import Call
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.startup.dataclass import replace


def lower_component(call: Call, values: Evaluation) -> Expr:
    """One component of a call; the others of the same call find what was computed for it."""
    name, _, component = call.function.partition(".")
    any_component = replace(call, function=group_functions()[name].components[0].name)
    return values.together(any_component, lambda: _computed(name, call, values))[component]


def _computed(name: str, call: Call, values: Evaluation) -> dict[str, Expr]:
    """Each component of a call by its name."""
    function = group_functions()[name]
    arguments = [
        values.writer.let(each.rpartition(".")[2], values.of(argument))
        for each, argument in zip(arguments_in(function), call.arguments, strict=True)
    ]
    inner = values.with_locals(dict(zip(arguments_in(function), arguments, strict=True)))
    found: dict[str, Expr] = {}
    for defined, expression in definitions_of(name):
        found[defined] = values.writer.let(defined.rpartition(".")[2], inner.of(expression))
        inner = inner.with_local(defined, found[defined])
    return {each.names[0]: found[each.names[0]] for each in function.gives.components}
