"""What a mapping in both directions guarantees: which values come back as they were, which are rounded, and what is lost.

Whatever cannot be shown counts as lost. The laws are about messages and holders that the first direction does not refuse; what the second
one may refuse is lost.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from rosetta_jit.language.algebra.equality import given_back, has_local, has_state, is_of_digits, is_part, reads_other, same_number
from rosetta_jit.language.algebra.normal_form import normal
from rosetta_jit.language.laws.chain import UNSHOWN, Lost, Outcome, Rounding, come_back
from rosetta_jit.language.laws.execution_paths import ExecutionPath, UnfollowedError, execution_paths
from rosetta_jit.language.laws.roundtrip import Result, Trip
from rosetta_jit.language.laws.sums import comes_back_rounded
from rosetta_jit.language.laws.writes import FILTERED
from rosetta_jit.language.limits import MAX_WORK
from rosetta_jit.language.places import field_names, shown_names, shown_place
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Access, Const, Expr, For, Given, Has, IndexStep, LenOf, Listed, Local, Place, Rule, Search
from rosetta_jit.language.untouched import untouched
from rosetta_jit.language.walk import parts
from rosetta_jit.model.types import Array
from rosetta_jit.model.walk import every_rule
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass

ORDINARY = (1e-30, 1e30)
"""Magnitudes beyond which a bound is not shown."""


BY_BLOCK = Lost("it cannot be shown by which block of a `when` it comes back")
IN_SUMS = "it is rounded, by as much as the other fields of its sums are large"


@dataclass(frozen=True, slots=True)
class Loss:
    """A field, and why it does not come back; ``""`` stands for the message."""

    place: str
    why: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Law:
    """What comes back through both directions.

    ``rounded`` says of each field that is not exactly the same how far off it may be: see `rosetta_jit.language.laws.chain.Rounding`.
    """

    rounded: tuple[tuple[str, Rounding], ...]
    losses: tuple[Loss, ...]

    @property
    def kind(self) -> Literal["exact", "rounded", "lossy"]:
        return "lossy" if self.losses else "rounded" if self.rounded else "exact"

    def __str__(self) -> str:
        if self.losses:
            return "\n  ".join(["lossy", *(f"{loss.place or 'the message'}: {loss.why}" for loss in self.losses)])
        if not self.rounded:
            return "exact inverse"
        return "\n  ".join(["inverse up to rounding", *(f"{place}: {shown(rounding)}" for place, rounding in self.rounded)])


@dataclass(frozen=True, slots=True)
class Laws:
    """``messages`` is about encode(decode(message)), ``holders`` about decode(encode(holder))."""

    messages: Law
    holders: Law

    def __str__(self) -> str:
        return f"messages: {self.messages}\nholders: {self.holders}"


def laws_of(unpack: tuple[Rule, ...], pack: tuple[Rule, ...], holder: Message, wire: Message) -> Laws:
    """The laws of the rules of both directions."""
    there, back = normal(unpack), normal(pack)
    return Laws(_law(there, back, wire), _law(back, there, holder))


def shown(rounding: Rounding) -> str:
    """A rounding in words."""
    text = f"{rounding.ulp} ulp of float{rounding.bits}"
    floor = f", of {rounding.floor:g} for smaller values" if rounding.floor > ORDINARY[0] else ""
    limit = f", up to {rounding.limit:.3g}" if rounding.limit < ORDINARY[1] else ""
    return text + floor + limit


def _law(first: tuple[Rule, ...], second: tuple[Rule, ...], message: Message) -> Law:
    try:
        found = execution_paths(first)
    except UnfollowedError:
        return Law((), (Loss("", "there are too many ways through the rules to follow them"),))
    if len(found) * _size(second) > MAX_WORK:
        return Law((), (Loss("", "there are too many rules to follow them"),))
    rounded: dict[str, Rounding] = {}
    losses: dict[tuple[str, str], Loss] = {}
    for path in found:
        for place, outcome, span in _outcomes(path, second, message):
            match outcome:
                case Rounding():
                    rounded[place] = _worse(rounded.get(place, outcome), outcome)
                case Lost(why):
                    losses.setdefault((place, why), Loss(place, why, span))
                case None:
                    pass
    return Law(tuple(rounded.items()), tuple(losses.values()))


def _size(rules: tuple[Rule, ...]) -> int:
    return sum(not isinstance(rule, For) for rule in every_rule(rules))


def _worse(left: Rounding, right: Rounding) -> Rounding:
    bits = 32 if 32 in (left.bits, right.bits) else 64
    return Rounding(max(left.ulp, right.ulp), bits, max(left.floor, right.floor), min(left.limit, right.limit))


def _outcomes(path: ExecutionPath, second: tuple[Rule, ...], message: Message) -> Iterator[tuple[str, Outcome, Span | None]]:
    """What becomes of each field on one path; whether the message can go back at all."""
    trip = Trip(path)
    results = list(trip.run(second))
    if trip.refused:
        yield "", Lost("some messages are rejected on the way back"), None
        return
    for refusal in trip.refusals:
        yield "", Lost(f'some are refused on the way back: "{refusal.text}"'), refusal.span
    for result in results:
        yield _shown(result), _outcome(result, trip), result.span
    touched = {field_names(result.place) for result in results if not result.is_length}
    lengths = {field_names(result.place) for result in results if result.is_length}
    for names in untouched(touched, message, message.root, (), lengths):
        if trip.is_absent(names, message):
            continue
        is_in_some = trip.is_absent(names, message, in_rounds=True)
        yield shown_names(names, message), BY_BLOCK if is_in_some else Lost("no rule sets it on the way back"), None


def _shown(result: Result) -> str:
    text = shown_place(result.place.steps)
    return f"len({text})" if result.is_length else text


def _outcome(result: Result, trip: Trip) -> Outcome:
    """What becomes of one field, which is lost where its rule may refuse it."""
    found = _value_outcome(result, trip)
    is_lost = isinstance(found, Lost) or not result.may_be_refused
    return found if is_lost else Lost("it is refused where a conversion does not take it")


def _becomes(value: Expr, place: Place) -> str | None:
    """What a place becomes instead of what it was, where that can be said."""
    match value:
        case _ if any(isinstance(part, Search) for part in parts(value)):
            return "it becomes that of the element which a key tells"
        case Listed() | Given(_, (_,)) if not reads_other(value, place.side):
            return "it becomes an item of a list"
        case Access(other) if other.side == place.side and not has_local(value):
            return f"it becomes that of `{shown_place(other.steps)}`"
        case LenOf(other) if other.side == place.side and not has_local(value):
            return f"it becomes `len({shown_place(other.steps)})`"
        case _ if reads_other(value, place.side):
            return "it comes back as something that does not follow from it"
        case _:
            return None


def _is_empty(place: Place, trip: Trip) -> bool:
    """Whether the first direction refuses what has anything at a place."""
    if isinstance(place.type, Array):
        return any(isinstance(each, Const) and each.value == 0 for each in trip.known.equal_to(LenOf(place)))
    return trip.known.truth(Has(place)) is False


def _value_outcome(result: Result, trip: Trip) -> Outcome:
    trip.known.ranges = result.ranges
    place, value = result.place, result.value
    goal = LenOf(place) if result.is_length else Access(place, place.type)
    value = None if value is None else given_back(trip.towards(value, goal))
    match value:
        case None:
            return None if _is_empty(place, trip) else Lost("it is left out: 0, empty or absent")
        case _ if has_state(value):
            return Lost("it depends on state, which other messages have left")
        case _ if is_part(FILTERED, value):
            return Lost("a filter drops some elements, and which it keeps is not followed")
        case Local("?"):
            return BY_BLOCK
        case Access(other) | LenOf(other) if other.side != place.side:
            is_element = any(isinstance(step, IndexStep) for step in other.steps)
            return None if value in trip.known.equal_to(goal) else UNSHOWN if is_element else Lost("nothing of it is kept")
        case _ if trip.is_same(value, goal) or value == goal or any(value == other for other in trip.known.equal_to(goal)):
            return None
        case Const(bool(holds)) if trip.known.truth(goal) is holds:
            return None
        case Const(constant) if any(isinstance(other, Const) and other.value == constant for other in trip.known.equal_to(goal)):
            return None
        case Const(constant):
            return Lost(f"it becomes {constant!r}")
        case _ if (why := _becomes(value, place)) is not None:
            return Lost(why)
        case _:
            return None if any(same_number(value, each) for each in (goal, *trip.known.equal_to(goal))) else _come_back(value, goal)


def _come_back(value: Expr, goal: Expr) -> Outcome:
    """What is left of a field where a chain of steps brings it back."""
    found = come_back(value, goal)
    if found is not None and is_of_digits(value, goal):
        return Lost("what no relation takes of it comes back as 0")
    return Lost(IN_SUMS) if found == UNSHOWN and comes_back_rounded(value, goal) else found
