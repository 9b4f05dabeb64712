"""Code that reads fields of messages: what `rosetta_jit.runtime.holder.access` does, in LLVM.

A field of a holder whose decode failed raises, as in Python. Where a span lies is checked against its lane each time: whatever a kernel
has left in a row, or another one since, nothing outside the holder is read.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.core.imputils import impl_ret_borrowed
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, overload_method
from numba.np.arrayobj import populate_array

from rosetta_jit.backends.llvm.values import I8, I64, LLVM_TYPES, POINTER, constant, state_word
from rosetta_jit.errors import InvalidHolder
from rosetta_jit.in_numba.types import NUMBERS, MapType, MessageType, SequenceType, type_of
from rosetta_jit.kernel.state import ADDRESS, CAPACITY, VALID, lane_word
from rosetta_jit.runtime.cells import SCALARS
from rosetta_jit.runtime.holder.record import (
    Bit,
    Blob,
    Case,
    Cell,
    Child,
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

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.cgutils import StructProxy
    from numba.core.typing.templates import Signature
    from numba.extending import Implementation


INVALID = "the last decode into this holder failed: decode again before you read it"
BROKEN = "the element that was here is gone"
ABSENT = "a message that contains its own type is absent here: ask `has` before you read it"


def cell_type(cell: Cell) -> ir.Type:
    """The type of a scalar in memory."""
    scalar = SCALARS[cell.key & 15]
    return I8 if scalar == "bool" else LLVM_TYPES[scalar]


class Reader:
    """What prints code that reads parts of one value, a message or a sequence."""

    def __init__(self, context: BaseContext, builder: ir.IRBuilder, type_: MessageType | SequenceType | MapType, value: ir.Value) -> None:
        self.context, self.builder, self.type = context, builder, type_
        self.value = cgutils.create_struct_proxy(type_)(context, builder, value=value)
        self.state = builder.bitcast(self.value.state, POINTER)

    def check_valid(self) -> None:
        """Raise where the last decode failed."""
        self.refuse_if(self.builder.icmp_signed("==", self.word(VALID), constant(0)), INVALID)

    def refuse_if(self, wrong: ir.Value, why: str, error: type[Exception] = InvalidHolder) -> None:
        """Raise where something is wrong."""
        with cgutils.if_unlikely(self.builder, wrong):
            self.context.call_conv.return_user_exc(self.builder, error, (why,))

    def word(self, index: int) -> ir.Value:
        """A word of the state."""
        return self.builder.load(state_word(self.builder, self.state, index), typ=I64, align=8)

    def cell(self, cell: Cell, row: ir.Value, further: int = 0) -> ir.Value:
        """A scalar of a row, as it lies in memory."""
        return self.builder.load(self.cell_address(cell, row, further), typ=cell_type(cell))

    def cell_address(self, cell: Cell, row: ir.Value, further: int = 0) -> ir.Value:
        """Where a scalar of a row lies."""
        base = self.builder.load(state_word(self.builder, self.state, lane_word(cell.lane, ADDRESS)), typ=POINTER, align=8)
        index = self.builder.add(self.builder.mul(row, constant(cell.step)), constant(cell.index + further))
        return self.builder.gep(base, [index], source_etype=cell_type(cell))

    def number(self, cell: Cell, row: ir.Value) -> ir.Value:
        """A scalar of a row, as a value of numba's."""
        value = self.cell(cell, row)
        if SCALARS[cell.key & 15] != "bool":
            return value
        return self.context.cast(self.builder, value, types.uint8, types.boolean)

    def is_present(self, presence: Presence, row: ir.Value) -> ir.Value:
        """Whether a field is there."""
        match presence:
            case Bit(cell, mask):
                bits = self.builder.and_(self.cell(cell, row), ir.Constant(I64, mask))
                return self.builder.icmp_unsigned("!=", bits, constant(0))
            case Case(cell, number):
                return self.builder.icmp_signed("==", self.cell(cell, row), constant(number))

    def span(self, cell: Cell, lane: int, row: ir.Value, there: ir.Value | None = None) -> tuple[ir.Value, ir.Value]:
        """Start and count of elements, which are all in the lane; none where they are not there."""
        start, count = self.cell(cell, row), self.cell(cell, row, 1)
        if there is not None:
            start, count = (self.builder.select(there, each, constant(0)) for each in (start, count))
        room = self.word(lane_word(lane, CAPACITY))
        inside = self.builder.icmp_unsigned("<=", count, room)
        before = self.builder.icmp_unsigned("<=", start, self.builder.sub(room, count))
        self.refuse_if(self.builder.not_(self.builder.and_(inside, before)), BROKEN)
        return start, count

    def array(self, type_: types.Array, lane: int, start: ir.Value, count: ir.Value) -> ir.Value:
        """Elements of a lane of numbers as an array, which keeps the holder's memory alive."""
        data_type = self.context.get_data_type(type_.dtype)
        size = self.context.get_abi_sizeof(data_type)
        base = self.builder.load(state_word(self.builder, self.state, lane_word(lane, ADDRESS)), typ=POINTER, align=8)
        first = self.builder.gep(base, [self.builder.mul(start, constant(size))], source_etype=I8)
        made = self.context.make_array(type_)(self.context, self.builder)
        populate_array(
            made,
            data=self.builder.bitcast(first, data_type.as_pointer()),
            shape=[count],
            strides=[constant(size)],
            itemsize=constant(size),
            meminfo=self.value.meminfo,
        )
        return impl_ret_borrowed(self.context, self.builder, type_, made._getvalue())  # noqa: SLF001 - numba's way to its value

    def other(self, type_: types.Type, **words: ir.Value) -> ir.Value:
        """Another message or sequence of the same holder."""
        made: StructProxy = cgutils.create_struct_proxy(type_)(self.context, self.builder)
        for name in ("meminfo", "taken", "state"):
            setattr(made, name, getattr(self.value, name))
        for name, value in words.items():
            setattr(made, name, value)
        return impl_ret_borrowed(self.context, self.builder, type_, made._getvalue())  # noqa: SLF001 - as above

    def node(self, node: Node, row: ir.Value, there: ir.Value | None = None) -> ir.Value:
        """What a node of a row is read as; ``there`` where it may be absent and its memory another field's."""
        family = self.type.family
        type_ = type_of(family, node)
        match node:
            case Scalar(cell):
                return self.number(cell, row)
            case Text(cell, lane) | Blob(cell, lane) | Numbers(cell, lane):
                return self.array(cast("types.Array", type_), lane, *self.span(cell, lane, row, there))
            case Items(cell, lane) | Pairs(cell, lane):
                start, count = self.span(cell, lane, row, there)
                return self.other(type_, start=start, count=count)
            case Record():
                return self.other(cast("MessageType", type_), row=row)
            case Child(cell, lane):
                start, count = self.span(cell, lane, row, there)
                self.refuse_if(self.builder.icmp_signed("==", count, constant(0)), ABSENT)
                return self.other(cast("MessageType", type_), row=start)

    def entry(self, entry: Entry, row: ir.Value) -> ir.Value:
        """What a field is read as: its default where it is absent."""
        if entry.presence is None or (isinstance(entry.presence, Bit) and not entry.default):
            return self.node(entry.node, row)
        there = self.is_present(entry.presence, row)
        value = self.node(entry.node, row, there)
        if not isinstance(entry.node, Scalar):
            return value
        default = self.context.get_constant(NUMBERS[SCALARS[entry.node.cell.key & 15]], entry.default)
        return self.builder.select(there, value, default)


