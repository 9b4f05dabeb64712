"""What the printers of a function of C share while it is printed, and find that it needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.kernel.nodes import Expr, Scalar
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes


@dataclass(slots=True)
class Scope:
    """What the printers of a function share: names, how lanes are reached, and what they find that the function needs.

    ``parameters`` are those that it must be given, ``touched`` the lanes whose rows it reads or writes, ``counted`` those whose rows in use
    it counts, ``moved`` those that it makes room in, ``support`` the functions of `support.c` that it calls, ``named`` the lanes that its
    kernel uses, ``hidden`` those that are hidden, ``registers`` those that it reads, ``tables`` the names of the constants that it has,
    ``begun`` the starts of spans of an object whose counts come next.
    """

    locals: Namespace
    lanes: Lanes
    support: set[str]
    hidden: set[int]
    named: set[int]
    parameters: set[str] = field(default_factory=set[str])
    touched: set[int] = field(default_factory=set[int])
    counted: set[int] = field(default_factory=set[int])
    moved: set[int] = field(default_factory=set[int])
    registers: set[int] = field(default_factory=set[int])
    tables: dict[tuple[Scalar, tuple[int, ...]], str] = field(default_factory=dict[tuple["Scalar", tuple[int, ...]], str])
    begun: dict[tuple[int, int], Expr] = field(default_factory=dict[tuple[int, int], "Expr"])

    def table(self, type_: Scalar, values: tuple[int, ...]) -> str:
        """The constant of the function that has some values."""
        if (type_, values) not in self.tables:
            self.tables[type_, values] = self.locals.identifier(f"table\0{len(self.tables)}")
        return self.tables[type_, values]

    def calls(self, function: str) -> str:
        """A function of the support, which will be part of the file, or of the one that lanes say."""
        self.support.add(function)
        return f"{self.lanes.shared}{function}"

    def takes(self, parameter: str) -> str:
        """A parameter, which the function will have."""
        self.parameters.add(parameter)
        return parameter

    def rows(self, lane: int) -> str:
        """The pointer to the rows of a lane."""
        self.parameters.add(
            "given_row" if lane == self.lanes.subject and self.lanes.row else "given_object" if lane in self.lanes.given else "holder"
        )
        self.touched.add(lane)
        self._note(lane)
        return self.lanes.rows(lane)

    def used(self, lane: int) -> str:
        """The variable that counts a lane's rows in use."""
        if lane:
            self.parameters.add("holder")
        self.counted.add(lane)
        self._note(lane)
        return self.lanes.used(lane)

    def capacity(self, lane: int) -> str:
        """How many rows a lane has room for."""
        self.parameters.add("holder")
        self._note(lane)
        return self.lanes.capacity(lane)

    def register(self, number: int) -> str:
        """The constant with what a register holds when the function starts."""
        self.parameters.add("holder")
        self.registers.add(number)
        return register_name(number)

    def _note(self, lane: int) -> None:
        self.named.add(lane)
        if lane >= self.lanes.own:
            self.hidden.add(lane - self.lanes.own)


def register_name(number: int) -> str:
    """What the constant is called that has what a register holds when a function starts."""
    return f"register_{number}"
