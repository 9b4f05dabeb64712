"""Between the rows of kernels and objects: the functions of one direction, one for each struct of the layout.

`rosetta_jit.generate.lisp.taking` fills objects, `putting` beside it rows. In a row, ``row`` is the byte where the row of its lane begins.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.lisp.classes import Classes
from rosetta_jit.generate.lisp.expressions import access
from rosetta_jit.generate.lisp.lines import Lines
from rosetta_jit.generate.shares import WHOLE, Ways
from rosetta_jit.model.layout import Row, Slot
from rosetta_jit.model.types import Ref, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.lisp.lanes import Lanes


@dataclass(slots=True)
class Walk:
    """Functions that are printed for one direction: ``verb`` begins their names, ``done`` are those by lane, offset and struct."""

    classes: Classes
    lanes: Lanes
    verb: str
    done: dict[tuple[int, int, str, Ways], str] = field(default_factory=dict[tuple[int, int, str, Ways], str])
    pending: list[tuple[Struct, Row, int, str, Ways]] = field(default_factory=list[tuple[Struct, Row, int, str, Ways]])
    lines: Lines = field(default_factory=Lines)
    depth: int = 0

    def element(self, lane: int) -> Slot:
        """The slot of a lane's rows."""
        return self.classes.unit.layout.lanes[lane].element

    def resolved(self, type_: Type) -> Type:
        return self.classes.schema.resolve(type_)

    def function(self, struct: Struct, slot: Row, lane: int, path: str, ways: Ways = WHOLE) -> str:
        """The function for the structs at a slot of a lane's rows, or for some of their fields."""
        key = lane, slot.offset, struct.name, ways
        if key not in self.done:
            named = "\0".join(map(str, (self.verb, *key[:3], *map(".".join, sorted(ways)))))
            self.done[key] = self.classes.names.symbol(named, wanted=f"{self.verb}-{path}")
            self.pending.append((struct, slot, lane, self.done[key], ways))
        return self.done[key]

    def at(self, lane: int, offset: int, scalar: str, row: str) -> str:
        """The byte of a scalar."""
        name = self.lanes.offset(lane, offset, scalar)
        return name if row == "0" else row if name == "0" else f"(+ {row} {name})"

    def scalar(self, lane: int, offset: int, scalar: str, row: str) -> str:
        """The place of a scalar of a row."""
        return f"({access(scalar)} {self.lanes.place(lane)} {self.at(lane, offset, scalar, row)})"  # pyright: ignore[reportArgumentType]

    def whole(self, path: str = "message", ways: Ways = WHOLE) -> str:
        """The function for the message."""
        unit = self.classes.unit
        root = self.resolved(Ref(unit.type))
        assert isinstance(root, Struct)
        assert isinstance(unit.layout.root, Row)
        return self.function(root, unit.layout.root, 0, path, ways)

    def printed(self) -> str:
        """The functions, those of messages last."""
        texts: list[str] = []
        while self.pending:
            self.lines = Lines()
            self.one(*self.pending.pop())
            texts.append(self.lines.text())
        return "\n".join(reversed(texts))

    def one(self, struct: Struct, slot: Row, lane: int, name: str, ways: Ways) -> None:
        raise NotImplementedError

    def local(self, what: str) -> str:
        return what if self.depth < 2 else f"{what}-{self.depth}"
