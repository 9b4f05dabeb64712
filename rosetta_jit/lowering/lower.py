"""From an encoding to a kernel: once for each direction, by the same walk.

Without rules, the fields of the wire are the fields of the holder (`rosetta_jit.lowering.codec.own`); with rules, these relate them
(`rosetta_jit.lowering.mapped`). Each attempt of an encoding becomes a body of the kernel.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Capacity, Compare, Direction, Fill, Return
from rosetta_jit.kernel.nodes import Place as KernelPlace
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index
from rosetta_jit.lowering.codec.ending import end, length_first
from rosetta_jit.lowering.codec.holder_fields import HolderFields, root_fields
from rosetta_jit.lowering.codec.own import lower_own
from rosetta_jit.lowering.writer import References, Where, Writer, block
from rosetta_jit.model.layout import Layout
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.late import Late
from rosetta_jit.wire.codec import Codec, Encoding

if TYPE_CHECKING:
    from rosetta_jit.lowering import mapped as rules
    from rosetta_jit.lowering.mapped import Mapped

    Relate = Callable[[HolderFields, Codec], None]
else:
    rules = Late("rosetta_jit.lowering.mapped")

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
    texts_stay: bool = False,
    rows_in_order: bool = False,
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
    texts_stay
        Texts of tagged messages do so, too.
    rows_in_order
        Rows of recursive structs that are written belong to one message each, whose own row, if it has one, lies before them.
    """
    registers, kept = (0, ()) if mapped is None else (mapped.registers, rules.kept_lanes(mapped, layout))
    lowering = _Lowering(encoding, layout, direction, borrow, references, registers, kept, texts_stay, rows_in_order)
    if mapped is None:
        return lowering.kernel(name, lambda fields, attempt: lower_own(encoding, attempt, fields))
    return lowering.kernel(name, rules.relation(mapped, encoding, lowering.attempts, direction))


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
    texts_stay: bool = False
    rows_in_order: bool = False

    @property
    def attempts(self) -> tuple[Codec, ...]:
        """The codecs of which each becomes a body."""
        attempts = self.encoding.attempts if self.direction == "decode" else (self.encoding.written,)
        return tuple(attempt for attempt in attempts if attempt is not None)

    def kernel(self, name: str, relate: Relate) -> Kernel:
        lanes = [*(lane.stride for lane in self.layout.lanes), SCRATCH_STRIDE]
        writer = Writer(self.direction, lanes, references=self.references, texts_stay=self.texts_stay)
        writer.rows_in_order = self.rows_in_order
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
