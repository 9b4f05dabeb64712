"""What can be wrong with the rules of a mapping taken together: fields not set, set twice, elements left out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.diagnostics import Diagnostic, Mistake, error, warning
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

BEYOND = "indices count from 0 and stay below the length: correct the index, or the length"


if TYPE_CHECKING:
    Block = Literal["rules", "unpack-rules", "pack-rules", ""]
    """Where a missing rule is to be written; empty where the mapping has blocks for one direction alone, and it goes without saying."""


def never_set(span: Span | None, side: str, path: str, declared: Span | None, *, kind: str, block: Block) -> Diagnostic:
    place = path.replace("[]", "[i]")
    if block == "rules":
        relation, word = (f"... <-> {place}", "ignore") if side == "wire" else (f"{place} <-> ...", "default")
        meant = f", or say that it is meant: `{word} {path}`" if side == "wire" or ("[" not in path and kind != "array") else ""
        hint = f"relate it to a field: `{relation}`{meant}"
    else:
        empty = f", or say that it is empty: `len({place}) = 0`" if kind == "array" else ""
        meant = f", or say that it is meant: `default {path}`" if "[" not in path and kind != "array" else ""
        hint = f"add a rule{_under(block)}: `{place} = ...`{empty}{meant}"
    notes = (f"declared at {declared}",) if declared else ()
    return error("never-set", f"`{path}` of the {side} is never set", span, notes=notes, help_=hint)


def set_twice(span: Span | None, path: str, first: Span | None) -> Diagnostic:
    notes = (f"set before at {first}",) if first else ()
    return error("set-twice", f"`{path}` is set twice", span, "again here", notes=notes, help_="remove one of the rules")


def set_in_loop(span: Span | None, path: str, variable: str) -> Diagnostic:
    return error(
        "set-in-loop",
        f"`{path}` is set again in each round of the loop over `{variable}`",
        span,
        help_=f"index it with `{variable}`, or move the rule out of the loop",
    )


def cases(span: Span | None, path: str, first: str, second: str) -> Diagnostic:
    return error("set-twice", f"`{path}` can hold `{first}` or `{second}`, not both", span, help_="remove one of the rules")


def other_case(span: Span | None, path: str, case: str, labels: tuple[int, int]) -> Diagnostic:
    """A discriminator that selects another case than the one that is set; ``labels`` are what it says, and what it would without a rule."""
    actual, label = labels
    hint = f"leave the rule out: without one, it is {label}"
    return error("other-case", f"`{path}` is {actual}, which does not select `{case}`", span, f"`{case}` is set", help_=hint)


def late_discriminator(span: Span | None, path: str) -> Diagnostic:
    return error("other-case", f"`{path}` is set after cases that it selects", span, help_="set it beside the case")


def many_labels(span: Span | None, most: int) -> Diagnostic:
    return error("too-complex", f"discriminators are computed that select by more than {most} labels", span, help_="use constants")


def constant(span: Span | None, path: str, value: str) -> Diagnostic:
    return error(
        "constant-field",
        f"the schema fixes `{path}`{f' as {value}' if value else ''}",
        span,
        "another value",
        help_="remove the rule; the constant is written without one",
    )


uneven_rounds = Mistake(
    "uneven-rounds",
    "the blocks of a `when` in this loop do not set the same places",
    help="set the same fields of the same element in each block, or put the `when` around the loop",
)


def too_many_ways(span: Span | None, most: int) -> Diagnostic:
    message = f"there are more than {most} ways through these rules"
    return error("too-many-ways", message, span, help_="choose among values: `x if c else y`")


def in_one_way(problem: Diagnostic) -> Diagnostic:
    return replace(problem, notes=(*problem.notes, "in one way through the `when` blocks, not in all: an `else` may be missing"))


def never_read(span: Span | None, side: str, path: str, block: Block) -> Diagnostic:
    word = "default" if block == "rules" and side == "holder" else "ignore"
    return warning("never-read", f"no rule reads `{path}`: its value is lost", span, help_=_meant(word, path, block))


def left_out(span: Span | None, side: str, path: str, block: Block) -> Diagnostic:
    word = "ignore" if block == "rules" and side == "wire" else "default"
    return warning("left-out", f"no rule sets `{path}`", span, help_=_meant(word, path, block))


def _meant(word: str, path: str, block: Block) -> str:
    return f"say{_under(block) if block != 'rules' else ''} that it is meant: `{word} {path}`"


def _under(block: Block) -> str:
    return f" under `{block}:`" if block else ""


def other_length(span: Span | None, array: str, other: str) -> Diagnostic:
    return warning(
        "other-length",
        f"`{array}` is read as far as `{other}` is long, and nothing says that both have one length",
        span,
        f"the loop goes to len({other})",
        help_=f'write `reject "..." when len({array}) != len({other})`, or let the loop go to `len({array})`',
    )


def length_without_elements(span: Span | None, path: str) -> Diagnostic:
    return error(
        "elements-never-set",
        f"the length of `{path}` is set, its elements are not",
        span,
        help_=f"add rules for the elements: `{path}[i] = ...`",
    )


def elements_without_length(span: Span | None, path: str, side: str, block: Block) -> Diagnostic:
    both = f"`len({path}) <-> 3`" if side == "holder" else f'`reject "..." when len({path}) != 3`'
    hint = f"say how many there are, in `rules:` for both directions: {both}" if block == "rules" else f"add `len({path}) = ...`"
    return error(
        "length-never-set",
        f"elements of `{path}` are set, its length is not",
        span,
        help_=hint,
    )


def overlap(span: Span | None, path: str, first: Span | None) -> Diagnostic:
    notes = (f"set before at {first}",) if first else ()
    return error("overlap", f"elements of `{path}` are set twice", span, "again here", notes=notes, help_="remove one of the rules")


def element_missing(span: Span | None, path: str, first: int, last: int) -> Diagnostic:
    which = f"`{path}[{first}]` is" if first == last else f"`{path}[{first}]` to `{path}[{last}]` are"
    return error("coverage", f"{which} never set", span, "the length says that they exist", help_="set them, or correct the length")


def element_beyond(span: Span | None, path: str, index: int, length: int) -> Diagnostic:
    return error("index-range", f"`{path}[{index}]` is beyond the length {length}", span, "out of range", help_=BEYOND)


def coverage(span: Span | None, path: str, length: str, shown: tuple[str, ...]) -> Diagnostic:
    return error(
        "coverage",
        f"it cannot be shown that the rules set all elements of `{path}`, each once",
        span,
        f"to show: 0 to {shorten(length)}",
        notes=tuple(f"shown: {shorten(part)}" for part in shown),
        help_="let loops from 0 run over the index without gaps, and use the expressions of the length:"
        " `(y * width + x) * 3 + c` for y to height, x to width, c to 3",
    )


def loop_of_other_length(span: Span | None, path: str, length: str, found: str) -> Diagnostic:
    return error(
        "coverage",
        f"the rules set `{shorten(found)}` elements of `{path}`, but its length is `{shorten(length)}`",
        span,
        "to another length",
        help_="use one expression for the length and for the end of the loop; where two must agree, reject the rest",
    )


def not_affine(span: Span | None, path: str) -> Diagnostic:
    return error(
        "coverage",
        f"it cannot be shown which elements of `{path}` this rule sets",
        span,
        "the index",
        help_="use loop variables in sums and products alone: `(y * width + x) * 3 + c`",
    )


too_complex = Mistake("too-complex", "the expression is too large to be checked", help="simplify it")


def case_twice(span: Span | None) -> Diagnostic:
    message = "an earlier case asks the same: this one is never chosen"
    return warning("unreachable", message, span, "again here", help_="remove one of them, or correct it")
