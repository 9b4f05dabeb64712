"""Statements that are alike: the same but for numbers, lanes, sites and names.

A message of a thousand strings becomes eleven statements a thousand times. A `Series` is such a repetition: stretches of one block that
follow one another, or cases of one switch. It has the statements of one stretch, and a table of the numbers in which the stretches
differ, one row a stretch; `stretches` looks for them, and `series` prints each once. What a stretch takes over from the one before it is
*carried*. Large blocks that are alike may stand anywhere: each place calls a function, with its row of the table (`twins`, `shared`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Local, Scalar, Stmt, Switch
from rosetta_jit.kernel.walk import flat
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.backends.llvm.alike_names import Carried

MANY = 512
"""Statements of a body from which on series are looked for: below, LLVM takes no time worth mentioning."""

SEVERAL = 256
"""Statements of a body from which on large blocks are looked for that are alike."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a stretch: ``further`` than the one in a column of the table."""

    column: int
    further: int


@dataclass(frozen=True, slots=True)
class Series:
    """A repetition: the last stretch, in which locals stand for the ``constants`` that differ, and how its other numbers are found."""

    body: Block
    rows: tuple[tuple[int, ...], ...]
    constants: Mapping[str, tuple[Scalar, Number]]
    lanes: Mapping[int, Number]
    offsets: Mapping[tuple[int, int], Number]
    sites: Mapping[int, Number]
    carried: tuple[Carried, ...]


@dataclass(frozen=True, slots=True)
class Cases:
    """Cases of a switch that are a series: their numbers, in the order of the table's rows."""

    numbers: tuple[int, ...]
    series: Series


@dataclass(frozen=True, slots=True)
class Shared:
    """A block that several places share, as a series: of what is bound around it the names that it ``reads`` and ``assigns``."""

    series: Series
    reads: tuple[Local, ...]
    assigns: tuple[str, ...]
    hidden: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Place:
    """One of the places that share a block: its row of the table, and what the names around the block are here."""

    shared: Shared
    row: int
    names: Mapping[str, str]


Part = Stmt | Series | Place
"""What blocks are printed as."""


@dataclass(frozen=True, slots=True)
class Found:
    """The series of a body: for blocks, by their identity, what they are made of; for switches, by theirs, the cases that are alike."""

    blocks: Mapping[int, tuple[Part, ...]]
    switches: Mapping[int, tuple[Cases, ...]]

    def __bool__(self) -> bool:
        return bool(self.blocks or self.switches)

    @property
    def has_places(self) -> bool:
        """Whether places share a block."""
        return any(isinstance(parts[0], Place) for parts in self.blocks.values())

    def parts(self, block: Block) -> Sequence[Part]:
        """What a block is made of."""
        return self.blocks.get(id(block), block)

    def cases(self, switch: Switch) -> tuple[Cases, ...]:
        """The cases of a switch that are alike."""
        return self.switches.get(id(switch), ())


NOTHING = Found({}, {})


def may_share(kernel: Kernel, body: Block) -> bool:
    """Whether it pays to look for large blocks that places in a body share."""
    return not kernel.kept and len(flat(body)) >= SEVERAL


def may_have_series(kernel: Kernel, body: Block) -> bool:
    """Whether it pays to look for series in a body of a kernel."""
    return not kernel.kept and len(flat(body)) >= MANY
