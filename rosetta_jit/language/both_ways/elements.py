"""`ignore .a[].b` in both directions: a loop over the elements when unpacking, and `default .a[].b` when packing."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rosetta_jit.model.expr import Each, Index, Len, Name
from rosetta_jit.model.mapping import For, Ignore

if TYPE_CHECKING:
    from rosetta_jit.model.expr import Path
    from rosetta_jit.model.mapping import Rule


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
