"""What a statement looks like without its numbers and names, and these in the order in which they stand there.

Two statements with the same *shape* differ in nothing but what stands in their *slots*.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from math import gcd
from operator import attrgetter
from typing import Any, Literal, NamedTuple

from rosetta_jit.kernel import ir as kernel
from rosetta_jit.kernel.terms import BEGIN, END, ROW
from rosetta_jit.kernel.walk import blocks_of, expressions_of, operands

FIXED = frozenset((BEGIN.name, END.name, ROW.name))
"""Names that mean the same in all statements."""

WIDEST = 8
"""The largest width of a scalar."""

Kind = Literal["number", "lane", "offset", "site", "read", "assigned", "bound"]


class Slot(NamedTuple):
    """A number or a name. An offset has its lane; a site the distances of those that are named together with it; what is read its type."""

    kind: Kind
    name: str = ""
    number: int = 0
    lane: int = 0
    distances: tuple[int, ...] = (0,)
    type: kernel.Scalar = "i64"

    @property
    def is_use(self) -> bool:
        return self.kind in ("read", "assigned")


class Outline:
    """The shape of a statement and its slots: those of its expressions from left to right, then those of its blocks."""

    def __init__(self, stmt: kernel.Stmt, strides: Sequence[int], own_lanes: int) -> None:
        self.strides, self.own_lanes = strides, own_lanes
        self._shape = list["Hashable"]()
        self.slots = list[Slot]()
        self._statement(stmt)
        self.shape: Hashable = tuple(self._shape)

    # --- statements ------------------------------------------------------------------------------------------------------

    def _statement(self, stmt: kernel.Stmt) -> None:
        self._shape.append(type(stmt))
        self._own(stmt)
        for expr in expressions_of(stmt):
            self._expression(expr)
        for block in blocks_of(stmt):
            self._shape.append(len(block))
            for each in block:
                self._statement(each)

    def _own(self, stmt: kernel.Stmt) -> None:
        """What is a statement's own, besides its expressions and blocks."""
        match stmt:
            case kernel.Require(_, _, failure) | kernel.Expect(_, failure):
                self._shape.append(len(failure.indices))
                self._sites((failure.site,))
            case kernel.Let(name, _) | kernel.Var(name, _) | kernel.For(name, _, _):
                self.slots.append(Slot("bound", name))
            case kernel.Assign(name, _):
                self.slots.append(Slot("assigned", name))
            case kernel.Reserve(lane, _) | kernel.Advance(lane, _):
                self._lane(lane)
            case kernel.Switch(_, cases, _):
                self._shape.append(tuple(number for number, _ in cases))
            case kernel.Call(routine, _, results, sites, indices):
                self._shape += [routine, len(indices)]
                self.slots += [Slot("bound", each.name) for each in results]
                self._sites(sites)
            case kernel.HostCall() | kernel.Return():
                self._shape.append(object())  # which is like no other
            case kernel.Store() | kernel.SetField() | kernel.Copy() | kernel.Fill():
                self._effect(stmt)
            case _:
                pass

    def _effect(self, stmt: kernel.Store | kernel.SetField | kernel.Copy | kernel.Fill) -> None:
        match stmt:
            case kernel.Store(_, _, order):
                self._shape.append(order)
            case kernel.SetField(place, _):
                self._place(place)
            case kernel.Copy(target, source, _):
                self._address(target)
                self._address(source)
            case kernel.Fill(target, _, byte):
                self._address(target)
                self._shape.append(byte)

    def _sites(self, sites: tuple[int, ...]) -> None:
        distances = tuple([each - sites[0] for each in sites])
        self._shape.append(distances)
        if sites:
            self.slots.append(Slot("site", number=sites[0], distances=distances))

    # --- places ----------------------------------------------------------------------------------------------------------

    def _address(self, address: kernel.Address) -> None:
        self._shape.append(type(address))
        if isinstance(address, kernel.Place):
            self._place(address)

    def _place(self, place: kernel.Place) -> None:
        lane, offset = place.lane, place.offset
        self._lane(lane)
        self._shape.append(gcd(WIDEST, self.strides[lane], offset))  # how far it is aligned
        self.slots.append(Slot("offset", number=offset, lane=lane))

    def _lane(self, lane: int) -> None:
        is_own = lane < self.own_lanes
        self._shape += [is_own, self.strides[lane] if is_own else lane]
        if is_own:
            self.slots.append(Slot("lane", number=lane))

    # --- expressions -----------------------------------------------------------------------------------------------------

    def _expression(self, expr: kernel.Expr) -> None:
        self._shape.append(type(expr))
        match expr:
            case kernel.Local(type_, name):
                self._shape += [type_, name if name in FIXED else ""]
                if name not in FIXED:
                    self.slots.append(Slot("read", name, type=type_))
            case kernel.Const(type_, value):
                is_integer = is_number(expr)
                self._shape += [type_, "" if is_integer else repr(value)]
                if is_integer:
                    self.slots.append(Slot("number", number=int(value)))
            case kernel.Used(lane) | kernel.Capacity(lane):
                self._lane(lane)
            case _:
                self._parts(expr)

    def _parts(self, expr: kernel.Expr) -> None:
        match expr:
            case kernel.Get(_, place):
                self._place(place)
            case kernel.IsText(address, _) | kernel.Nearest(address, _, _):
                self._address(address)
            case _:
                pass
        literal = _LITERALS.get(type(expr))
        if literal is not None:
            self._shape.append(literal(expr))
        for each in operands(expr):
            self._expression(each)


_LITERALS: dict[type[kernel.Expr], Callable[[Any], Hashable]] = {
    **dict.fromkeys((kernel.Binary, kernel.Compare, kernel.Fits), attrgetter("op")),
    **dict.fromkeys((kernel.Convert, kernel.Bits, kernel.Get), attrgetter("type")),
    kernel.Load: attrgetter("type", "order"),
    kernel.Unary: attrgetter("function"),
    kernel.Digits: attrgetter("places"),
    kernel.Lookup: attrgetter("type", "values"),
    kernel.HostValue: attrgetter("what"),
    kernel.Register: attrgetter("number"),
}
"""What is an expression's own, besides its operands."""


def is_number(expr: kernel.Const) -> bool:
    """Whether a constant is an integer."""
    return expr.type not in ("bool", "f32", "f64")
