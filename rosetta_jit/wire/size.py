"""How many bytes a codec takes: always the same, or at least so many."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.wire import codec as wire

WIDTH = {"bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "i64": 8, "u64": 8, "f32": 4, "f64": 8, "varint": 1}
"""Bytes of a scalar, at least."""


def count_width(count: wire.Count) -> int:
    """Bytes of a count, at least."""
    return 0 if count.scalar is None else WIDTH[count.scalar]


def fixed_size(codec: wire.Codec) -> int | None:
    """The size in bytes where it does not depend on values, else None."""
    match codec:
        case wire.Table(_, scalar):
            return 0 if scalar is None else WIDTH[scalar]
        case wire.Number(_, scalar) | wire.Computed(_, scalar) | wire.Padding(scalar):
            return WIDTH[scalar]
        case wire.Unsent():
            return 0
        case wire.Constant(_, value, scalar, _, _):
            return len(value) if isinstance(value, bytes) else WIDTH[scalar]
        case wire.Seq(items):
            sizes = [fixed_size(item) for item in items]
            return None if None in sizes else sum(size for size in sizes if size is not None)
        case wire.Repeat(_, wire.Count(value=int(number)), item, head, extra, 1) if codec.count.scalar != "varint":
            size, before = fixed_size(item), fixed_size(wire.Seq(head))
            return None if size is None or before is None else count_width(codec.count) + before + (number - extra) * size
        case wire.Blob(_, wire.Count(None, _, int(number)), _, terminated):
            return number + terminated
        case (
            wire.Varint()
            | wire.Align()
            | wire.Blob()
            | wire.Repeat()
            | wire.Choice()
            | wire.Cases()
            | wire.Maybe()
            | wire.Delimited()
            | wire.Members()
            | wire.Parameter()
            | wire.Parameters()
            | wire.Utf16()
            | wire.Tagged()
            | wire.Recursion()
        ):
            return None
        case _:
            assert_never(codec)


def minimum_size(codec: wire.Codec) -> int:
    """The least bytes that any value takes: what a count on the wire promises at least."""
    match codec:
        case wire.Seq(items):
            return sum(minimum_size(item) for item in items)
        case wire.Repeat(_, count, item, head, extra):
            elements = count.value - extra if isinstance(count.value, int) else 0
            return count_width(count) + minimum_size(wire.Seq(head)) + elements * minimum_size(item)
        case wire.Choice(_, scalar, alternatives):
            return WIDTH[scalar] + min(minimum_size(each) for _, each in alternatives)
        case wire.Blob(_, count, _, terminated):
            return count_width(count) + (count.value if isinstance(count.value, int) else terminated)
        case wire.Cases(_, discriminator):
            return minimum_size(discriminator)
        case wire.Maybe():
            return 1
        case wire.Delimited(_, value):
            return 4 + minimum_size(value)
        case wire.Align():
            return 0
        case wire.Members() | wire.Parameter() | wire.Parameters() | wire.Utf16():
            return 4
        case wire.Varint() | wire.Recursion():
            return 1
        case wire.Tagged(_, _, _, delimited, group):
            return int(delimited or group is not None)
        case _:
            return fixed_size(codec) or 0