@infer_getattr
class _Fields(AttributeTemplate):
    """The types of fields."""

    key = MessageType

    def generic_resolve(self, type_: MessageType, name: str) -> types.Type | None:
        entry = type_.record.entries.get(name)
        if entry is None:
            return None
        return type_of(type_.family, entry.node)


@lower_getattr_generic(MessageType)
def _read(context: BaseContext, builder: ir.IRBuilder, type_: MessageType, value: ir.Value, name: str) -> ir.Value:
    reader = Reader(context, builder, type_, value)
    reader.check_valid()
    return reader.entry(type_.record.entries[name], reader.value.row)


@overload_method(MessageType, "has", prefer_literal=True)
def _has(message: MessageType, name: types.Type) -> Callable[..., object] | None:
    """Whether a field is present, by its name, which is written down where it is asked."""
    if not isinstance(name, types.StringLiteral):
        raise TypingError("`has` takes the name of a field as a literal, in compiled code")
    entry = message.record.entries.get(name.literal_value)
    if entry is None:
        raise TypingError(f"`{message.record.struct}` has no field {name.literal_value!r}")
    is_present = _presence_of(entry)

    def has(message: MessageType, name: types.Type) -> object:  # noqa: ARG001  the name has been looked up; numba compares parameters
        return is_present(message)

    return has


def _presence_of(entry: Entry) -> Callable[..., object]:
    @intrinsic
    def is_present(typing: object, message: types.Type) -> Implementation:  # noqa: ARG001 - numba passes it
        def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
            reader = Reader(context, builder, cast("MessageType", signature.args[0]), arguments[0])
            reader.check_valid()
            return ir.Constant(ir.IntType(1), 1) if entry.presence is None else reader.is_present(entry.presence, reader.value.row)

        return types.boolean(message), codegen

    return is_present
