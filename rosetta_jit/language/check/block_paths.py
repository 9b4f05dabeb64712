"""A block with `when`s as the blocks without, one for each way through it: each way must set everything, once.

A way that ends in a rejection owes nothing. In a loop each round may go another way; there all ways must set the same places, so that
what one way sets over all rounds is what any mixture sets. What an element of an array may lack, a round may leave out.
"""

from __future__ import annotations

from itertools import product

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_CHECKED_WAYS
from rosetta_jit.language.typed import Assign, Default, FieldStep, For, Ignore, Reject, Rule, SetLength, SetState, Step, When
from rosetta_jit.model.types import Field, Optional, Struct, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

Ways = list[tuple["Rule", ...]]


class TooManyWaysError(Exception):
    """More ways than `MAX_CHECKED_WAYS`; never leaves the checker."""

    def __init__(self, span: Span | None) -> None:
        super().__init__()
        self.span = span


def ways(rules: tuple[Rule, ...], problems: list[Diagnostic]) -> Ways:
    """Every way through a block that does not end in a rejection; raises TooManyWaysError."""
    found: Ways = [()]
    for rule in rules:
        parts = _ways_of(rule, problems)
        if len(found) * len(parts) > MAX_CHECKED_WAYS:
            raise TooManyWaysError(rule.span)
        found = [(*before, *part) for before, part in product(found, parts)]
    return found


def _ways_of(rule: Rule, problems: list[Diagnostic]) -> Ways:
    match rule:
        case Assign() | SetLength() | Default() | Ignore() | SetState():
            return [(rule,)]
        case Reject():
            return []
        case When(_, then, otherwise):
            return ways(then, problems) + ways(otherwise, problems)
        case For(body=body):
            inside = ways(body, problems)
            if _is_uneven([_set_by(way) for way in inside]):
                problems.append(words.uneven_rounds(rule.span))
            return [(replace(rule, body=way),) for way in inside]


def _is_uneven(ways_set: list[list[tuple[bool, tuple[Step, ...]]]]) -> bool:
    """Whether rounds that go different ways do not all set the same places, or set what may be absent in other elements."""
    owed: set[frozenset[tuple[bool, tuple[Step, ...]]]] = set()
    free: dict[tuple[str, ...], tuple[Step, ...]] = {}
    for places in ways_set:
        cuts = [(is_length, steps, _may_lack(steps)) for is_length, steps in places]
        owed.add(frozenset((is_length, steps) for is_length, steps, cut in cuts if not cut))
        for _, steps, cut in cuts:
            if (
                cut
                and free.setdefault(tuple(each.field.name for each in steps[:cut] if isinstance(each, FieldStep)), steps[:cut])
                != steps[:cut]
            ):
                return True
    return len(owed) > 1


def _may_lack(steps: tuple[Step, ...]) -> int:
    """How many steps lead to what an element of an array may lack; 0 if nothing on the way may be absent."""
    inside = False
    for number, step in enumerate(steps, 1):
        if not isinstance(step, FieldStep):
            inside = True
        elif inside and isinstance(step.field.type, Optional | Union) and not step.field.required:
            return number
    return 0


def _union_of(struct: Struct) -> Field | None:
    """The union that a struct is, with what tells its case beside it: to leave the struct out is to leave out the cases."""
    for field in struct.fields:
        if isinstance(field.type, Union) and {each.name for each in struct.fields} <= {field.name, field.type.discriminator}:
            return field
    return None


def _set_by(way: tuple[Rule, ...]) -> list[tuple[bool, tuple[Step, ...]]]:
    """The places that rules without `when` set."""
    found: list[tuple[bool, tuple[Step, ...]]] = []
    for rule in way:
        match rule:
            case Default(place) if isinstance(place.type, Struct) and (union := _union_of(place.type)) is not None:
                found.append((False, (*place.steps, FieldStep(union))))
            case Assign(place) | SetLength(place) | Default(place):
                found.append((isinstance(rule, SetLength), place.steps))
            case For(body=body):
                found += _set_by(body)
            case _:
                pass
    return found
