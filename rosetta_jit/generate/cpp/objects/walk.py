"""A walk between rows and classes (`between`): how it reaches fields by the sections of manners, and which lanes need no copies.

A lane is *direct* where a field of the message itself is a container of numbers or characters: kernels then work on the elements of that
container, and nothing is copied.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from string import Template
from typing import TYPE_CHECKING, Literal

from rosetta_jit.backends.printing import Writer
from rosetta_jit.catalogue import generate as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.cpp.objects.classes import names_of
from rosetta_jit.generate.cpp.objects.names import member_names
from rosetta_jit.generate.cpp.objects.spots import ListWithin, Spot
from rosetta_jit.generate.shares import WHOLE, Ways
from rosetta_jit.model.types import Struct, Union
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes
    from rosetta_jit.generate.cpp.objects.manners import Manners
    from rosetta_jit.generate.unit import Unit

Direction = Literal["decode", "encode"]
IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(slots=True)
class Walk:
    """One of the functions being printed; ``in_rows`` is how many lists there are around a value, ``share`` what is set of it.

    ``within`` are the lists within lists that an encoder reads where they are, by their lanes, ``visited`` the lanes of messages that it
    reads so. ``takes``: it copies rows, whose lanes have memory of their own; ``shows`` are lanes that may show the elements of a container
    instead. ``taken`` are the lists that a decoder has put into the object already, where their elements lie in memory as rows do,
    ``straight`` the numbers, as rows would have them, ``opened`` lists and texts.
    """

    unit: Unit
    lanes: Lanes
    manners: Manners
    direction: Direction
    direct: frozenset[int] = frozenset()
    addressed: frozenset[int] = frozenset()
    within: Mapping[int, ListWithin] = field(default_factory=dict[int, ListWithin])
    visited: frozenset[int] = frozenset()
    taken: frozenset[int] = frozenset()
    straight: frozenset[str] = frozenset()
    opened: frozenset[int] = frozenset()
    takes: bool = False
    shows: set[int] = field(default_factory=set[int])
    writer: Writer = field(default_factory=Writer)
    depth: int = 0
    in_rows: int = 0
    share: Ways = WHOLE

    def text(self, kind: str, spot: Spot, **more: str) -> str:
        """A section, filled in."""
        return Template(self.demand(kind, spot)).substitute(at=spot.at, object=spot.owner, field=spot.field, **more)

    def demand(self, kind: str, spot: Spot) -> str:
        """A section; refuses classes that have no such fields."""
        sections = self.manners.sections()
        section = sections.get(f"{kind} {self.direction}", sections.get(kind))
        if section is None:
            raise SchemaError((words.no_manner(self.manners.name, kind, spot.field or spot.at),))
        return section

    def lines(self, kind: str, spot: Spot, **more: str) -> None:
        for line in self.text(kind, spot, **more).splitlines():
            self.writer.line(line)

    def member_of(self, owner: str, name: str) -> Spot:
        """A field of a class."""
        return Spot(self.text("member", Spot("", owner, name)), owner, name)

    def names(self, struct: Struct) -> tuple[str, ...]:
        """The names of a struct's fields as the class has them."""
        if self.manners.type is None:
            return member_names(struct, self.unit.name, names_of(self.unit)[struct.name])
        unions = {each.name for each in struct.fields if isinstance(self.unit.schema.resolve(each.type), Union)}
        return tuple(self.named(each.name, struct.name, is_union=each.name in unions) for each in struct.fields)

    def named(self, name: str, struct: str = "", *, is_union: bool = False) -> str:
        """The name of a field of a framework's class."""
        known = dict(self.manners.renamed).get((struct, name), name)
        plain = known.lower() if self.manners.lower else known
        if not IDENTIFIER.fullmatch(plain):
            raise SchemaError((words.no_manner(self.manners.name, "member", plain),))
        return f"{plain}_" if plain in self.manners.reserved and not is_union else plain

    def local(self, what: str) -> str:
        return f"{what}_{self.depth}"

    def value_of(self, kind: str, spot: Spot) -> Spot:
        """What an optional field or a pointer has."""
        return Spot(self.text(f"{kind} value", spot), spot.owner, spot.field)

    def case(self, spot: Spot, more: dict[str, str]) -> Spot:
        """The value of a union that has this case."""
        if f"case {self.direction}" in self.manners.sections():
            return Spot(self.text("case", spot, **more))
        return self.member_of(spot.owner, more["case"])
