"""The two sides of a mapping while its rules run: the holder in its lanes, the wire where the walk found or laid out its fields.

A side can be read (`values.Source`) and be written; which one is which depends on the direction alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import (
    WIDTH,
    Address,
    Binary,
    Compare,
    Const,
    Expr,
    Fill,
    Get,
    Load,
    Place,
    Select,
    SetField,
    Store,
    Wire,
    add,
    index,
    mul,
)
from rosetta_jit.lowering.bear import bear_each
from rosetta_jit.lowering.bound import EACH, NotInPlaceError
from rosetta_jit.lowering.fields import converted, member_of, presence_bit, scalar_name
from rosetta_jit.lowering.typed import FieldStep, IndexStep
from rosetta_jit.lowering.writer import Where
from rosetta_jit.model.layout import Number, Row
from rosetta_jit.model.types import Array

if TYPE_CHECKING:
    from rosetta_jit.lowering import typed
    from rosetta_jit.lowering.bound import Region, WireFields
    from rosetta_jit.lowering.fields import HolderElements, HolderFields
    from rosetta_jit.lowering.values import Values
    from rosetta_jit.lowering.writer import Writer
    from rosetta_jit.model.births import Births
    from rosetta_jit.model.layout import Member
    from rosetta_jit.model.types import Constant, Field
    from rosetta_jit.wire.codec import Path

Key = tuple[object, ...]
"""A place by names and the kernel's expressions of its indices."""


def inside(number: Expr, count: Expr) -> Expr:
    """Whether an index is one of so many."""
    return Binary("and", Compare("ge", number, index(0)), Compare("lt", number, count))


