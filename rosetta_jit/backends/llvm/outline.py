"""What a statement looks like without its numbers and names, and these in the order in which they stand there.

Two statements with the same *shape* differ in nothing but what stands in their *slots*.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from math import gcd
from operator import attrgetter
from typing import Any, Literal, NamedTuple

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.terms import BEGIN, END, ROW, type_of
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
    type: nodes.Scalar = "i64"

    @property
    def is_use(self) -> bool:
        return self.kind in ("read", "assigned")


_slot: Callable[[tuple[Kind, str, int, int, tuple[int, ...], nodes.Scalar]], Slot] = partial(tuple[Any, ...].__new__, Slot)
"""A `Slot` of its parts, in half the time of its class: there are several in each statement."""

_ALONE = (0,)
"""The distances of a number that is named for itself."""


class Outline:
    """The shape of a statement and its slots: those of its expressions from left to right, then those of its blocks."""

    def __init__(self, stmt: nodes.Stmt, strides: Sequence[int], own_lanes: int) -> None:
        self.strides, self.own_lanes = strides, own_lanes
        self._shape = list["Hashable"]()
        self.slots = list[Slot]()
        self._statement(stmt)
        self.shape: Hashable = tuple(self._shape)

    # --- statements ------------------------------------------------------------------------------------------------------

    def _statement(self, stmt: nodes.Stmt) -> None:
        self._shape.append(type(stmt))
        self._own(stmt)
        for expr in expressions_of(stmt):
            self._expression(expr)
        for block in blocks_of(stmt):
            self._shape.append(len(block))
            for each in block:
                self._statement(each)

    def _own(self, stmt: nodes.Stmt) -> None:
        """What is a statement's own, besides its expressions and blocks."""
        match stmt:
            case nodes.Require(_, _, failure) | nodes.Expect(_, failure):
                self._shape.append(len(failure.indices))
                self._sites((failure.site,))
            case nodes.Let(name, _) | nodes.Var(name, _) | nodes.For(name, _, _):
                self.slots.append(_slot(("bound", name, 0, 0, _ALONE, "i64")))
            case nodes.Assign(name, _):
                self.slots.append(_slot(("assigned", name, 0, 0, _ALONE, "i64")))
            case nodes.Reserve(lane, _) | nodes.Advance(lane, _):
                self._lane(lane)
            case nodes.Switch(_, cases, _):
                self._shape.append(tuple(number for number, _ in cases))
            case nodes.Call(routine, _, results, sites, indices):
                self._shape += [routine, len(indices)]
                self.slots += [Slot("bound", each.name) for each in results]
                self._sites(sites)
            case nodes.HostCall() | nodes.Return():
                self._shape.append(object())  # which is like no other
            case nodes.Store() | nodes.SetField() | nodes.Copy() | nodes.Fill():
                self._effect(stmt)
            case _:
                pass

    def _effect(self, stmt: nodes.Store | nodes.SetField | nodes.Copy | nodes.Fill) -> None:
        match stmt:
            case nodes.Store(_, _, order):
                self._shape.append(order)
            case nodes.SetField(place, value):
                self._place(place, nodes.WIDTH[type_of(value)])
            case nodes.Copy(target, source, _):
                self._address(target)
                self._address(source)
            case nodes.Fill(target, _, byte):
                self._address(target)
                self._shape.append(byte)

    def _sites(self, sites: tuple[int, ...]) -> None:
        """A slot for each run of sites that follow one another: of blocks that are alike, runs may lie in other distances."""
        runs = runs_of(sites)
        self._shape.append(tuple([count for _, count in runs]))
        self.slots += [_slot(("site", "", first, 0, tuple(range(count)) if count > 1 else _ALONE, "i64")) for first, count in runs]

    # --- places ----------------------------------------------------------------------------------------------------------

    def _address(self, address: nodes.Address) -> None:
        self._shape.append(type(address))
        if isinstance(address, nodes.Place):
            self._place(address)

    def _place(self, place: nodes.Place, width: int = WIDEST) -> None:
        lane, offset = place.lane, place.offset
        self._lane(lane)
        self._shape.append(gcd(width, self.strides[lane], offset))  # how far what has such a width is aligned there
        self.slots.append(_slot(("offset", "", offset, lane, _ALONE, "i64")))

    def _lane(self, lane: int) -> None:
        is_own = lane < self.own_lanes
        self._shape += [is_own, self.strides[lane] if is_own else lane]
        if is_own:
            self.slots.append(_slot(("lane", "", lane, 0, _ALONE, "i64")))

    # --- expressions -----------------------------------------------------------------------------------------------------

    def _expression(self, expr: nodes.Expr) -> None:
        match expr:
            case nodes.Local():
                is_fixed = expr.name in FIXED
                self._shape += (nodes.Local, expr.type, expr.name if is_fixed else "")
                if not is_fixed:
                    self.slots.append(_slot(("read", expr.name, 0, 0, _ALONE, expr.type)))
            case nodes.Const():
                is_integer = is_number(expr)
                self._shape += (nodes.Const, expr.type, "" if is_integer else repr(expr.value))
                if is_integer:
                    self.slots.append(_slot(("number", "", int(expr.value), 0, _ALONE, "i64")))
            case nodes.Used() | nodes.Capacity():
                self._shape.append(type(expr))
                self._lane(expr.lane)
            case _:
                self._shape.append(type(expr))
                self._parts(expr)

    def _parts(self, expr: nodes.Expr) -> None:
        literal = _LITERALS.get(type(expr))
        if literal is not None:
            self._shape.append(literal(expr))
        match expr:
            case nodes.Binary() | nodes.Compare():
                self._expression(expr.left)
                self._expression(expr.right)
                return
            case nodes.Get(type_, place):
                self._place(place, nodes.WIDTH[type_])
            case nodes.IsText(address, _) | nodes.Nearest(address, _, _):
                self._address(address)
            case _:
                pass
        for each in operands(expr):
            self._expression(each)


_LITERALS: dict[type[nodes.Expr], Callable[[Any], Hashable]] = {
    **dict.fromkeys((nodes.Binary, nodes.Compare, nodes.Fits), attrgetter("op")),
    **dict.fromkeys((nodes.Convert, nodes.Bits, nodes.Get), attrgetter("type")),
    nodes.Load: attrgetter("type", "order"),
    nodes.Unary: attrgetter("function"),
    nodes.Digits: attrgetter("places"),
    nodes.Lookup: attrgetter("type", "values"),
    nodes.HostValue: attrgetter("what"),
    nodes.Register: attrgetter("number"),
}
"""What is an expression's own, besides its operands."""


def runs_of(sites: Sequence[int]) -> list[tuple[int, int]]:
    """The runs of numbers that follow one another: where each begins, and how many they are."""
    runs: list[tuple[int, int]] = []
    for site in sites:
        first, count = runs[-1] if runs else (site, 0)
        if site == first + count:
            runs[-1:] = [(first, count + 1)]
        else:
            runs.append((site, 1))
    return runs


def is_number(expr: nodes.Const) -> bool:
    """Whether a constant is an integer."""
    return expr.type not in ("bool", "f32", "f64")
