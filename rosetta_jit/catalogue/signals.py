"""What can be wrong with signals: numbers of any width within the bytes of a frame."""

from __future__ import annotations

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.diagnostics import Diagnostic, error
from rosetta_jit.source import Span

HOW = 'write its start bit, length, byte order and sign as a DBC file does: `"7|16@0+"`'


def arguments(span: Span | None, function: str) -> Diagnostic:
    form = 'signal(.data, "7|16@0+")' if function == "signal" else 'signal_bytes(8, "7|16@0+", x, "24|8@1-", y)'
    return error("arguments", f"`{function}` does not take these values", span, help_=f"write `{form}`")


def no_field(span: Span | None, found: str) -> Diagnostic:
    if found == "bytes":
        help_ = 'relate it in each block of the `when`, to the same field: `.page <-> signal(.data, "0|8@1+")`'
        return error("no-bytes", "to pack, nothing says what the signal is that the condition asks for", span, help_=help_)
    return error("no-bytes", f"`signal` reads a field of bytes, not {found}", span, help_="name a field of bytes, or of uint8[]")


def no_signal(span: Span | None, found: str | None) -> Diagnostic:
    message = "a signal is said by a text in quotes" if found is None else f'"{shorten(found)}" is no signal'
    return error("signal", message, span, help_=HOW)


def too_long(span: Span | None, bits: int, most: int) -> Diagnostic:
    return error("signal", f"a signal has 1 to {most} bits, not {bits}", span, help_=HOW)


def beyond(span: Span | None, size: int, needed: int) -> Diagnostic:
    message = f"the signal needs {needed} bytes, and there are {size}"
    help_ = "the start bit is `byte * 8 + bit`, of the lowest bit for `@1`, of the highest bit for `@0`"
    return error("signal", message, span, help_=help_)


def overlapping(span: Span | None, one: str, other: str) -> Diagnostic:
    help_ = "relate each bit once; signals that take turns stand in the blocks of a `when`, with all others of the frame in each block"
    return error("signal", f'the signals "{shorten(one)}" and "{shorten(other)}" share a bit', span, help_=help_)


def no_size(span: Span | None, most: int) -> Diagnostic:
    return error(
        "signal", f"the size of a frame is a number from 1 to {most}", span, help_="write how many bytes it has: `signal_bytes(8, …)`"
    )


def no_integer(span: Span | None, found: str) -> Diagnostic:
    return error("integer", f"a signal is an integer, not {found}", span, f"this is {found}", help_="`int64(..., round)` makes it one")
