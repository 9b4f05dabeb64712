"""What can be wrong with rules that are written for both directions."""

from __future__ import annotations

from collections.abc import Sequence

from rosetta_jit.catalogue.limits import MAX_PLACES
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

OTHER_PARTS = "the text has another number of parts than the mapping reads"
HAS_SEPARATOR = "a part holds the separator of the text"
"""Why a message is refused that would come back with other parts."""


def disagrees(place: str, wanted: str) -> str:
    """Why a holder is refused that no message could have been unpacked to."""
    return f"`{shorten(place)}` is not `{shorten(wanted)}`, as the mapping says"


def no_digit(value: str, below: int) -> str:
    """Why a message or holder is refused that would come back as another: a part of a number is too large for it."""
    return f"`{shorten(value)}` is not from 0 to {below - 1}"


def other_block(condition: str, *, holds: bool) -> str:
    """Why a holder is refused whose message would be unpacked by the other block of a `when`."""
    return f"the message would be unpacked as if `{shorten(condition)}` were {'false' if holds else 'true'}"


def no_inverse(span: Span | None, why: str, rule: Span | None, place: str, how: str = "") -> Diagnostic:
    """A relation that cannot be packed; ``how`` it is written so that it can."""
    notes = (f"the relation is at {rule}",) if rule is not None and span is not None and rule != span else ()
    message = f"this cannot be turned round to pack: {why}"
    return error("no-inverse", message, span or rule, "has no inverse", notes=notes, help_=f"{how}{_by_hand([place])}")


def bit_of(value: str) -> str:
    """How a number that is 0 or 1 becomes a bool, so that it can be turned round."""
    return f"`bool({shorten(value)})` is turned round, if it is 0 or 1; or "


def all_numbers(value: str, names: Sequence[str]) -> str:
    """How all numbers that a function gives are related, of which one was."""
    each = "[]" if "[]" in value else ""
    return (
        f"`{', '.join(f'.{name}{each}' for name in names)} <-> {shorten(value)}` is turned round, with a place for each of its numbers; or "
    )


def changes(span: Span | None, function: str) -> Diagnostic:
    message = f"`{function}()` is another one when the message is packed, so that no relation can hold"
    return error("no-inverse", message, span, "changes", help_="write it in `unpack-rules:`, or in `pack-rules:`")


def several_fields(span: Span | None, places: Sequence[str], why: str = "") -> Diagnostic:
    """A relation among more fields of the wire than one, some of which nothing else sets; ``why`` as many do not say it, either."""
    listed = " and ".join(f"`{shorten(place)}`" for place in places[:MAX_PLACES])
    message = f"one rule cannot set several fields of the wire: nothing else says what {listed} are"
    notes = (f"it cannot be solved together with the other relations of these fields: {why}",) if why else ()
    help_ = f"relate all but one of them to the holder by rules of their own, or {_by_hand(places)}"
    return error("several-fields", message, span, notes=notes, help_=help_)


unknown_bound = Mistake(
    "unknown-bound",
    "to pack, nothing says how long this loop is",
    "no relation sets it",
    help="relate it to the holder: `len(.a) <-> len(.b)`",
)


def unknown_layout(span: Span | None, field: str) -> Diagnostic:
    help_ = f"relate it to the holder, or set it in `pack-rules:`: `{shorten(field)} = ...`"
    return error("unknown-layout", f"to pack, nothing says what `{shorten(field)}` is", span, "the elements lie as it says", help_=help_)


index_reads = Mistake(
    "index-reads",
    "to pack, nothing says what this index is",
    "no relation sets it",
    help="relate the field to the holder by a rule of its own, or write a rule for each direction",
)


def unknown_condition(span: Span | None, place: str, *, is_float: bool) -> Diagnostic:
    message = f"to pack, nothing says what `{shorten(place)}` is"
    notes = ("what a float must be equal to does not say which it is: -0 equals 0",) if is_float else ()
    help_ = f"relate `{shorten(place)}` to the holder, say in `pack-rules:` what it is, or write the rejection in `unpack-rules:`"
    return error("unknown-condition", message, span, "no relation sets it", notes=notes, help_=help_)


def undetermined(span: Span | None, place: str, *, holds: bool) -> Diagnostic:
    which = "where the condition holds" if holds else "where the condition does not hold"
    message = f"to pack, nothing says what `{shorten(place)}` is {which}"
    one = f"or ask for one value there, `when {shorten(place)} == 0`"
    help_ = f"relate it to the holder outside of the `when`, or in its block, {one}; or {_by_hand([place])}"
    return error("undetermined-field", message, span, "the condition reads it", help_=help_)


def unsettled_presence(span: Span | None, place: str, *, holds: bool) -> Diagnostic:
    shown = shorten(place)
    condition, found = ("holds", "does not set") if holds else ("does not hold", "may set")
    message = f"to pack, the block where the condition {condition} {found} `{shown}`"
    help_ = f"relate the holder to `{shown}`, or to something in it, in the block where it is there alone; or {_by_hand([place])}"
    if "[." in place:  # an element by its key: which others there are decides where it stands
        array, _, key = place.partition("[")
        help_ = (
            f"write this `when` in `unpack-rules:`; `pack-rules:` ask the holder, and each of their blocks says how long `{array}` is "
            f"and sets all elements of it: `len({array}) = 2`, `{array}[0]{key.partition(' ')[0]} = ...`"
        )
    return error("undetermined-field", message, span, "the condition asks whether it is there", help_=help_)


def alike_blocks(span: Span | None, place: str) -> Diagnostic:
    return error(
        "alike-blocks",
        "to pack, nothing tells which block of the `when` a holder is of",
        span,
        "the condition reads the wire",
        help_=f"relate `{shorten(place)}` to the holder outside of the `when`, relate one field of the holder to other constants in each"
        " block, set an optional field or a case of a union in one of them alone, or write the `when` in `unpack-rules:` and one in"
        " `pack-rules:`",
    )


def too_many_blocks(span: Span | None, most: int) -> Diagnostic:
    message = f"to pack, the conditions in these relations make more than {most} blocks"
    return error("too-many-ways", message, span, help_="relate what the conditions read by rules of their own, or use `when`")


too_complex = Mistake(
    "too-complex",
    "to pack, these relations are too large to be turned round",
    help="relate fields to the holder one by one, and write the rest in `unpack-rules:` and `pack-rules:`",
)


def _by_hand(places: Sequence[str]) -> str:
    """What to write where nothing can be derived."""
    rules = ", ".join(f"`{shorten(place)} = ...`" for place in places[:MAX_PLACES])
    return f"say in `pack-rules:` what the wire is to have: {rules}"
