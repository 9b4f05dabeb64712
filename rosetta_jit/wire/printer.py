"""Codecs as text for a person: one node a line, what is within it indented."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.model.printer import show_expr
from rosetta_jit.wire import codec as wire

if TYPE_CHECKING:
    Leaf = (
        wire.Number
        | wire.Unsent
        | wire.Table
        | wire.Varint
        | wire.Constant
        | wire.Computed
        | wire.Padding
        | wire.Align
        | wire.Blob
        | wire.Utf16
        | wire.Recursion
    )


def show_encoding(encoding: wire.Encoding) -> str:
    """What is tried in turn when reading, what is written, and the messages of recursive structs."""
    lines = [f"encoding {encoding.name}"]
    for number, attempt in enumerate(encoding.attempts, 1):
        lines += [f"attempt {number}", *_lines(attempt, 1)]
    if encoding.written is not None and encoding.written not in encoding.attempts:
        lines += ["written", *_lines(encoding.written, 1)]
    if encoding.ending is not None:
        aligned = f", written up to a multiple of {encoding.ending.align} bytes" if encoding.ending.align > 1 else ""
        lines.append(f"padding at the end, as much as the last two bits of byte {encoding.ending.size_byte} say{aligned}")
        if encoding.ending.unstated > 1:
            lines.append(f"or zeros up to a multiple of {encoding.ending.unstated} bytes that they do not tell")
    for messages in (encoding.recursive, *encoding.nested[:1]):
        for name, each in messages.items():
            lines += [f"message {name}", *_lines(each, 1)]
    return "\n".join(lines) + "\n"


def _lines(codec: wire.Codec, depth: int) -> Iterator[str]:
    indent = "  " * depth
    match codec:
        case wire.Seq(items):
            for item in items:
                yield from _lines(item, depth)
        case wire.Repeat(path, count, item, head, extra, align):
            aligned = f" aligned to {align}" if align > 1 else ""
            yield f"{indent}{_path(path)}: {_count(count)} elements{aligned}" + (f", {extra} fields among them:" if extra else ", each:")
            for each in (*head, item):
                yield from _lines(each, depth + 1)
        case wire.Choice() | wire.Cases():
            yield from _alternatives(codec, depth)
        case wire.Maybe(path, value):
            yield f"{indent}{_path(path)}: u8 that says whether it follows"
            yield from _lines(value, depth + 1)
        case wire.Delimited(path, value, order):
            yield f"{indent}{_path(path)}: {_scalar('u32', order)} bytes of"
            yield from _lines(value, depth + 1)
        case wire.Members(path, members, order):
            yield f"{indent}{_path(path)}: {_scalar('u32', order)} bytes of members"
            yield from _members(members, depth + 1)
        case wire.Parameter(member):
            yield from _members((member,), depth)
        case wire.Parameters(path, members):
            yield f"{indent}{_path(path)}: parameters up to a sentinel"
            yield from _members(members, depth + 1)
        case wire.Tagged(path, entries, required, delimited, group):
            kind = "delimited message" if delimited else "message" if group is None else f"group {group}"
            yield f"{indent}{_path(path)}: {kind}" + (f", required: {', '.join(required)}" if required else "")
            for entry in entries:
                yield from _entry(entry, depth + 1)
        case _:
            yield indent + _leaf(codec)


def _alternatives(codec: wire.Choice | wire.Cases, depth: int) -> Iterator[str]:
    """What follows a number that says which of several it is."""
    indent = "  " * depth
    match codec:
        case wire.Choice(path, scalar, alternatives, _, order, labels, tried):
            yield f"{indent}{_scalar(scalar, order)} that says the form of {_path(path)}"
            for number, (value, each) in enumerate(alternatives):
                why = ", which has been tried" if number < tried else f", written for {labels[number]}" if number < len(labels) else ""
                yield f"{indent}{value}{why}:"
                yield from _lines(each, depth + 1)
        case wire.Cases(path, discriminator, cases, default):
            yield from _lines(discriminator, depth)
            for number, (labels, each) in enumerate(cases):
                words = [*map(str, labels), *(["any other"] if number == default else [])]
                yield f"{indent}{', '.join(words)}, of {_path(path)}:"
                yield from _lines(each, depth + 1)


def _members(members: tuple[wire.Member, ...], depth: int) -> Iterator[str]:
    for member in members:
        yield f"{'  ' * depth}{member.number}{' optional' if member.optional else ''} {_path(member.path)}"
        yield from _lines(member.value, depth + 1)


def _leaf(codec: Leaf) -> str:
    match codec:
        case wire.Number(path, scalar, order):
            return f"{_path(path)}: {_scalar(scalar, order)}"
        case wire.Unsent(path):
            return f"{_path(path)}: 0, without a byte"
        case wire.Table(path, scalar, pairs, order):
            if scalar is None:
                return f"{_path(path)}: {pairs[0][1]}, without a byte"
            return f"{_path(path)}: {_scalar(scalar, order)}, {', '.join(f'{stored} for {value}' for stored, value in pairs)}"
        case wire.Varint(path, zigzag):
            return f"{_path(path)}: {'zigzag ' if zigzag else ''}varint"
        case wire.Constant(path, value, scalar, order, kind):
            text = repr(value) if isinstance(value, bytes) else f"{_scalar(scalar, order)} {value}"
            return f"{kind} {text}" + (f" ({_path(path)})" if path else "")
        case wire.Computed(path, scalar, value, order):
            return f"{_path(path)}: {_scalar(scalar, order)} = {show_expr(value)}"
        case wire.Padding(scalar, value, order):
            return f"padding {_scalar(scalar, order)} {value}"
        case wire.Align(size):
            return f"padding to a multiple of {size} bytes"
        case wire.Blob(path, count, text, terminated):
            return f"{_path(path)}: {_count(count)} bytes{' of text' if text else ''}{' and NUL' if terminated else ''}"
        case wire.Utf16(path, count):
            return f"{_path(path)}: {_count(count)} bytes of UTF-16"
        case wire.Recursion(path, struct, _):
            return f"{_path(path)}: message {struct}"
        case _:
            assert_never(codec)


def _entry(entry: wire.Entry, depth: int) -> Iterator[str]:
    label = entry.label if not entry.implicit else "implicit"
    yield f"{'  ' * depth}{entry.number} {label} {_path(entry.path)}"
    yield from _lines(entry.value, depth + 1)


def _path(path: wire.Path) -> str:
    return "".join(f".{name}" for name in path) or "element"


def _scalar(scalar: str, order: wire.Order) -> str:
    return scalar if order == "<" else f"big-endian {scalar}"


def _count(count: wire.Count) -> str:
    bound = "" if count.maximum is None else f" at most {count.maximum}"
    bound += "" if count.unit == 1 else f" {count.unit} each"
    if count.scalar is None:
        return f"{count.value if isinstance(count.value, int) else show_expr(count.value) if count.value else ''}{bound}"
    match count.value:
        case None:
            return f"{_scalar(count.scalar, count.order)} count of{bound}"
        case int(value):
            return f"{_scalar(count.scalar, count.order)} {value} for"
        case value:
            return f"{_scalar(count.scalar, count.order)} count (= {show_expr(value)}) of"
