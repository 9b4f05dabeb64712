"""Rules between the fields of the wire and those of the holder, which are of two types.

The walk of the codec finds the wire's fields, and the rules relate them to the holder's; where they cannot do so in place, the wire's
message is staged (`rosetta_jit.lowering.staging`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.kernel.nodes import Direction
from rosetta_jit.language.check.discriminators import Discriminator, discriminators_of
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Rule
from rosetta_jit.lowering.codec.holder_fields import HolderFields
from rosetta_jit.lowering.codec.own import lower_own
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
from rosetta_jit.model.expr import Side
from rosetta_jit.model.initial_values import InitialValues
from rosetta_jit.model.layout import Layout
from rosetta_jit.model.types import Schema, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Codec, Encoding

if TYPE_CHECKING:
    from rosetta_jit.language.check.wire_shares import Share
    from rosetta_jit.lowering import staging
    from rosetta_jit.lowering.rules import shares
else:
    shares = Late("rosetta_jit.lowering.rules.shares")
    staging = Late("rosetta_jit.lowering.staging")


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


def relation(
    mapped: Mapped, encoding: Encoding, attempts: tuple[Codec, ...], direction: Direction
) -> Callable[[HolderFields, Codec], None]:
    """What relates the holder's fields to an attempt of an encoding."""
    mapped = _in_order(mapped, mapped.holder if direction == "decode" else mapped.wire)
    in_the_way = obstacle(encoding, attempts, mapped.rules, direction, mapped.schema)
    relate = _in_place if in_the_way is None else _staged
    return lambda fields, attempt: relate(encoding, attempt, fields, mapped)


def kept_lanes(mapped: Mapped, layout: Layout) -> tuple[int, ...]:
    """The lanes whose rows stay when one of several messages fills its share of the holder."""
    return () if mapped.share is None else shares.kept_lanes(mapped.share, layout)


def _in_order(mapped: Mapped, target: Type) -> Mapped:
    """With the rules in an order in which unions can be filled."""
    root = mapped.schema.resolve(target)
    assert isinstance(root, Struct)
    unions = discriminators_of(mapped.rules, Message(root, mapped.schema))
    if not unions:
        return mapped
    from rosetta_jit.language.check.discriminator_order import discriminators_first

    return replace(mapped, rules=discriminators_first(mapped.rules, unions, []), unions=unions)


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
        lower_own(encoding, attempt, message)
        _run(mapped.rules, HolderSide(message), mapped.side(fields, mapped.holder, filled="holder"))
    else:
        _run(mapped.rules, HolderSide(fields), mapped.side(message, mapped.wire, filled="wire"))
        lower_own(encoding, attempt, message)


def _run(rules: tuple[Rule, ...], source: HolderSide, target: HolderSide) -> None:
    values = Values(source.writer, source, {})
    look_up_arrays(rules, source, values)
    Runner(source.writer, source, target).run(rules, values)
