"""What can be wrong with rules that are written for both directions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue.mapping import error, shorten

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.source import Span


def disagrees(place: str, wanted: str) -> str:
    """Why a holder is refused that no message could have been unpacked to."""
    return f"`{shorten(place)}` is not `{shorten(wanted)}`, as the mapping says"


def no_inverse(span: Span | None, why: str, rule: Span | None) -> Diagnostic:
    """A relation that cannot be packed."""
    notes = (f"the relation is at {rule}",) if rule is not None and span is not None and rule != span else ()
    help_ = "write one rule in `unpack-rules:` and one in `pack-rules:`"
    return error("no-inverse", f"this cannot be turned round to pack: {why}", span or rule, "has no inverse", notes=notes, help_=help_)


def changes(span: Span | None, function: str) -> Diagnostic:
    """A relation to what is another value each time."""
    message = f"`{function}()` is another one when the message is packed, so that no relation can hold"
    return error("no-inverse", message, span, "changes", help_="write it in `unpack-rules:`, or in `pack-rules:`")


def several_fields(span: Span | None) -> Diagnostic:
    """A relation among more fields of the wire than one, some of which nothing else sets."""
    help_ = "relate each field of the wire to the holder by a rule of its own"
    return error("several-fields", "one rule cannot set several fields of the wire", span, help_=help_)


def unknown_bound(span: Span | None) -> Diagnostic:
    """A loop to a field of the wire that no relation knows."""
    return error(
        "unknown-bound",
        "to pack, nothing says how long this loop is",
        span,
        "no relation sets it",
        help_="relate it to the holder: `len(.a) <-> len(.b)`",
    )


def index_reads(span: Span | None) -> Diagnostic:
    """An index that depends on a field, in a rule for both directions."""
    help_ = "use loop variables and numbers, or write a rule for each direction"
    return error("index-reads", "an index of a rule for both directions cannot read fields", span, help_=help_)
