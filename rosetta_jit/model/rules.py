"""The rules that the mapping as it is written and the typed one have in common, generic over what they are made of.

    Rule = Assign(Place, Expr, by, where) | SetLength(Place, Expr) | For(variable, start, stop, Rule*, Kept) | When(condition, Rule*, Rule*)
         | Reject(text) | Ignore(Place) | Default(Place) | SetState(variable, Expr)

As it is written (`model.mapping`) a place is a path, a state variable its name, and an expression has no type; typed (`language.typed`),
all have theirs. Filters (an Assign with ``where``) are loops there, of which some rounds are ``kept``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.source import Span

Place_co = TypeVar("Place_co", covariant=True)
Expr_co = TypeVar("Expr_co", covariant=True)
Way_co = TypeVar("Way_co", covariant=True)
Rule_co = TypeVar("Rule_co", covariant=True)
Variable_co = TypeVar("Variable_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Assign(Generic[Place_co, Expr_co, Way_co]):
    """``.place = value where condition``: of the elements of arrays, those for which the condition holds.

    ``by`` is how the value becomes one of the place, where that is more than an implicit conversion.
    """

    place: Place_co
    value: Expr_co
    span: Span | None = field(default=None, compare=False, repr=False)
    by: Way_co | None = None
    where: Expr_co | None = None


@dataclass(frozen=True, slots=True)
class SetLength(Generic[Place_co, Expr_co]):
    """``len(.place) = value``"""

    place: Place_co
    value: Expr_co
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Kept(Generic[Expr_co]):
    """The rounds of a loop for which ``condition`` holds. ``variable`` counts them from 0; typed, ``count`` is how many there are."""

    condition: Expr_co
    variable: str
    count: Expr_co | None = None


@dataclass(frozen=True, slots=True)
class For(Generic[Rule_co, Expr_co]):
    """``for variable from start to stop ... end``; ``stop`` is exclusive, and below ``start`` it is an error of kind ``count``.

    Where some rounds are ``kept``, the body runs in these alone.
    """

    variable: str
    start: Expr_co
    stop: Expr_co
    body: tuple[Rule_co, ...]
    span: Span | None = field(default=None, compare=False, repr=False)
    kept: Kept[Expr_co] | None = None


@dataclass(frozen=True, slots=True)
class When(Generic[Rule_co, Expr_co]):
    """``when condition ... else ... end``"""

    condition: Expr_co
    then: tuple[Rule_co, ...]
    otherwise: tuple[Rule_co, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Reject(Generic[Expr_co]):
    """``reject "text"``: the message is refused, whatever else it has. ``pieces`` are the texts and values of a text with braces.

    One that is ``written`` stands in the text; all others check what relations say.
    """

    text: str
    span: Span | None = field(default=None, compare=False, repr=False)
    pieces: tuple[Expr_co, ...] = ()
    written: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Ignore(Generic[Place_co]):
    """``ignore .place``: no rule reads it, and that is meant."""

    place: Place_co
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Default(Generic[Place_co]):
    """``default .place``: no rule sets it, and that is meant: numbers are 0, texts and arrays empty, what can be absent is."""

    place: Place_co
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SetState(Generic[Variable_co, Expr_co]):
    """``state name = value``: what a state variable is from the next message on."""

    variable: Variable_co
    value: Expr_co
    span: Span | None = field(default=None, compare=False, repr=False)
