"""The wire as a side of a mapping, while its rules run: its fields where the walk found them, or laid them out.

It can be read (`lowering.evaluation.Source`) and be written; which one it is depends on the direction alone.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from math import prod
from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import WIDTH, Address, Binary, Compare, Const, Expr, Load, Require, Store, Wire
from rosetta_jit.kernel.terms import add, index, mul
from rosetta_jit.language import typed
from rosetta_jit.language.typed import FieldStep, IndexStep
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.codec.fields import converted
from rosetta_jit.lowering.codec.wire_fields import EACH, Fixed, Region, WireFields
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.writer import Where, Writer
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Path

if TYPE_CHECKING:
    from rosetta_jit.lowering.texts import views
else:
    views = Late("rosetta_jit.lowering.texts.views")


@dataclass(slots=True)
class WireSide:
    """The wire, as the walk has bound it."""

    writer: Writer
    root: WireFields

    def forgetting(self) -> AbstractContextManager[None]:
        return nullcontext()

    def number(self, place: typed.Place, values: Evaluation) -> Expr:
        key, indices = wire_key(place)
        if not indices:
            found = self.root.get(key)
            assert found is not None, key
            return found
        region, at = self.element(key, indices, values)
        return Load(region.scalar, at, ">" if region.order == ">" else "<")

    def count(self, place: typed.Place, values: Evaluation) -> Expr:
        """How many elements or bytes there are; how many an element has is fixed, or known only while the walk is there."""
        key, indices = wire_key(place)
        if not indices:
            return self.root.size_of(key)
        self.number_of_element(key, indices[0], values)
        return index(self.fixed(key, len(indices)).length)

    def fixed(self, key: Path, depth: int) -> Fixed:
        """The array of fixed length within an element, or within other such arrays of it."""
        inside = (*key, EACH)
        return next(region.inner[depth - 1] for each, region in self.root.found.regions.items() if each[: len(inside)] == inside)

    def address(self, place: typed.Place, values: Evaluation) -> Address:
        """The address of the bytes of a string or bytes field."""
        key, indices = wire_key(place)
        if not indices:
            return Wire(self.root.found.regions[*key, EACH].first)
        return Wire(self.element((*key, EACH), indices, values)[1])

    def present(self, place: typed.Place, values: Evaluation) -> Expr:
        """Whether what can be absent is there; fields of which this can be said are not read in place."""
        raise AssertionError(place, values)

    def element(self, key: Path, indices: list[typed.Expr], values: Evaluation) -> tuple[Region, Expr]:
        """How the elements of an array lie, and where one of them is; it is checked to be there.

        With fewer indices than there are arrays, the first one of the arrays that are left, which is there as a whole.
        """
        region = self.root.found.regions[key]
        number, where, count = self.number_of_element(key, indices[0], values)
        if not isinstance(region.step, Const) and has_product(indices[0]):
            number = self.writer.let("element", views.between(number, index(0), Binary("sub", count, index(1))))
        at = Binary("add", region.first, mul(number, region.step))
        if not isinstance(region.step, Const):  # written down, for it follows from a product
            self.writer.expect(Compare("ge", at, region.first), "index", where, "no such element", line=values.line)
        known = {inside(number, count)}
        for fixed, each in zip(region.inner, indices[1:], strict=False):
            number = self.writer.once(values.of(each))
            known.add(inside(number, index(fixed.length)))
            self.writer.expect(inside(number, index(fixed.length)), "index", where, "no such element", line=values.line)
            at = Binary("add", at, mul(number, index(fixed.step)))
        left = region.inner[len(indices) - 1 :]
        size = WIDTH[region.scalar] * prod(fixed.length for fixed in left)
        self.writer.require(size, where, at=at)
        match self.writer.block:
            case [*_, Require(at=required) as check] if required == at and known <= self.writer.certain:
                self.writer.certain.add(check)
            case _:
                pass
        return region, at

    def number_of_element(self, key: Path, number: typed.Expr, values: Evaluation) -> tuple[Expr, Where, Expr]:
        """The number of an element of the outermost array, checked to be there; which one that is, and how many there are."""
        array, found = key[: key.index(EACH)], self.writer.once(values.of(number))
        where, count = Where().members(array).element(found), self.root.size_of(array)
        self.writer.expect(inside(found, count), "index", where, "no such element", line=values.line)
        return found, where, count

    # --- writing -------------------------------------------------------------------------------------------------------

    def set_number(self, place: typed.Place, value: Expr, values: Evaluation) -> None:
        """Numbers outside arrays were written by the walk."""
        key, indices = wire_key(place)
        if indices:
            region, at = self.element(key, indices, values)
            self.writer.emit(Store(at, converted(value, region.scalar), ">" if region.order == ">" else "<"))

    def clear(self, place: typed.Place, values: Evaluation) -> None:
        """Numbers of an element, for which the walk has left room, are 0; it has written those outside arrays."""
        key, indices = wire_key(place)
        for each in [each for each in self.root.found.regions if indices and each[: len(key)] == key]:
            region, at = self.element(each, indices, values)
            self.writer.emit(Store(at, Const(region.scalar, 0), ">" if region.order == ">" else "<"))

    def is_open(self, place: typed.Place) -> bool:
        """Whether the walk has left room for the bytes of a field, and not copied them."""
        return (*wire_key(place)[0], EACH) in self.root.found.regions

    def set_length(self, place: typed.Place, count: Expr, values: Evaluation) -> None:
        """The walk has asked for it."""

    def set_unit(self, place: typed.Place, number: int, value: int, values: Evaluation) -> None:
        """One byte of a text whose size the walk has asked for."""
        del values
        at = add(self.root.found.regions[(*wire_key(place)[0], EACH)].first, number)
        self.writer.require(1, self.root.where, at=at)
        self.writer.emit(Store(at, Const("u8", value)))


def wire_key(place: typed.Place) -> tuple[Path, list[typed.Expr]]:
    """The path of a place with its indices taken out."""
    key: list[str] = []
    indices: list[typed.Expr] = []
    for step in place.steps:
        match step:
            case FieldStep(each):
                key.append(each.name)
            case IndexStep(at):
                key.append(EACH)
                indices.append(at)
    return tuple(key), indices


def has_product(number: typed.Expr) -> bool:
    """Whether an index multiplies what is not known: one more factor, and the proof sees no bound of the product."""
    match number:
        case typed.Binary("*", left, right) if not isinstance(left, typed.Const) and not isinstance(right, typed.Const):
            return True
        case typed.Binary(_, left, right):
            return has_product(left) or has_product(right)
        case typed.Unary(_, operand) | typed.Convert(operand, _, _):
            return has_product(operand)
        case _:
            return False
