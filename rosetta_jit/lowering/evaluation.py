"""How expressions are evaluated, as an interface: what the parts of an expression ask of the whole, and of the side that is read.

`lowering.rules.values` implements it, and calls the parts: numbers, texts, images, searches.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from typing import Protocol

from rosetta_jit.kernel.nodes import Address, Expr, Local, Scalar, Stmt
from rosetta_jit.language import typed
from rosetta_jit.language.installed import functions
from rosetta_jit.lowering.writer import Where, Writer
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Awaited:
    """A value that the first round of a loop to ask for it computes: whether one has, what it found, and the block around the loop."""

    is_known: Local
    found: Local
    block: list[Stmt]


class Source(Protocol):
    """The side that rules read."""

    def forgetting(self) -> AbstractContextManager[None]:
        """Around statements that may not run: what is looked up within them is not known behind them."""
        ...

    def number(self, place: typed.Place, values: Evaluation) -> Expr:
        """The number at a place."""
        ...

    def count(self, place: typed.Place, values: Evaluation) -> Expr:
        """The number of elements at a place, int64."""
        ...

    def address(self, place: typed.Place, values: Evaluation) -> Address:
        """The address of the bytes of a string or bytes field."""
        ...

    def present(self, place: typed.Place, values: Evaluation) -> Expr:
        """Whether what can be absent is there."""
        ...


class Evaluation(Protocol):
    """Evaluates expressions of one rule: ``line`` is that of the mapping, ``where`` the field of the message, for errors."""

    @property
    def writer(self) -> Writer:
        """The writer that takes the statements."""
        ...

    @property
    def source(self) -> Source:
        """The side that is read."""
        ...

    @property
    def awaited(self) -> dict[typed.Expr, Awaited]:
        """The values that loops around compute when they are first asked for."""
        ...

    @property
    def variables(self) -> Mapping[str, Expr]:
        """The loop variables around."""
        ...

    @property
    def where(self) -> Where: ...

    @property
    def line(self) -> str: ...

    def of(self, value: typed.Expr) -> Expr:
        """The kernel expression of a number."""
        ...

    def in_range(self, value: Local, target: Scalar) -> None:
        """Refuse the message where a number is none of a type."""
        ...

    def reject(self, reason: str, pieces: tuple[typed.Expr, ...] = (), *, when: Expr | None = None) -> None:
        """Refuse the message, always or where something holds."""
        ...

    def switch(self, listed: typed.Listed, use: Callable[[typed.Expr], None]) -> None:
        """Do something with the item of a list that an index chooses."""
        ...

    def together(self, value: typed.Expr, compute: Callable[[], Mapping[str, Expr]]) -> Mapping[str, Expr]:
        """Numbers that are computed together, by name; what was computed for an equal value is found again where it is known."""
        ...

    def with_locals(self, numbers: Mapping[str, Expr]) -> Evaluation:
        """The same where these names alone have values, and nothing is decided yet."""
        ...

    def look_ahead(self, exprs: tuple[typed.Expr, ...]) -> None:
        """Before a loop that computes some expressions: what is the same in each round, and takes a loop of its own."""
        ...

    def with_local(self, name: str, number: Expr, *, afresh: bool = False) -> Evaluation:
        """The same where a loop variable has a value; ``afresh`` where what was decided may be something else for it."""
        ...


def lowered(call: typed.Call, values: Evaluation) -> object:
    """The kernel expression of a number; of a text, where it lies; of the parts of a text, that text and what separates them."""
    return functions()[call.function].lower(call, values)
