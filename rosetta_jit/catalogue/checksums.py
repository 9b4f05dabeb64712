"""What can be wrong with checksums."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span

EXAMPLE = 'write `crc(.data, "CRC-32")`, or `crc(slice(.data, 0, 8), "CRC-16/MODBUS")`'


def arguments(span: Span | None, found: int) -> Diagnostic:
    """Too many or too few arguments."""
    return error(
        "arguments", f"`crc` takes bytes and the name of a code, not {found} value{'' if found == 1 else 's'}", span, help_=EXAMPLE
    )


def unknown_code(span: Span | None, found: str | None, known: tuple[str, ...]) -> Diagnostic:
    """A code that nobody knows, or one that is computed."""
    what = "the code of a checksum is written down" if found is None else f'there is no code "{found}"'
    names = ", ".join(f'"{name}"' for name in known)
    return error("checksum", what, span, "here", notes=(f"codes: {names}",), help_=EXAMPLE)
