"""The loops that set the elements of one array from those of others, in the order that views of them say."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.language.arrays.array_functions import PADDED
from rosetta_jit.language.arrays.counts import ONE, ZERO, LayoutError, minus, over, plus, times
from rosetta_jit.language.arrays.layouts import SIZES, Axis, NumberType, View
from rosetta_jit.language.arrays.parts import substituted
from rosetta_jit.model.expr import Binary, Call, Choice, Expr, Index, Literal, Name, Path
from rosetta_jit.model.mapping import Assign, Assignment, For, Rule
from rosetta_jit.startup.dataclass import dataclass, replace

SHORT = 16

if TYPE_CHECKING:
    Inside = Callable[[list[Expr], int], tuple[Rule, ...]]

Padding = tuple["Expr", "Expr", "Expr"]
"""How many rows, how many elements in each, and how many from one to the next."""


@dataclass(frozen=True, slots=True)
class Moves:
    """The loops of one rule: what sets ``target`` from the elements of ``views``.

    ``level`` is how many loops are around, ``variable`` names the one at a level, ``expanded`` gives the rules for one element. Where the
    target is filled with the bytes of numbers, ``packed`` is their type; else an element is one number.
    """

    rule: Assignment
    target: View
    views: dict[Path | Call, View]
    count: Expr
    padding: Padding | None
    level: int
    variable: Callable[[int], str]
    expanded: Callable[[Assignment, int], tuple[Rule, ...]]
    packed: NumberType | None = None

    @property
    def width(self) -> Expr:
        """How many elements of the target are set for each of the source."""
        return ONE if self.packed is None else self.packed.size

    def rules(self) -> tuple[Rule, ...]:
        views = (self.target, *self.views.values())
        if self.padding is not None:
            return self.in_rows(self.padding)
        if any(len(view.axes) > 1 for view in views):
            return self.in_axes(self.only_view())
        if any(view.axes[0].listed is not None for view in views):
            return self.listed(views)
        name = self.variable(self.level)
        body = self.moved({source: [Name(name)] for source in self.views}, Name(name), self.level + 1)
        rounds = self.count if self.packed is None else next(iter(self.views.values())).total
        return (For(name, ZERO, rounds, body, self.rule.span),)

    def listed(self, views: tuple[View, ...]) -> tuple[Rule, ...]:
        """One rule an element."""
        number = next(len(view.axes[0].listed) for view in views if view.axes[0].listed is not None)
        indices = [Literal(each, self.rule.span) for each in range(number)]
        return tuple(made for each in indices for made in self.moved({source: [each] for source in self.views}, each, self.level))

    def in_axes(self, view: View) -> tuple[Rule, ...]:
        """A loop an axis; what is set lies without gaps in the order of the rounds."""

        def inside(indices: list[Expr], level: int) -> tuple[Rule, ...]:
            return self.moved(dict.fromkeys(self.views, indices), _dense(indices, view.axes), level)

        return self.nest(view.axes, inside)

    def in_rows(self, padding: Padding) -> tuple[Rule, ...]:
        """A loop over rows, one over each axis within, and one over the padding."""
        count, size, stride = padding
        view = self.only_view()
        first, *inner = view.axes
        call = self.rule.value if isinstance(self.rule.value, Call) else Call(PADDED, (), self.rule.span)
        groups = over(size, reduce(times, (axis.count for axis in inner), self.width), call)

        def row(indices: list[Expr], level: int) -> tuple[Rule, ...]:
            (y,) = indices

            def element(within: list[Expr], level: int) -> tuple[Rule, ...]:
                source = [plus(times(y, groups), within[0]), *within[1:]]
                dense = _dense(within, (replace(first, count=groups), *inner))
                return self.moved(dict.fromkeys(self.views, source), dense, level, behind=times(y, stride))

            name = self.variable(level)
            place = _place(self.target, [plus(times(y, stride), Name(name))])
            fill: Rule = Assign(place, Literal(0, self.rule.span), self.rule.span)
            return (
                *self.nest((replace(first, count=groups), *inner), element, level),
                For(name, size, stride, (fill,), self.rule.span),
            )

        return self.nest((Axis(count, stride),), row)

    def only_view(self) -> View:
        match [*self.views.values()]:
            case [view] if len(self.target.axes) == 1 and self.target.axes[0].listed is None:
                return view
            case _:
                raise LayoutError(words.two_orders(self.rule.span))

    def nest(self, axes: tuple[Axis, ...], inside: Inside, level: int | None = None) -> tuple[Rule, ...]:
        """Loops over axes around what stands in the innermost: the short ones within, for what they read lies together."""
        order = sorted(range(len(axes)), key=lambda number: _is_short(axes[number]))
        return self.around(axes, order, inside, {}, self.level if level is None else level)

    def around(self, axes: tuple[Axis, ...], order: list[int], inside: Inside, done: dict[int, Expr], level: int) -> tuple[Rule, ...]:
        if not order:
            return inside([done[number] for number in range(len(axes))], level)
        axis, rest = axes[order[0]], order[1:]
        if axis.listed is not None:
            numbers = [Literal(number, self.rule.span) for number in range(len(axis.listed))]
            return tuple(made for number in numbers for made in self.around(axes, rest, inside, {**done, order[0]: number}, level))
        name = self.variable(level)
        body = self.around(axes, rest, inside, {**done, order[0]: Name(name)}, level + 1)
        return (For(name, ZERO, axis.count, body, self.rule.span),)

    def moved(self, indices: dict[Path | Call, list[Expr]], number: Expr, level: int, behind: Expr = ZERO) -> tuple[Rule, ...]:
        """The rule for one element, ``behind`` so many others; itself a loop, if its elements are arrays, or the bytes of a number."""
        elements: dict[Expr, Expr] = {source: element_at(self.views[source], at) for source, at in indices.items()}
        value, first = substituted(self.rule.value, elements, number), plus(behind, times(number, self.width))
        if self.packed is None:
            return self.expanded(replace(self.rule, place=_place(self.target, [first]), value=value), level)
        name = self.variable(level)
        rule = replace(self.rule, place=_place(self.target, [plus(first, Name(name))]), value=byte_of(value, Name(name), self.packed))
        return (For(name, ZERO, self.width, self.expanded(rule, level + 1), self.rule.span),)


def byte_of(value: Expr, number: Expr, packed: NumberType) -> Expr:
    """A byte of a number as its type has it, counted from the first that is written."""
    last = Binary("-", Literal(SIZES[packed.name] - 1), number, value.span)
    big = packed.big
    which = (
        number if big == Literal(value=False) else last if big == Literal(value=True) else Choice(((big, last),), number, span=value.span)
    )
    return Call("byte", (Call(packed.name, (value,), value.span), which), value.span)


def _is_short(axis: Axis) -> bool:
    """Whether an axis is a pixel's channels rather than an image's rows."""
    return axis.listed is not None or (isinstance(axis.count, Literal) and int(axis.count.value) <= SHORT)


def element_of(view: View, number: Expr) -> Expr:
    """The element of a number, of a view that is in one order; raises LayoutError."""
    if len(view.axes) != 1 or view.axes[0].listed is not None:
        raise LayoutError(words.asked_in_order(view.array.span))
    return element_at(view, [number])


def element_at(view: View, indices: list[Expr]) -> Expr:
    """One element of a view: a field, or the number that begins at a byte."""
    if view.number is None:
        return _place(view, indices)
    return Call(f"{view.number.name}_at", (view.array, _at(view, indices), view.number.big), view.array.span)


def _place(view: View, indices: list[Expr]) -> Path:
    """The place of an element of a view."""
    return replace(view.array, steps=(*view.array.steps, Index(_at(view, indices), view.array.span), *view.rest))


def _at(view: View, indices: list[Expr]) -> Expr:
    """The number of an element. What the outer loops add comes first, so that it can be added outside of the inner ones."""
    parts = [(axis, _listed(axis, number)) for axis, number in zip(view.axes, indices, strict=True)]
    (axis, number), *rest = sorted(parts, key=lambda part: _is_short(part[0]))
    at = minus(view.first, number) if axis.step == Literal(-1) else plus(times(number, axis.step), view.first)
    for axis, number in rest:
        at = minus(at, number) if axis.step == Literal(-1) else plus(at, times(number, axis.step))
    return at


def _listed(axis: Axis, number: Expr) -> Expr:
    return Literal(axis.listed[int(number.value)], number.span) if axis.listed is not None and isinstance(number, Literal) else number


def _dense(indices: list[Expr], axes: tuple[Axis, ...]) -> Expr:
    """The number of an element, counted along the axes."""
    number: Expr = ZERO
    for index, axis in zip(indices, axes, strict=True):
        number = plus(times(number, axis.count), index)
    return number
