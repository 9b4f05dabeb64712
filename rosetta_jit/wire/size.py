"""How many bytes a codec takes: always the same, or at least so many."""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.wire.codec import (
    Align,
    Blob,
    Cases,
    Choice,
    Codec,
    Computed,
    Constant,
    Count,
    Delimited,
    Maybe,
    Members,
    Number,
    Padding,
    Parameter,
    Parameters,
    Recursion,
    Repeat,
    Seq,
    Table,
    Tagged,
    Utf16,
    Varint,
)

WIDTH = {"bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "i64": 8, "u64": 8, "f32": 4, "f64": 8, "varint": 1}
"""Bytes of a scalar, at least."""


def count_width(count: Count) -> int:
    """Bytes of a count, at least."""
    return 0 if count.scalar is None else WIDTH[count.scalar]


def fixed_size(codec: Codec) -> int | None:
    """The size in bytes where it does not depend on values, else None."""
    match codec:
        case Table(_, scalar):
            return 0 if scalar is None else WIDTH[scalar]
        case Number(_, scalar) | Computed(_, scalar) | Padding(scalar):
            return WIDTH[scalar]
        case Constant(_, value, scalar, _, _):
            return len(value) if isinstance(value, bytes) else WIDTH[scalar]
        case Seq(items):
            sizes = [fixed_size(item) for item in items]
            return None if None in sizes else sum(size for size in sizes if size is not None)
        case Repeat(_, Count(value=int(number)), item, head, extra, 1) if codec.count.scalar != "varint":
            size, before = fixed_size(item), fixed_size(Seq(head))
            return None if size is None or before is None else count_width(codec.count) + before + (number - extra) * size
        case Blob(_, Count(None, _, int(number)), _, terminated):
            return number + terminated
        case (
            Varint()
            | Align()
            | Blob()
            | Repeat()
            | Choice()
            | Cases()
            | Maybe()
            | Delimited()
            | Members()
            | Parameter()
            | Parameters()
            | Utf16()
            | Tagged()
            | Recursion()
        ):
            return None
        case _:
            assert_never(codec)


def minimum_size(codec: Codec) -> int:
    """The least bytes that any value takes: what a count on the wire promises at least."""
    match codec:
        case Seq(items):
            return sum(minimum_size(item) for item in items)
        case Repeat(_, count, item, head, extra):
            elements = count.value - extra if isinstance(count.value, int) else 0
            return count_width(count) + minimum_size(Seq(head)) + elements * minimum_size(item)
        case Choice(_, scalar, alternatives):
            return WIDTH[scalar] + min(minimum_size(each) for _, each in alternatives)
        case Blob(_, count, _, terminated):
            return count_width(count) + (count.value if isinstance(count.value, int) else terminated)
        case Cases(_, discriminator):
            return minimum_size(discriminator)
        case Maybe():
            return 1
        case Delimited(_, value):
            return 4 + minimum_size(value)
        case Align():
            return 0
        case Members() | Parameter() | Parameters() | Utf16():
            return 4
        case Varint() | Recursion():
            return 1
        case Tagged(_, _, _, delimited, group):
            return int(delimited or group is not None)
        case _:
            return fixed_size(codec) or 0
