"""From an encoding to a kernel: once for each direction, by the same walk.

Without rules, the fields of the wire are the fields of the holder. With rules, the walk finds the wire's fields, and the rules
relate them to the holder's; where they cannot do so in place, the wire's message is staged (`rosetta_jit.lowering.staging`). Each attempt
of an encoding becomes a body of the kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Capacity, Compare, Direction, Fill, Return
from rosetta_jit.kernel.nodes import Place as KernelPlace
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index
from rosetta_jit.language.check.discriminators import Discriminator, discriminators_of
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Rule
from rosetta_jit.lowering.codec.ending import end, length_first
from rosetta_jit.lowering.codec.holder_fields import HolderFields, root_fields
from rosetta_jit.lowering.codec.walk import walk
from rosetta_jit.lowering.codec.wire_fields import Found, WireFields
from rosetta_jit.lowering.rules.holder_side import HolderSide
from rosetta_jit.lowering.rules.in_place import obstacle
from rosetta_jit.lowering.rules.initial_values import initialise, opened_lanes
from rosetta_jit.lowering.rules.packed_values import AssignedByRules, look_up_arrays
from rosetta_jit.lowering.rules.state import begin
from rosetta_jit.lowering.rules.statements import Runner
from rosetta_jit.lowering.rules.values import Values
from rosetta_jit.lowering.rules.wire_side import WireSide
from rosetta_jit.lowering.writer import References, Where, Writer, block
from rosetta_jit.model.expr import Side
from rosetta_jit.model.initial_values import InitialValues
from rosetta_jit.model.layout import Layout
from rosetta_jit.model.types import Schema, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Codec, Encoding, Tagged

if TYPE_CHECKING:
    from rosetta_jit.language.check.wire_shares import Share
    from rosetta_jit.lowering import staging
    from rosetta_jit.lowering.rules import shares

    Relate = Callable[[HolderFields, Codec], None]
else:
    shares = Late("rosetta_jit.lowering.rules.shares")
    staging = Late("rosetta_jit.lowering.staging")

SCRATCH_STRIDE = 8


def lower(
    encoding: Encoding,
    layout: Layout,
    direction: Direction,
    *,
    name: str,
    mapped: Mapped | None = None,
    borrow: bool = False,
    references: References | None = None,
) -> Kernel:
    """The kernel that reads or writes messages of an encoding, or computes their size.

    Parameters
    ----------
    mapped
        How the holder differs from the wire; None where it is of the wire's own type.
    borrow
        Bytes fields of the holder refer to the message instead of being copied.
    references
        How they refer to it: see `rosetta_jit.lowering.writer.References`. By the sign of their spans if None.
    """
    registers, share = (0, None) if mapped is None else (mapped.registers, mapped.share)
    kept = () if share is None else shares.kept_lanes(share, layout)
    lowering = _Lowering(encoding, layout, direction, borrow, references, registers, kept)
    if mapped is None:
        return lowering.kernel(name, lambda fields, attempt: _own(encoding, attempt, fields))
    mapped = _in_order(mapped, mapped.holder if direction == "decode" else mapped.wire)
    in_the_way = obstacle(encoding, lowering.attempts, mapped.rules, direction, mapped.schema)
    relate = _in_place if in_the_way is None else _staged
    return lowering.kernel(name, lambda fields, attempt: relate(encoding, attempt, fields, mapped))


@dataclass(frozen=True, slots=True)
class Mapped:
    """The rules of a mapping for one direction, how the wire's own type would lie in a holder, and how many registers keep its state."""

    rules: tuple[Rule, ...]
    schema: Schema
    holder: Type
    wire: Type
    wire_layout: Layout
    unions: Mapping[tuple[str, ...], Discriminator] = field(default_factory=dict[tuple[str, ...], "Discriminator"])
    registers: int = 0
    share: Share | None = None

    def side(self, fields: HolderFields, type_: Type, *, filled: Side | None) -> HolderSide:
        """A message in lanes; where rules fill it, with its initial values."""
        if filled is None:
            return HolderSide(fields)
        initial, cell = InitialValues(self.schema, fields.layout), fields.cell
        opened = opened_lanes(self.rules, fields.layout, cell.slot, filled)
        of_message = initial.of(type_, cell.slot, cell.lane)
        if self.share is None or filled == "wire":
            initialise(fields, of_message, cell.row, opened)
            return HolderSide(fields, initial, opened, self.unions)
        shares.clear(fields, self.share)
        initialise(fields, shares.initial_of(self.share, of_message, fields.layout), cell.row, opened)
        for names in shares.fixed_arrays(self.share, fields.layout, opened):
            shares.keep_texts(fields, names)
        return HolderSide(fields, initial, opened, self.unions, joined=self.share.joined)


def _in_order(mapped: Mapped, target: Type) -> Mapped:
    """With the rules in an order in which unions can be filled."""
    root = mapped.schema.resolve(target)
    assert isinstance(root, Struct)
    unions = discriminators_of(mapped.rules, Message(root, mapped.schema))
    if not unions:
        return mapped
    from rosetta_jit.language.check.discriminator_order import discriminators_first

    return replace(mapped, rules=discriminators_first(mapped.rules, unions, []), unions=unions)


