"""`ignore .a[].b`, which is a loop over the elements of what is read, and is `default .a[].b` of what is set."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.model.expr import Each, Index, Len, Literal, Name, Path
from rosetta_jit.model.mapping import For, Ignore, Rule
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def ignoring(path: Path, span: Span | None, depth: int = 0) -> Rule:
    """The rule for a field that is ignored; of each element, in a loop over all of them."""
    number = next((number for number, step in enumerate(path.steps) if isinstance(step, Each)), None)
    if number is None:
        return Ignore(path, span)
    variable = f"each{depth or ''}"
    element = replace(path, steps=(*path.steps[:number], Index(Name(variable), path.steps[number].span), *path.steps[number + 1 :]))
    array = replace(path, steps=path.steps[:number])
    return For(variable, Literal(0, span), Len(array, span), (ignoring(element, span, depth + 1),), span)


def ignored_elements(rule: Rule) -> Path | None:
    """The field that a loop ignores of each element, with `[]`; None of all other rules."""
    match rule:
        case Ignore(place):
            return place
        case For(variable, _, Len(array), (inner,)) if (place := ignored_elements(inner)) is not None:
            number = len(array.steps)
            step = place.steps[number] if number < len(place.steps) else None
            if isinstance(step, Index) and step.index == Name(variable):
                return replace(place, steps=(*place.steps[:number], Each(step.span), *place.steps[number + 1 :]))
            return None
        case _:
            return None
