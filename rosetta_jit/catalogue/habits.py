"""What is written by the habit of another language, and how mappings say it."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.suggestions import shorten

if TYPE_CHECKING:
    from rosetta_jit.source import Span

SIGNS = (
    ("&&", "`a and b` holds if both do"),
    ("||", "`a or b` holds if one of them does"),
    ("//", "a comment begins with `#`; whole numbers are divided by `floor_divide(a, b)`"),
    ("/*", "a comment begins with `#`, and ends with its line"),
    ("**", "a square is `x * x`"),
    ("<>", "values are unequal by `!=`"),
    ("++", "`state n = n + 1` counts messages, `index()` elements"),
)
"""Two characters, of which the one or the other is not expected, and what to write instead."""

CHARACTERS: Mapping[str, str] = MappingProxyType(
    {
        ";": "leave it out: a rule ends where the next one begins",
        "'": 'a text stands in double quotes: `"x"`',
        "?": "a choice is written `a if condition else b`",
        "!": "write `not`",
    }
)
"""Characters that the language does not have."""

STATEMENTS = (
    "import",
    "parameter",
    "state",
    "function",
    "data-holder:",
    "wire-schema:",
    "rules:",
    "unpack-rules:",
    "pack-rules:",
    "rounding:",
)
RULES = ("ignore", "default", "reject", "when", "for", "same names", "else", "end")
LENGTHS = ("length", "size", "resize", "reserve", "count")
"""What other languages call `len`."""

NUMBERED: Mapping[str, str] = MappingProxyType(
    {"limit": "a limit is a whole number of bytes: `limit: 4000000`", "edition": "the edition is a year: `edition: 2012`"}
)
"""Statements that take a number, and what they mean by it."""

BEHIND_VALUES = ("where", "if", "and", "or", "via")

WORDS: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("elif", "elsif", "elseif"), "write `else when condition`; each `when` needs an `end`, also this one"),
        **dict.fromkeys(
            ("var", "let", "const", "def"), "a value that several messages share is `state`; others are written where they are used"
        ),
        "map": "a rule begins with the place that it sets: `.a = .b`",
        "if": "rules that depend on a condition stand in a block: `when condition`, the rules, `end`",
        **dict.fromkeys(("raise", "throw", "assert", "error", "abort"), 'a message is refused by `reject "why" when condition`'),
        **dict.fromkeys(("from", "include", "using", "require"), 'a file is imported by its name: `import "x.proto"`'),
    }
)
"""Words of other languages at the beginning of a rule."""

WORDS_BEHIND_VALUES: Mapping[str, str] = MappingProxyType(
    {
        **WORDS,
        "in": "whether a value is one of several is `x == a or x == b`; whether a text has another, `contains(x, a)`",
        "is": "values are compared by `==`",
        "div": "whole numbers are divided by `floor_divide(a, b)`",
        "mod": "`modulo(a, b)` is what a division leaves",
        "as": "a number becomes one of another type by its name: `int32(x)`",
    }
)
"""Words of other languages behind a value."""

ITEMS: Mapping[str, str] = MappingProxyType(
    dict.fromkeys(("default", "else", "other", "_", "others"), 'of all other keys: `otherwise value`, or `otherwise reject "why"`')
)
"""What stands in tables of other languages for all other keys."""

FUNCTIONS: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("str", "string", "to_string", "format"), "`text(x)` is a number as a text"),
        **dict.fromkeys(("int", "integer32", "long"), "`int32(x)` and `int64(x)` are integers"),
        **dict.fromkeys(("float", "double"), "`float32(x)` and `float64(x)` are floats"),
        **dict.fromkeys(("length", "size", "sizeof", "length_of"), "`len(.a)` is how many elements or bytes there are"),
        **dict.fromkeys(("clamp", "clip"), "`max(low, min(x, high))` keeps a number between two"),
        **dict.fromkeys(("pow", "power", "square"), "a square is `x * x`"),
        **dict.fromkeys(("deg2rad", "to_radians", "to_rad", "rad"), "`radians(x)` turns degrees into radians"),
        **dict.fromkeys(("rad2deg", "to_degrees", "to_deg", "deg"), "`degrees(x)` turns radians into degrees"),
        **dict.fromkeys(("avg", "average"), "`mean(.a[])` is the mean of an array"),
        **dict.fromkeys(("concat", "concatenate"), "texts are joined by `+`"),
        **dict.fromkeys(("substr", "substring"), "`slice(x, first, after)` is a part of a text, up to before byte `after`"),
        **dict.fromkeys(("squareroot", "square_root", "root"), "did you mean `sqrt`?"),
        **dict.fromkeys(("mod", "fmod"), "`x % y` is what a division leaves; `modulo(n, m)` is from 0 to below `m`"),
        **dict.fromkeys(("trunc", "truncate", "fix"), "`int64(x, truncate)` is the integer toward 0"),
        **dict.fromkeys(("isinf", "is_nan", "is_finite"), "`isfinite(x)` is true but of NaN and infinities, `isnan(x)` of NaN alone"),
        **dict.fromkeys(("append", "push", "push_back", "insert"), "`len(.a) = n` says how many elements there are, and a rule sets each"),
        "arctan2": "did you mean `atan2`?",
        "fabs": "did you mean `abs`?",
        "norm": "`sqrt(sum(.a[] * .a[]))` is the length of a vector",
        "hypot": "`sqrt(x * x + y * y)`",
    }
)
"""Functions of other languages, and what there is for them."""

NAMES: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("True", "TRUE"), "did you mean `true`?"),
        **dict.fromkeys(("False", "FALSE"), "did you mean `false`?"),
        **dict.fromkeys(("None", "null", "NULL", "nil", "nullptr"), "what is to stay absent is left out, which `default .place` says"),
    }
)
"""Constants of other languages, and what there is for them."""


def for_function(name: str) -> str:
    """What there is instead of a function of other languages; empty where it is none."""
    return FUNCTIONS.get(name.lower(), "")


def for_name(name: str, known: Collection[str]) -> str:
    """What there is instead of a constant of other languages; empty where it is none."""
    return "" if name in known else NAMES.get(name, "")


def for_member(name: str, span: Span | None) -> str:
    """What there is instead of a member that arrays and texts have in other languages; empty where it is none."""
    return f"`len({path_before(span)})` is how many it has" if span is not None and name in ("length", "size", "len", "count") else ""


def path_before(span: Span | None) -> str:
    """The path that a step or an index goes on from, as it is written; `.a` where it cannot be told."""
    found = None if span is None else re.search(r"(\.[\w.\[\]]*\w\]?)[.\[]?$", span.source.text[max(0, span.start - 200) : span.start])
    return shorten(found[1]) if found else ".a"


def is_index(span: Span | None) -> bool:
    """Whether what is written there stands in brackets of its own, behind a path."""
    return span is not None and span.source.text[: span.start].rstrip().endswith("[")
