"""What can be wrong with checksums."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, error

if TYPE_CHECKING:
    from rosetta_jit.source import Span

EXAMPLE = 'write `crc(.data, "CRC-32")`, or `crc(slice(.data, 0, 8), "CRC-16/MODBUS")`'


def arguments(span: Span | None, found: int) -> Diagnostic:
    return error(
        "arguments", f"`crc` takes bytes and the name of a code, not {found} value{'' if found == 1 else 's'}", span, help_=EXAMPLE
    )


def unknown_code(span: Span | None, found: str | None, known: tuple[str, ...]) -> Diagnostic:
    what = "the code of a checksum is written down" if found is None else f'there is no code "{found}"'
    names = ", ".join(f'"{name}"' for name in known)
    bare = "".join(filter(str.isalnum, found or "")).upper()
    meant = next((name for name in known if "".join(filter(str.isalnum, name)) == bare), None) or closest(found or "", known)
    help_ = f'did you mean "{meant}"?' if meant else EXAMPLE
    return error("checksum", what, span, "here", notes=(f"codes: {names}",), help_=help_)
