"""A side of a mapping in lanes, while its rules run: the holder, or a wire's message that is staged.

It can be read (`lowering.evaluation.Source`) and be written; which one it is depends on the direction alone.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Address, Assign, Binary, Compare, Const, Expr, Get, If, Place, Select, SetField, Switch, Used
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.language import typed
from rosetta_jit.language.check.discriminators import Discriminator, discriminator_of
from rosetta_jit.language.places import field_names
from rosetta_jit.language.typed import FieldStep, IndexStep
from rosetta_jit.lowering.arithmetic import inside
from rosetta_jit.lowering.codec.fields import OTHER_CASE, negated, scalar_name
from rosetta_jit.lowering.codec.holder_fields import HolderElements, HolderFields, has_gaps, member_of, presence_bit
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.lowering.rules.initial_values import initialise, initialise_each
from rosetta_jit.lowering.writer import Writer, block, integer
from rosetta_jit.model.initial_values import InitialValues, selected
from rosetta_jit.model.layout import Member, Number, Row, Span, Variant
from rosetta_jit.model.types import Array, Bytes, Constant, Field, Optional, String, Struct, Union
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Path

if TYPE_CHECKING:
    from rosetta_jit.lowering.rules import shares
else:
    shares = Late("rosetta_jit.lowering.rules.shares")

Key = tuple[object, ...]
"""A place by names and the expressions of its indices."""


@dataclass(slots=True)
class HolderSide:
    """A message in lanes: the holder, or a wire's message that is staged.

    Arrays whose length was set, or that were looked at, are known by their place. Where rules fill it, elements have the initial
    values of ``initial``, but for what lies in ``opened`` lanes. ``joined`` are arrays of which other messages set elements, too.
    """

    root: HolderFields
    initial: InitialValues | None = None
    opened: frozenset[int] = frozenset()
    unions: Mapping[tuple[str, ...], Discriminator] = field(default_factory=dict[tuple[str, ...], "Discriminator"])
    joined: frozenset[tuple[str, ...]] = frozenset()
    arrays: dict[Key, tuple[HolderElements, Expr]] = field(default_factory=dict["Key", "tuple[HolderElements, Expr]"])

    @property
    def writer(self) -> Writer:
        return self.root.writer

    @contextmanager
    def forgetting(self) -> Generator[None]:
        known = dict(self.arrays)
        yield
        self.arrays = known

    def number(self, place: typed.Place, values: Evaluation) -> Expr:
        fields, path, last = self.descend(place, values)
        value = self.writer.let(path[-1] if path else "element", _got(fields, path))
        present = presence(fields, path)
        if present is None or last is None:
            return value
        return self.present_or_default(present, member_of(fields.find(path[:-1]).slot, path[-1]), last, value, values)

    def present(self, place: typed.Place, values: Evaluation) -> Expr:
        """Whether what can be absent is there, on the way from the innermost element."""
        fields, path, _ = self.descend(place, values)
        return presence(fields, path, outer=True) or Const("bool", value=True)

    def present_or_default(self, present: Expr, member: Member, last: Field, value: Expr, values: Evaluation) -> Expr:
        """What reading gives: the value; where it is absent, its default, or an error if it is required."""
        if last.required:
            self.expect_required(present, last, values)
            return value
        scalar = member.slot.scalar if isinstance(member.slot, Number) else "i32"
        return Select(present, value, Const(scalar_name(scalar), _number(last.default)))

    def expect_required(self, present: Expr, last: Field, values: Evaluation) -> None:
        self.writer.expect(present, "missing", values.where, f"the required `{last.name}` is not there", line=values.line)

    def count(self, place: typed.Place, values: Evaluation) -> Expr:
        """How many elements or bytes; a required text must be there."""
        match place.type, place.steps:
            case ((String() | Bytes()), (*_, FieldStep(Field(required=True) as last))) if self.initial is None:
                fields, path, _ = self.descend(place, values)
                present = presence(fields, path)
                if present is not None:
                    self.expect_required(present, last, values)
            case _:
                pass
        return self.array(place, values)[1]

    def address(self, place: typed.Place, values: Evaluation) -> Address:
        """The address of the bytes of a string or bytes field."""
        elements, _ = self.array(place, values)
        return Place(elements.lane, elements.start)

    def array(self, place: typed.Place, values: Evaluation) -> tuple[HolderElements, Expr]:
        """The elements of an array, and how many there are."""
        key = _key(place)
        if key not in self.arrays:
            fields, path, _ = self.descend(place, values)
            stored = fields.stored(path)
            self.arrays[key] = fields.elements(path, stored), self.count_in_case(fields, path, stored.size)
        return self.arrays[key]

    def count_in_case(self, fields: HolderFields, path: Path, size: Expr) -> Expr:
        """A number of elements; none where they are of a case that is not set: a message may have had it before another."""
        if not any(isinstance(fields.find(path[:number]).slot, Variant) for number in range(len(path))):
            return size
        present = presence(fields, path)
        count = self.writer.let("count", size if present is None else Select(present, size, index(0)))
        known = Binary("and", Compare("ge", count, index(0)), Compare("le", count, size))  # true anyway; said for the proof
        self.writer.expect(known, "length", fields.shown(path), "the holder is damaged")
        return count

    def descend(self, place: typed.Place, values: Evaluation) -> tuple[HolderFields, Path, Field | None]:
        """The fields of the innermost element, the path from there, and the last field of it."""
        fields, path, last = self.root, (), None
        for done, step in enumerate(place.steps):
            match step:
                case FieldStep(each):
                    if path and isinstance(fields.find(path).slot, Span):
                        fields, path = self.single(fields, path, values), ()
                    path, last = (*path, each.name), each
                case IndexStep(at):
                    elements, count = self.array(_prefix(place, done), values)
                    number = self.writer.once(values.of(at))
                    where = fields.shown(path).element(number)
                    self.writer.expect(inside(number, count), "index", where, "no such element", line=values.line)
                    fields, path, last = elements.at(number), (), None
        return fields, path, last

    def single(self, fields: HolderFields, path: Path, values: Evaluation) -> HolderFields:
        """A message that has a row of its own, since it can contain itself: it is there, or it comes now."""
        where = fields.shown(path)
        if self.initial is not None:
            with self.writer.nested() as new:
                elements = fields.open(path, index(1))
                fields.clear(elements.lane, elements.start, index(1))
            self.writer.emit(If(Compare("eq", fields.stored(path).size, index(0)), block(new)))
        stored = fields.stored(path)
        self.writer.expect(Compare("ge", stored.size, index(1)), "missing", where, "it is not there", line=values.line)
        return replace(fields.elements(path, stored).at(index(0)), where=where)

    # --- writing -------------------------------------------------------------------------------------------------------

    def set_number(self, place: typed.Place, value: Expr, values: Evaluation) -> None:
        fields, path, _ = self.descend(place, values)
        discriminator = self.unions.get(field_names(place))
        if discriminator is None:
            fields.put(path, value)
            return
        value = self.writer.once(value)
        fields.put(path, value)
        path, case = (*path[:-1], discriminator.name), chosen_case(discriminator.union, value, self.writer)
        self.writer.emit(SetField(_case_word(fields, path), case))
        for number in range(1, len(discriminator.union.cases) + 1):
            self.initialise_case(fields, path, discriminator, number, Compare("eq", case, index(number)))

    def choose(self, place: typed.Place, values: Evaluation) -> None:
        """The unions that a place is in a case of have that case: their discriminators say so, or are made to."""
        for steps in range(1, len(place.steps)):
            names, case = discriminator_of(place, steps), place.steps[steps]
            if names is None or not isinstance(case, FieldStep):
                continue
            discriminator = self.unions[names]
            fields, path, _ = self.descend(_prefix(place, steps), values)
            if discriminator.by_rule:
                self.expect_case(fields, path, index(discriminator.number(case.field.name)), values)
            else:
                number = discriminator.number(case.field.name)
                fields.put((*path[:-1], names[-1]), index(discriminator.label(case.field.name)))
                word = _case_word(fields, path)
                self.initialise_case(fields, path, discriminator, number, Compare("ne", Get("i64", word), index(number)))
                self.writer.emit(SetField(word, index(number)))

    def initialise_case(self, fields: HolderFields, path: Path, discriminator: Discriminator, number: int, when: Expr) -> None:
        """Give a case that comes its initial values."""
        cell = fields.find(path)
        assert isinstance(cell.slot, Variant)
        initial = (
            ()
            if self.initial is None
            else self.initial.of(discriminator.union.cases[number - 1].type, cell.slot.members[number - 1].slot, cell.lane)
        )
        with self.writer.nested() as body:
            initialise(fields, initial, cell.row, self.opened)
        if body:
            self.writer.emit(If(when, block(body)))

    def case_of(self, place: typed.Place, values: Evaluation) -> tuple[HolderFields, Path, Expr] | None:
        """The case that a discriminator has chosen for a union that is set as a whole, if one has."""
        names = discriminator_of(place, len(place.steps))
        if names is None or not self.unions[names].by_rule:
            return None
        fields, path, _ = self.descend(place, values)
        return fields, path, self.writer.let("case", Get("i64", _case_word(fields, path)))

    def expect_case(self, fields: HolderFields, path: Path, number: Expr, values: Evaluation) -> None:
        """Check that a discriminator has chosen a case."""
        agrees = Compare("eq", Get("i64", _case_word(fields, path)), number)
        self.writer.expect(agrees, "union", fields.shown(path[:-1]), OTHER_CASE, line=values.line)

    def appear(self, place: typed.Place, values: Evaluation) -> None:
        """Mark a field that can be absent as there, and give it its initial value."""
        fields, path, _ = self.descend(place, values)
        if isinstance(place.type, Struct) and isinstance(fields.find(path).slot, Span):
            self.single(fields, path, values)
        else:
            fields.appear(path)

    def require(self, place: typed.Place, values: Evaluation) -> None:
        """Mark as there what the schema requires: the place, or the innermost message around it that no message around may lack."""
        required = 0
        for count, step in enumerate(place.steps, 1):
            if isinstance(step, FieldStep) and step.field.required:
                required = count
            elif isinstance(step, FieldStep) and isinstance(step.field.type, Optional):
                break
        if required == len(place.steps):
            self.appear(place, values)
        elif required:
            fields, path, _ = self.descend(replace(place, steps=place.steps[:required]), values)
            if isinstance(fields.find(path).slot, Span):
                self.single(fields, path, values)
            else:
                fields.appear(path)

    def set_length(self, place: typed.Place, count: Expr, values: Evaluation) -> None:
        """Take room for the elements; those that are structs begin empty."""
        fields, path, _ = self.descend(place, values)
        where = fields.shown(path)
        self.writer.expect(Compare("ge", count, index(0)), "count", where, "a length must not be negative", line=values.line)
        if isinstance(place.steps[-1], FieldStep) and field_names(place) in self.joined:
            self.keep_length(fields, path, count)
            return
        elements = fields.open(path, count)
        self.arrays[_key(place)] = elements, count
        lane = self.root.layout.lanes[elements.lane]
        if not isinstance(lane.element, Number) and not has_gaps(lane.element):
            self.writer.expect(Compare("le", count, index((1 << 56) // lane.stride)), "count", where, "too many elements")
            self.root.clear(elements.lane, elements.start, count)
        if isinstance(place.type, Array) and self.initial is not None:
            initialise_each(fields, self.initial.of_elements(place.type.element, elements.lane), elements.start, count, self.opened)

    def keep_length(self, fields: HolderFields, path: Path, count: Expr) -> None:
        """Take room for numbers or texts, unless the array has this length already: then they stay.

        A message that failed behind this may have left a length without the room for it, which is taken then.
        """
        cell = fields.find(path)
        assert isinstance(cell.slot, Span)
        start, size = (self.writer.let("kept", Get("i64", cell.place(cell.slot.offset + word))) for word in (0, 8))
        with self.writer.nested() as new:
            elements = fields.open(path, count)
            fields.clear(elements.lane, elements.start, count)
        used = Used(cell.slot.lane)
        begins = Binary("and", Compare("ge", start, index(0)), Compare("ge", used, count))
        has_room = Binary("and", begins, Compare("le", start, Binary("sub", used, count)))
        self.writer.emit(If(negated(Binary("and", Compare("eq", size, count), has_room)), block(new)))
        shares.keep_texts(fields, path)

    @property
    def borrows(self) -> bool:
        """Whether bytes stay in the message."""
        return self.root.borrow

    def borrow(self, place: typed.Place, at: Expr, size: Expr, values: Evaluation) -> None:
        """Say where in the message the bytes of a field are."""
        fields, path, _ = self.descend(place, values)
        fields.put_bytes(path, at, size)

    def set_unit(self, place: typed.Place, number: int, value: int, values: Evaluation) -> None:
        """One byte, or unit of 16 bits, of a text whose length was set."""
        elements, _ = self.array(place, values)
        unit = Const("u8" if self.root.layout.lanes[elements.lane].stride == 1 else "u16", value)
        self.writer.emit(SetField(Place(elements.lane, add(elements.start, number)), unit))


def presence(fields: HolderFields, path: Path, *, outer: bool = False) -> Expr | None:
    """Whether a field is there, if it can be absent: its own bit (``outer``: also those of all around it), and the cases of unions."""
    found: Expr | None = None
    for number, name in enumerate(path):
        owner = fields.find(path[:number])
        member = member_of(owner.slot, name)
        match owner.slot:
            case Variant(offset, members):
                there = Compare("eq", Get("i64", owner.place(offset)), index(1 + members.index(member)))
            case Row() if member.presence is not None and isinstance(member.slot, Span) and fields.is_own_row(member.slot):
                there = Compare("ne", fields.stored(path[: number + 1]).size, index(0))
            case Row() if member.presence is not None and (outer or number == len(path) - 1):
                place, mask = presence_bit(owner, owner.slot, member.presence)
                there = Compare("ne", Binary("and", Get("u64", place), mask), Const("u64", 0))
            case _:
                continue
        found = there if found is None else Binary("and", found, there)
    return found


def _key(place: typed.Place) -> Key:
    return tuple(step.field.name if isinstance(step, FieldStep) else step.index for step in place.steps)


def _case_word(fields: HolderFields, path: Path) -> Place:
    """The word in which a union says which case it has."""
    cell = fields.find(path)
    assert isinstance(cell.slot, Variant)
    return cell.place(cell.slot.offset)


def _prefix(place: typed.Place, steps: int) -> typed.Place:
    return typed.Place(place.side, place.steps[:steps], place.type)


def _got(fields: HolderFields, path: Path) -> Expr:
    value = fields.get(path)
    assert value is not None
    return value


def _number(default: Constant | None) -> int | float:
    return default if isinstance(default, int | float) else 0


def chosen_case(union: Union, value: Expr, writer: Writer) -> Expr:
    """The number of the case that a value selects."""
    if isinstance(value, Const):
        return index(selected(union, int(value.value)))
    found = writer.var("case", index(0 if union.default is None else union.default + 1))
    numbers = ((label, number) for number, labels in enumerate(union.labels, 1) for label in labels)
    cases = tuple((label, (Assign(found.name, index(number)),)) for label, number in numbers)
    writer.emit(Switch(writer.let("label", integer(value)), cases, ()))
    return found
