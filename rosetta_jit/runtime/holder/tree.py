"""From a type and its layout to the nodes of `runtime.holder.record`."""

from __future__ import annotations

from typing import assert_never, cast

from rosetta_jit.model import layout as slots
from rosetta_jit.model.initial_values import InitialValue, InitialValues, selecting
from rosetta_jit.model.layout import Layout, Slot
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Constant,
    Enum,
    Field,
    Float,
    Int,
    Map,
    Optional,
    Ref,
    Schema,
    String,
    Struct,
    Type,
    Union,
)
from rosetta_jit.runtime.cells import cell_key
from rosetta_jit.runtime.holder.record import (
    SIZE,
    Bit,
    Blob,
    Case,
    Cell,
    Child,
    Choice,
    Entry,
    Items,
    Node,
    Numbers,
    Pairs,
    Presence,
    Record,
    Scalar,
    Text,
)


class Tree:
    """The nodes of a layout. ``root`` is the message, at first ``initial``; ``recursive`` has the record of each recursive lane.

    Raises
    ------
    ValueError
        If the type is not a struct, or holds a union elsewhere than as a field.
    """

    def __init__(self, type_: Type, schema: Schema, layout: Layout) -> None:
        self.schema = schema
        self.layout = layout
        self.recursive: dict[int, Record] = {}
        self._initial = InitialValues(schema, layout)
        self.initial = self._initial.of_elements(type_, 0)
        root = self._element(type_, 0)
        if not isinstance(root, Record):
            raise ValueError("a message is a struct")  # noqa: TRY004  the type is the user's data, not a mistaken call
        self.root = root

    def _cell(self, lane: int, offset: int, scalar: str) -> Cell:
        size = SIZE[scalar]
        return Cell(cell_key(lane, scalar), self.layout.lanes[lane].stride // size, offset // size)

    def _element(self, type_: Type, lane: int) -> Node:
        """The node of the rows of a lane."""
        if lane in self.recursive:
            return self.recursive[lane]
        slot = self.layout.lanes[lane].element
        resolved = self.schema.resolve(type_)
        if isinstance(resolved, Struct):
            return self._record(resolved, slot, lane, (), recursive=self.layout.lanes[lane].links is not None)
        return self._node(resolved, slot, lane, ())

    def initial_of(self, lane: int) -> tuple[InitialValue, ...]:
        """The initial values of each row of the lane of a recursive struct."""
        return self._initial.of_elements(Ref(self.recursive[lane].struct), lane)

    def _node(self, type_: Type, slot: Slot, lane: int, touch: tuple[Presence, ...]) -> Node:
        match type_, slot:
            case Bool() | Int() | Float() | Enum(), slots.Number(offset, scalar):
                return Scalar(self._cell(lane, offset, scalar), type_)
            case String(), slots.Span(offset, target):
                return Text(self._cell(lane, offset, "i64"), target, type_)
            case Bytes(_, length, maximum), slots.Span(offset, target):
                return Blob(self._cell(lane, offset, "i64"), target, length if isinstance(length, int) else None, maximum)
            case Array(), slots.Span(offset, target):
                return self._array(type_, self._cell(lane, offset, "i64"), target)
            case Map(key, value), slots.Span(offset, target):
                return self._pairs(key, value, self._cell(lane, offset, "i64"), target)
            case Ref(), slots.Span(offset, target):
                record = cast("Record", self._element(type_, target))
                return Child(self._cell(lane, offset, "i64"), target, record, self._initial.of_elements(type_, target))
            case ((Ref() | Optional()), _):
                value = type_.value if isinstance(type_, Optional) else self.schema.types[type_.name]
                return self._node(value, slot, lane, touch)
            case Struct(), slots.Row():
                return self._record(type_, slot, lane, touch, recursive=False)
            case _:
                raise ValueError(f"{type(type_).__name__} cannot be held there")

    def _array(self, type_: Array, span: Cell, target: int) -> Node:
        resolved = self.schema.resolve(type_.element)
        if isinstance(resolved, Bool | Int | Float | Enum):
            return Numbers(span, target, resolved, type_.fixed, type_.maximum)
        element, initial = self._element(type_.element, target), self._initial.of_elements(type_.element, target)
        return Items(span, target, element, type_.fixed, type_.maximum, initial, _shape(type_.fixed, element))

    def _pairs(self, key: Type, value: Type, span: Cell, target: int) -> Pairs:
        pair = slots.map_entry(key, value)
        record = self._element(pair, target)
        assert isinstance(record, Record)
        initial = self._initial.of_elements(pair, target)
        return Pairs(span, target, record, cast("Scalar | Text", record.entries["key"].node), record.entries["value"], initial)

    def _record(self, struct: Struct, slot: Slot, lane: int, touch: tuple[Presence, ...], *, recursive: bool) -> Record:
        assert isinstance(slot, slots.Row)
        record = Record(struct.name, lane, slot.offset, _end(slot), touch)
        if slot.unknown is not None:
            record.unknown = Blob(self._cell(lane, slot.unknown.offset, "i64"), slot.unknown.lane)
        if recursive:
            self.recursive[lane] = record
        choices = self._choices(struct, slot, lane)
        for each, member in zip(struct.fields, slot.members, strict=True):
            if isinstance(each.type, Union) and isinstance(member.slot, slots.Variant):
                self._cases(record, each, member.slot, touch, choices.get(each.type.discriminator))
                continue
            initial = self._initial.of(each.type, member.slot, lane)
            presence = None
            if member.presence is not None:
                word, bit = divmod(member.presence, 64)
                presence = Bit(self._cell(lane, slot.offset + 8 * word, "u64"), 1 << bit, initial)
            node = self._entry(record, each, member.slot, touch, presence, initial)
            if isinstance(node, Scalar):
                node.choice = choices.get(each.name)
        return record

    def _choices(self, struct: Struct, slot: slots.Row, lane: int) -> dict[str, Choice]:
        """The choices of a struct by the names of their discriminators."""
        unions = {each.type.discriminator: each.type for each in struct.fields if isinstance(each.type, Union)}
        return {
            each.name: Choice(self._cell(lane, member.slot.offset, member.slot.scalar), self.schema.resolve(each.type), unions[each.name])
            for each, member in zip(struct.fields, slot.members, strict=True)
            if each.name in unions and isinstance(member.slot, slots.Number)
        }

    def _cases(self, record: Record, union: Field, slot: slots.Variant, touch: tuple[Presence, ...], choice: Choice | None) -> None:
        assert isinstance(union.type, Union)
        cell, cases = self._cell(record.lane, slot.offset, "i64"), union.type.cases
        name = union.type.name.rpartition(".")[2] if choice is None else union.name
        record.unions[name] = tuple(case.name for case in cases)
        for number, (case, member) in enumerate(zip(cases, slot.members, strict=True), 1):
            initial = self._initial.of(case.type, member.slot, record.lane)
            presence = Case(cell, number, slot.offset + 8, _end(slot), initial, choice)
            if choice is not None:
                presence.label = selecting(union.type, choice.type, number)
                choice.cases.append(presence)
            self._entry(record, case, member.slot, touch, presence)

    def _entry(
        self,
        record: Record,
        each: Field,
        slot: Slot,
        touch: tuple[Presence, ...],
        presence: Presence | None,
        initial: tuple[InitialValue, ...] = (),
    ) -> Node:
        inner = touch if presence is None else (*touch, presence)
        node = self._node(each.type, slot, record.lane, inner)
        record.entries[each.name] = Entry(each.name, node, presence, each, _default(each, node), initial if presence is None else ())
        return node


def written_within(struct: Struct, schema: Schema, name: str) -> Struct:
    """The struct of that name that is written within the fields of another, without a declaration of its own."""
    pending: list[Type] = [struct, *schema.types.values()]
    while pending:
        match pending.pop():
            case Struct() as found if found.name == name:
                return found
            case Struct(_, fields) | Union(_, fields):
                pending += [each.type for each in fields]
            case Array(inner) | Optional(inner) | Map(_, inner):
                pending.append(inner)
            case _:
                pass
    raise KeyError(name)


def _shape(length: int | None, element: Node) -> tuple[int, ...]:
    """The shape of an array of arrays of numbers, if every length is fixed."""
    match element:
        case Numbers(_, _, _, int(inner)) if length is not None:
            return (length, inner)
        case Items() if length is not None and element.shape:
            return (length, *element.shape)
        case _:
            return ()


def _default(each: Field, node: Node) -> Constant | None:
    if each.default is not None and not isinstance(node, Record | Child):
        return each.default
    match node:
        case Scalar(_, Enum(_, values, closed)):
            return values[0][1] if closed and values else 0
        case Scalar(_, type_):
            return False if isinstance(type_, Bool) else 0.0 if isinstance(type_, Float) else 0
        case Text():
            return ""
        case Blob():
            return b""
        case Numbers() | Items() | Pairs() | Record() | Child():
            return None
        case _:
            assert_never(node)


def _end(slot: Slot) -> int:
    """The offset behind a slot."""
    match slot:
        case slots.Number(offset, scalar):
            return offset + SIZE[scalar]
        case slots.Span(offset, _):
            return offset + slots.SPAN_BYTES
        case slots.Row(offset, _, _, members):
            return max([offset + slot.head_bytes, *(_end(member.slot) for member in members)])
        case slots.Variant(offset, members):
            return max([offset + 8, *(_end(member.slot) for member in members)])
        case _:
            assert_never(slot)
