"""Members of mutable structs that did not come: the value that the schema or their type gives them (DDS-XTypes 1.3, 7.2.4.4.8, table 9).

Such a value takes memory and no bytes of the message, so that little is given: a message must not cost much more than it has bytes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel.ir import Const, For, Local
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.codec.fields import scalar_name
from rosetta_jit.lowering.writer import block
from rosetta_jit.wire.codec import (
    Align,
    Blob,
    Cases,
    Choice,
    Codec,
    Computed,
    Constant,
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

if TYPE_CHECKING:
    from rosetta_jit.lowering.codec.fields import Elements, Fields
    from rosetta_jit.lowering.writer import Writer


def give(codec: Codec, fields: Fields, writer: Writer) -> None:
    """Set what a codec describes to the values that it has where it did not come."""
    match codec:
        case Number(path, scalar):
            fields.put(path, Const(scalar_name(scalar), bool(codec.absent) if scalar == "bool" else codec.absent))
        case Table(path):
            fields.put(path, index(int(codec.absent)))
        case Blob(path):
            octet = Number((), "u8")
            _give_elements(codec, fields.open(path, index(_length(codec))), octet, writer)
        case Repeat(path, _, item):
            _give_elements(codec, fields.open(path, index(_length(codec))), item, writer)
        case Cases(path, discriminator, cases):
            give(discriminator, fields, writer)
            number = _selected(codec)
            fields.choose(path, number)
            if number:
                give(cases[number - 1][1], fields, writer)
        case _:
            for each in _parts(codec):
                give(each, fields, writer)


def elements_given(codec: Codec) -> int:
    """How many elements of arrays there are in what a codec describes, where it did not come."""
    match codec:
        case Blob():
            return _length(codec)
        case Repeat(_, _, item):
            return _length(codec) * (1 + elements_given(item))
        case Cases(_, _, cases):
            number = _selected(codec)
            return elements_given(cases[number - 1][1]) if number else 0
        case Number() | Table():
            return 0
        case _:
            return sum(map(elements_given, _parts(codec)))


def _parts(codec: Codec) -> tuple[Codec, ...]:
    """The codecs of the values in what is none itself, but for those that are optional."""
    match codec:
        case Seq(items):
            return items
        case Delimited(_, value):
            return (value,)
        case Members(_, members) | Parameters(_, members):
            return tuple(each.value for each in members if not each.optional)
        case Parameter(member):
            return () if member.optional else (member.value,)
        case Align() | Padding() | Constant() | Computed() | Maybe():
            return ()
        case Number() | Table() | Blob() | Repeat() | Cases() | Varint() | Utf16() | Choice() | Tagged() | Recursion():
            raise AssertionError(codec)  # values themselves, and what no mutable struct has within it
        case _:
            assert_never(codec)


def _length(codec: Blob | Repeat) -> int:
    return codec.count.value if isinstance(codec.count.value, int) else len(codec.absent)


def _give_elements(codec: Blob | Repeat, elements: Elements, item: Codec, writer: Writer) -> None:
    """Those that the schema gives, in a text or bytes; others are as elements that did not come."""
    known = tuple(codec.absent)[: _length(codec)]
    for number, value in enumerate(known):
        give(replace(_unit(item), absent=value), elements.at(index(number)), writer)
    if len(known) < _length(codec):
        number = Local("i64", writer.fresh("i"))
        with writer.nested() as body:
            give(item, elements.at(add(number, len(known))), writer)
        writer.emit(For(number.name, index(_length(codec) - len(known)), block(body)))


def _unit(item: Codec) -> Number:
    """The number that a unit of a text is."""
    return next(each for each in (item.items if isinstance(item, Seq) else (item,)) if isinstance(each, Number))


def _selected(cases: Cases) -> int:
    """The number of the case that the discriminator's value selects, from 1 on; 0 for none."""
    value = _number(cases.discriminator)
    for number, (labels, _) in enumerate(cases.cases, 1):
        if value in labels:
            return number
    return 0 if cases.default is None else cases.default + 1


def _number(codec: Codec) -> float:
    match codec:
        case Number() | Table():
            return codec.absent
        case Seq(items):
            return _number(items[-1])
        case Parameter(member):
            return _number(member.value)
        case _:
            raise AssertionError(codec)
