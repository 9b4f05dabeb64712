"""How the lanes of a holder are reached from Lisp: each is a vector of octets, which the codec keeps from one message to the next.

points              the vector, in a variable       (codec.points codec)        the same where it is kept
points-used         how many rows are in use        +points.x+                  the byte of a row where a field lies

A lane whose element is None has no fields that have names.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.holder.rows import path_to
from rosetta_jit.generate.lisp.words import Names, codec_slots, constants, hyphenated
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder import lanes as c

OWN_WORDS = frozenset({"codec", "data", "end", "attempt"})
"""What the functions call their parameters."""


@dataclass(slots=True)
class Lanes:
    """Those of a unit, hidden ones last; ``offsets`` are the constants that the printed functions need, ``others`` those of enums."""

    names: tuple[str, ...]
    all: tuple[c.Lane, ...]
    own: int
    others: frozenset[str] = frozenset()
    offsets: dict[str, int] = field(default_factory=dict[str, int])

    def rows(self, lane: int) -> str:
        """The variable with the vector."""
        return self.names[lane]

    def used(self, lane: int) -> str:
        """The variable that counts the rows in use."""
        return f"{self.names[lane]}-used"

    def place(self, lane: int) -> str:
        """Where the codec keeps the vector."""
        return f"(codec.{self.names[lane]} codec)"

    def place_of_used(self, lane: int) -> str:
        """Where the codec keeps the count."""
        return f"(codec.{self.names[lane]}-used codec)"

    def stride(self, lane: int) -> int:
        """Bytes of a row."""
        return self.all[lane].stride

    def offset(self, lane: int, offset: int, scalar: str) -> str:
        """The byte of a row where a scalar lies: by the name of its field, if the schema has one there."""
        element = self.all[lane].element
        path = None if element is None else path_to(element, offset, scalar)
        if not path:
            return str(offset)
        parts = [hyphenated(each) if each[:1].isalpha() else each for each in re.split(r"[.\[\]]+", path) if each]
        name = f"+{'.'.join([*([self.names[lane]] if lane else []), *parts])}+"
        while name in self.others or self.offsets.setdefault(name, offset) != offset:
            name = f"{name[:-1]}.+"
        return name

    def words(self) -> frozenset[str]:
        """All that no local of a kernel may be called."""
        return constants() | OWN_WORDS | {word for name in self.names for word in (name, f"{name}-used")}


def lanes_of(all_: Sequence[c.Lane], own: int, constants_of_enums: Iterable[str] = ()) -> Lanes:
    """Lanes as C has them, with names of Lisp."""
    names = Names(constants() | OWN_WORDS | codec_slots())
    return Lanes(tuple(names.symbol(lane.identifier, "{}", "{}-used") for lane in all_), tuple(all_), own, frozenset(constants_of_enums))