@dataclass(frozen=True, slots=True)
class _Lowering:
    """What is lowered, whatever relates the message to the holder; ``registers`` and ``kept`` are as of a `Kernel`."""

    encoding: Encoding
    layout: Layout
    direction: Direction
    borrow: bool
    references: References | None = None
    registers: int = 0
    kept: tuple[int, ...] = ()

    @property
    def attempts(self) -> tuple[Codec, ...]:
        """The codecs of which each becomes a body."""
        attempts = self.encoding.attempts if self.direction == "decode" else (self.encoding.written,)
        return tuple(attempt for attempt in attempts if attempt is not None)

    def kernel(self, name: str, relate: Relate) -> Kernel:
        writer = Writer(self.direction, [*(lane.stride for lane in self.layout.lanes), SCRATCH_STRIDE], references=self.references)
        own = len(writer.strides)
        bodies = [self.body(writer, attempt, relate) for attempt in self.attempts]
        expected = self.encoding.expected if self.direction == "decode" else 0
        bodies[:expected] = [length_first(writer, body) for body in bodies[:expected]]
        strides, routines = tuple(writer.strides), tuple(writer.routines.values())
        sites, hidden = tuple(writer.sites), len(strides) - own
        return Kernel(name, self.direction, strides, tuple(bodies), sites, routines, hidden, self.registers, self.kept)

    def body(self, writer: Writer, attempt: Codec, relate: Relate) -> Block:
        writer.registers = {}
        with writer.nested() as body:
            writer.position = BEGIN if writer.direction != "size" else index(0)
            writer.origin = add(writer.position, self.encoding.origin)
            fields = root_fields(writer, self.layout, borrow=self.borrow)
            writer.expect(Compare("lt", ROW, Capacity(0)), "index", Where(), "the holder has no row for the message")
            if writer.direction == "decode" and not self.kept:
                writer.emit(Fill(KernelPlace(0, ROW), index(self.layout.lanes[0].stride)))
            relate(fields, attempt)
            end(writer, self.encoding)
            writer.emit(Return(writer.position, tuple(sorted(writer.registers.items(), key=lambda each: each[0]))))
        return block(body)


def _own(encoding: Encoding, attempt: Codec, holder: HolderFields) -> None:
    """The holder is of the wire's own type. There are four ways to lower it, and what one of them needs is imported for it alone."""
    writer = holder.writer
    if encoding.nested:
        from rosetta_jit.lowering.codec.descent import descend

        descend(_nested(encoding, attempt), attempt, holder, writer)
    elif not isinstance(attempt, Tagged):
        with writer.whole():
            walk(attempt, holder, writer)
    elif writer.direction == "decode":
        from rosetta_jit.lowering.codec.recursion import cursors, read_rows
        from rosetta_jit.lowering.codec.tagged import read_message

        rows = cursors(writer, holder.layout)
        read_message(writer, holder, attempt, END, fresh=True, depth=index(0))
        read_rows(encoding, holder, writer, rows)
    else:
        from rosetta_jit.lowering.codec.recursion_write import write_root

        write_root(encoding, holder, attempt, writer)


def _nested(encoding: Encoding, attempt: Codec) -> Mapping[str, Codec]:
    """The codecs of recursive structs in the messages of an attempt."""
    number = next((number for number, each in enumerate(encoding.attempts) if each is attempt), 0)
    return encoding.nested[number]


def _in_place(_: Encoding, attempt: Codec, fields: HolderFields, mapped: Mapped) -> None:
    """Decode: find the wire's fields, then run the rules. Otherwise: lay out the message, then fill in the elements."""
    writer, rules = fields.writer, mapped.rules
    begin(writer, rules)
    found, decodes = Found(), writer.direction == "decode"
    holder = mapped.side(fields, mapped.holder, filled="holder" if decodes else None)
    if decodes:
        wire = WireSide(writer, WireFields(writer, found))
        with writer.whole():
            walk(attempt, wire.root, writer)
        end = writer.position
        Runner(writer, wire, holder).run(rules, Values(writer, wire, {}))
        writer.position = end
        return
    values = Values(writer, holder, {})
    look_up_arrays(rules, holder, values)
    wire = WireSide(writer, WireFields(writer, found, AssignedByRules(rules, holder, values)))
    walk(attempt, wire.root, writer)
    if writer.direction == "encode":
        Runner(writer, holder, wire).run(rules, values)


def _staged(encoding: Encoding, attempt: Codec, fields: HolderFields, mapped: Mapped) -> None:
    """Decode the message into lanes of its own type, then run the rules; or run them, then encode what they made."""
    writer = fields.writer
    begin(writer, mapped.rules)
    message = staging.staged_fields(writer, fields.layout, mapped.wire_layout)
    if writer.direction == "decode":
        _own(encoding, attempt, message)
        _run(mapped.rules, HolderSide(message), mapped.side(fields, mapped.holder, filled="holder"))
    else:
        _run(mapped.rules, HolderSide(fields), mapped.side(message, mapped.wire, filled="wire"))
        _own(encoding, attempt, message)


def _run(rules: tuple[Rule, ...], source: HolderSide, target: HolderSide) -> None:
    values = Values(source.writer, source, {})
    look_up_arrays(rules, source, values)
    Runner(source.writer, source, target).run(rules, values)
