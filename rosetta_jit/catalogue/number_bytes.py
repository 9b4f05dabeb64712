"""What can be wrong with numbers within bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span


def arguments(span: Span | None, function: str, found: int) -> Diagnostic:
    form = "byte(number, n)" if function == "byte" else f"{function}(bytes, place)` or `{function}(bytes, place, big_endian)"
    message = f"`{function}` does not take {found} value{'' if found == 1 else 's'}"
    return error("arguments", message, span, help_=f"write `{form}`")


def no_field(span: Span | None, function: str, found: str) -> Diagnostic:
    return error("no-bytes", f"`{function}` reads a field of bytes, not {found}", span, help_="name a field of bytes, or of uint8[]")


def no_integer(span: Span | None, found: str) -> Diagnostic:
    return error(
        "integer", f"bytes are counted in integers, not {found}", span, f"this is {found}", help_="`int64(..., round)` makes it one"
    )


def no_number(span: Span | None, found: str) -> Diagnostic:
    return error("operand", f"`byte` takes a number, not {found}", span, f"this is {found}", help_="bytes of texts are `.text[i]`")


def byte_range(span: Span | None, size: int) -> Diagnostic:
    return error("index-range", f"the number has {size} bytes, from 0", span, help_=f"write 0 to {size - 1}; 0 is the lowest")
