"""What a place of a kernel can see, in the proof: its locals, the lanes, and the facts about them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.kernel.arithmetic import limits
from rosetta_jit.kernel.limits import MAX_POSITION, MAX_ROWS
from rosetta_jit.kernel.nodes import Scalar
from rosetta_jit.kernel.proof.formula import All, Any
from rosetta_jit.kernel.proof.linear import Linear, Terms, minus, plus, shifted, times
from rosetta_jit.kernel.proof.prove import Facts
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof.record import Premise, Record

Value = Linear | bool | None | All | Any
"""An integer, or a formula for a bool; None is a value of which nothing is known (every float)."""

Typed = tuple["Scalar", Value]


@dataclass(slots=True)
class Scope:
    """What a place of a kernel can see: its locals, the lanes, and the facts about them.

    ``begin`` and ``end`` are the locals of these names, which never change: no others are asked for so often.
    Locals are gained along a path and given up at its end, as facts are, so that a path costs what it changes and not what there is.
    So are used lengths, of which each change makes new ones. ``record`` writes down what the kernel owes, where somebody wants to read it.
    """

    strides: tuple[int, ...]
    begin: Linear
    end: Linear
    facts: Facts = field(default_factory=Facts)
    locals: dict[str, Typed] = field(default_factory=dict[str, "Typed"])
    used: tuple[Linear, ...] = ()
    capacity: list[Linear] = field(default_factory=list[Linear])
    record: Record | None = None
    _trail: list[tuple[str, Typed | None]] = field(default_factory=list[tuple[str, "Typed | None"]])

    def bind(self, name: str, typed: Typed) -> None:
        """Give a local a value."""
        self._trail.append((name, self.locals.get(name)))
        self.locals[name] = typed

    def use(self, lane: int, used: Linear) -> None:
        """Give a lane another used length."""
        self.used = (*self.used[:lane], used, *self.used[lane + 1 :])

    def mark(self) -> int:
        """A point to roll back to."""
        return len(self._trail)

    def changed(self, mark: int) -> dict[str, Typed]:
        """The locals that were there at a mark and have other values now, with their values then."""
        first: dict[str, Typed | None] = {}
        for name, old in self._trail[mark:]:
            first.setdefault(name, old)
        return {name: old for name, old in first.items() if old is not None and self.locals[name] is not old}

    def rollback(self, mark: int) -> None:
        """Give locals the values that they had at a mark."""
        while len(self._trail) > mark:
            name, old = self._trail.pop()
            if old is None:
                del self.locals[name]
            else:
                self.locals[name] = old


@dataclass(frozen=True, slots=True)
class Arrival:
    """What one path brings to a meeting point; ``premises`` are what it took as known, where that is written down."""

    changed: dict[str, Typed]
    used: tuple[Linear, ...]
    gained: dict[Terms, int]
    distances: dict[str, list[tuple[int, int]]]
    premises: Premise | None = None


def entry(strides: tuple[int, ...], record: Record | None = None) -> Scope:
    """The scope at the start of a body. ``end`` is kept as ``begin + length``, so that distances need no fact."""
    facts = Facts() if record is None else record.facts()
    begin, length = facts.fresh(0, MAX_POSITION), facts.fresh(0, MAX_POSITION)
    end = plus(begin, length)
    scope = Scope(strides, begin, end, facts, record=record)
    facts.assume(shifted(times(end, -1), MAX_POSITION))
    scope.locals = {"begin": ("i64", begin), "end": ("i64", end), "row": ("i64", facts.fresh(0, limits("i64")[1]))}
    every: list[Linear] = []
    for _ in strides:
        capacity, used = facts.fresh(0, MAX_ROWS), facts.fresh(0, MAX_ROWS)
        facts.assume(minus(capacity, used))
        scope.capacity.append(capacity)
        every.append(used)
    scope.used = tuple(every)
    return scope