@dataclass(slots=True)
class HolderSide:
    """A message in lanes: the holder, or a wire's message that is staged.

    Arrays whose length was set, or that were looked at, are known by their place. Where rules fill it, elements are born with what
    ``births`` says, but for what lies in ``opened`` lanes.
    """

    root: HolderFields
    births: Births | None = None
    opened: frozenset[int] = frozenset()
    arrays: dict[Key, tuple[HolderElements, Expr]] = field(default_factory=dict["Key", "tuple[HolderElements, Expr]"])

    @property
    def writer(self) -> Writer:
        return self.root.writer

    def number(self, place: typed.Place, values: Values) -> Expr:
        fields, path, last = self.descend(place, values)
        value = self.writer.let(path[-1] if path else "element", _got(fields, path))
        if not path:
            return value
        owner = fields.find(path[:-1])
        member = member_of(owner.slot, path[-1])
        if member.presence is None or last is None or not isinstance(owner.slot, Row):
            return value
        place_of_bit, mask = presence_bit(owner, owner.slot, member.presence)
        present = Compare("ne", Binary("and", Get("u64", place_of_bit), mask), Const("u64", 0))
        return self.present_or_default(present, member, last, value, values)

    def present_or_default(self, present: Expr, member: Member, last: Field, value: Expr, values: Values) -> Expr:
        """What reading gives: the value; where it is absent, its default, or an error if it is required."""
        if last.required:
            self.writer.expect(present, "missing", values.where.member(last.name), "a required field is not set", line=values.line)
            return value
        scalar = member.slot.scalar if isinstance(member.slot, Number) else "i32"
        return Select(present, value, Const(scalar_name(scalar), _number(last.default)))

    def count(self, place: typed.Place, values: Values) -> Expr:
        return self.array(place, values)[1]

    def address(self, place: typed.Place, values: Values) -> Address:
        """Where the bytes of a string or bytes field begin."""
        elements, _ = self.array(place, values)
        return Place(elements.lane, elements.start)

    def array(self, place: typed.Place, values: Values) -> tuple[HolderElements, Expr]:
        """The elements of an array, and how many there are."""
        key = self.key(place, values)
        if key not in self.arrays:
            fields, path, _ = self.descend(place, values)
            stored = fields.stored(path)
            self.arrays[key] = fields.elements(path, stored), stored.size
        return self.arrays[key]

    def key(self, place: typed.Place, values: Values) -> Key:
        return tuple(step.field.name if isinstance(step, FieldStep) else values.of(step.index) for step in place.steps)

    def descend(self, place: typed.Place, values: Values) -> tuple[HolderFields, Path, Field | None]:
        """The fields of the innermost element, the path from there, and the last field of it."""
        fields, path, last = self.root, (), None
        for done, step in enumerate(place.steps):
            match step:
                case FieldStep(each):
                    path, last = (*path, each.name), each
                case IndexStep(at):
                    elements, count = self.array(_prefix(place, done), values)
                    number = values.of(at)
                    where = fields.where.members(path).element(number)
                    self.writer.expect(inside(number, count), "index", where, "no such element", line=values.line)
                    fields, path, last = elements.at(number), (), None
        return fields, path, last

    # --- writing -------------------------------------------------------------------------------------------------------

    def set_number(self, place: typed.Place, value: Expr, values: Values) -> None:
        fields, path, _ = self.descend(place, values)
        fields.put(path, value)

    def set_length(self, place: typed.Place, count: Expr, values: Values) -> None:
        """Take room for the elements; those that are structs begin empty."""
        fields, path, _ = self.descend(place, values)
        where = fields.where.members(path)
        self.writer.expect(Compare("ge", count, index(0)), "count", where, "a length must not be negative", line=values.line)
        elements = fields.open(path, count)
        self.arrays[self.key(place, values)] = elements, count
        lane = self.root.layout.lanes[elements.lane]
        if not isinstance(lane.element, Number):
            self.writer.expect(Compare("le", count, index((1 << 56) // lane.stride)), "count", where, "too many elements")
            self.writer.emit(Fill(Place(elements.lane, elements.start), mul(count, lane.stride)))
        if isinstance(place.type, Array) and self.births is not None:
            bear_each(fields, self.births.of_elements(place.type.element, elements.lane), elements.start, count, self.opened)

    @property
    def borrows(self) -> bool:
        """Whether bytes stay in the message."""
        return self.root.borrow

    def borrow(self, place: typed.Place, at: Expr, size: Expr, values: Values) -> None:
        """Say where in the message the bytes of a field are."""
        fields, path, _ = self.descend(place, values)
        fields.put_bytes(path, at, size)

    def set_byte(self, place: typed.Place, number: int, value: int, values: Values) -> None:
        """One byte of a text whose length was set."""
        elements, _ = self.array(place, values)
        self.writer.emit(SetField(Place(elements.lane, add(elements.start, number)), Const("u8", value)))


@dataclass(slots=True)
class WireSide:
    """The wire, as the walk has bound it."""

    writer: Writer
    root: WireFields

    def number(self, place: typed.Place, values: Values) -> Expr:
        key, indices = wire_key(place)
        if not indices:
            found = self.root.get(key)
            if found is None:
                raise NotInPlaceError(key)
            return found
        region, at = self.element(key, indices, values)
        return Load(region.scalar, at, ">" if region.order == ">" else "<")

    def count(self, place: typed.Place, values: Values) -> Expr:
        del values
        return self.root.size_of(wire_key(place)[0])

    def address(self, place: typed.Place, values: Values) -> Address:
        """Where the bytes of a string or bytes field begin."""
        del values
        key = (*wire_key(place)[0], EACH)
        if key not in self.root.found.regions:
            raise NotInPlaceError(key)
        return Wire(self.root.found.regions[key].first)

    def element(self, key: Path, indices: list[typed.Expr], values: Values) -> tuple[Region, Expr]:
        """How the elements of an array lie, and where one of them is; it is checked to be there."""
        if len(indices) != 1 or key not in self.root.found.regions:
            raise NotInPlaceError(key)
        region, array = self.root.found.regions[key], key[: key.index(EACH)]
        number = values.of(indices[0])
        where = Where().members(array).element(number)
        self.writer.expect(inside(number, self.root.size_of(array)), "index", where, "no such element", line=values.line)
        at = Binary("add", region.first, mul(number, region.step))
        self.writer.require(WIDTH[region.scalar], where, at=at)
        return region, at

    # --- writing -------------------------------------------------------------------------------------------------------

    def set_number(self, place: typed.Place, value: Expr, values: Values) -> None:
        """Numbers outside arrays were written by the walk."""
        key, indices = wire_key(place)
        if indices:
            region, at = self.element(key, indices, values)
            self.writer.emit(Store(at, converted(value, region.scalar), ">" if region.order == ">" else "<"))

    def is_open(self, place: typed.Place) -> bool:
        """Whether the walk has left room for the bytes of a field, and not copied them."""
        return (*wire_key(place)[0], EACH) in self.root.found.regions

    def set_length(self, place: typed.Place, count: Expr, values: Values) -> None:
        """The walk has asked for it."""

    def set_byte(self, place: typed.Place, number: int, value: int, values: Values) -> None:
        """One byte of a text whose size the walk has asked for."""
        del values
        at = add(self.root.found.regions[(*wire_key(place)[0], EACH)].first, number)
        self.writer.require(1, self.root.where, at=at)
        self.writer.emit(Store(at, Const("u8", value)))


Side = HolderSide | WireSide


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


def _prefix(place: typed.Place, steps: int) -> typed.Place:
    from rosetta_jit.lowering.typed import Place as TypedPlace

    return TypedPlace(place.side, place.steps[:steps], place.type)


def _got(fields: HolderFields, path: Path) -> Expr:
    value = fields.get(path)
    assert value is not None
    return value


def _number(default: Constant | None) -> int | float:
    return default if isinstance(default, int | float) else 0
