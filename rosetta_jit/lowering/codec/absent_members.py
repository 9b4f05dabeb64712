"""Members of mutable structs that did not come: the value that the schema or their type gives them (DDS-XTypes 1.3, 7.2.4.4.8, table 9).

Such a value takes memory and no bytes of the message, so that little is given: a message must not cost much more than it has bytes.
"""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.kernel.nodes import Const, For, Local
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.codec.fields import Elements, Fields, scalar_name
from rosetta_jit.lowering.writer import Writer, block
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.wire import codec as wire


def give(codec: wire.Codec, fields: Fields, writer: Writer) -> None:
    """Set what a codec describes to the values that it has where it did not come."""
    match codec:
        case wire.Number(path, scalar):
            fields.put(path, Const(scalar_name(scalar), bool(codec.absent) if scalar == "bool" else codec.absent))
        case wire.Table(path):
            fields.put(path, index(int(codec.absent)))
        case wire.Blob(path):
            octet = wire.Number((), "u8")
            _give_elements(codec, fields.open(path, index(_length(codec))), octet, writer)
        case wire.Repeat(path, _, item):
            _give_elements(codec, fields.open(path, index(_length(codec))), item, writer)
        case wire.Cases(path, discriminator, cases):
            give(discriminator, fields, writer)
            number = _selected(codec)
            fields.choose(path, number)
            if number:
                give(cases[number - 1][1], fields, writer)
        case _:
            for each in _parts(codec):
                give(each, fields, writer)


def elements_given(codec: wire.Codec) -> int:
    """How many elements of arrays there are in what a codec describes, where it did not come."""
    match codec:
        case wire.Blob():
            return _length(codec)
        case wire.Repeat(_, _, item):
            return _length(codec) * (1 + elements_given(item))
        case wire.Cases(_, _, cases):
            number = _selected(codec)
            return elements_given(cases[number - 1][1]) if number else 0
        case wire.Number() | wire.Table():
            return 0
        case _:
            return sum(map(elements_given, _parts(codec)))


def _parts(codec: wire.Codec) -> tuple[wire.Codec, ...]:
    """The codecs of the values in what is none itself, but for those that are optional."""
    match codec:
        case wire.Seq(items):
            return items
        case wire.Delimited(_, value):
            return (value,)
        case wire.Members(_, members) | wire.Parameters(_, members):
            return tuple(each.value for each in members if not each.optional)
        case wire.Parameter(member):
            return () if member.optional else (member.value,)
        case wire.Align() | wire.Padding() | wire.Constant() | wire.Computed() | wire.Maybe():
            return ()
        case (
            wire.Number()
            | wire.Unsent()
            | wire.Table()
            | wire.Blob()
            | wire.Repeat()
            | wire.Cases()
            | wire.Varint()
            | wire.Utf16()
            | wire.Choice()
            | wire.Tagged()
            | wire.Recursion()
        ):
            raise AssertionError(codec)  # values themselves, and what no mutable struct has within it
        case _:
            assert_never(codec)


def _length(codec: wire.Blob | wire.Repeat) -> int:
    return codec.count.value if isinstance(codec.count.value, int) else len(codec.absent)


def _give_elements(codec: wire.Blob | wire.Repeat, elements: Elements, item: wire.Codec, writer: Writer) -> None:
    """Those that the schema gives, in a text or bytes; others are as elements that did not come."""
    known = tuple(codec.absent)[: _length(codec)]
    for number, value in enumerate(known):
        give(replace(_unit(item), absent=value), elements.at(index(number)), writer)
    if len(known) < _length(codec):
        number = Local("i64", writer.fresh("i"))
        with writer.nested() as body:
            give(item, elements.at(add(number, len(known))), writer)
        writer.emit(For(number.name, index(_length(codec) - len(known)), block(body)))


def _unit(item: wire.Codec) -> wire.Number:
    """The number that a unit of a text is."""
    return next(each for each in (item.items if isinstance(item, wire.Seq) else (item,)) if isinstance(each, wire.Number))


def _selected(cases: wire.Cases) -> int:
    """The number of the case that the discriminator's value selects, from 1 on; 0 for none."""
    value = _number(cases.discriminator)
    for number, (labels, _) in enumerate(cases.cases, 1):
        if value in labels:
            return number
    return 0 if cases.default is None else cases.default + 1


def _number(codec: wire.Codec) -> float:
    match codec:
        case wire.Number() | wire.Table():
            return codec.absent
        case wire.Seq(items):
            return _number(items[-1])
        case wire.Parameter(member):
            return _number(member.value)
        case _:
            raise AssertionError(codec)
