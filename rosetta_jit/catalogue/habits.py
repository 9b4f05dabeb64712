"""What is written by the habit of another language, and how mappings say it."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.names import shorten
from rosetta_jit.catalogue.spelling import closest

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rosetta_jit.source import Span

SIGNS = (
    ("&&", "`a and b` holds if both do"),
    ("||", "`a or b` holds if one of them does"),
    ("//", "a comment begins with `#`; whole numbers are divided by `floor_divide(a, b)`"),
    ("/*", "a comment begins with `#`, and ends with its line"),
    ("**", "a square is `x * x`"),
)
"""Two characters, of which the second is not expected, and what to write instead."""

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
BEHIND_VALUES = ("where", "if", "and", "or", "via")

FUNCTIONS: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("str", "string", "to_string", "format"), "`text(x)` is a number as a text"),
        **dict.fromkeys(("int", "integer32", "long"), "`int32(x)` and `int64(x)` are integers"),
        **dict.fromkeys(("float", "double"), "`float32(x)` and `float64(x)` are floats"),
        **dict.fromkeys(("length", "size", "sizeof", "length_of"), "`len(.a)` is how many elements or bytes there are"),
        **dict.fromkeys(("clamp", "clip"), "`max(low, min(x, high))` keeps a number between two"),
        **dict.fromkeys(("pow", "power", "square"), "a square is `x * x`"),
        **dict.fromkeys(("deg2rad", "to_radians"), "`radians(x)` turns degrees into radians"),
        **dict.fromkeys(("rad2deg", "to_degrees"), "`degrees(x)` turns radians into degrees"),
        **dict.fromkeys(("avg", "average"), "`mean(.a[])` is the mean of an array"),
        **dict.fromkeys(("concat", "concatenate"), "texts are joined by `+`"),
        **dict.fromkeys(("substr", "substring"), "`slice(x, first, size)` is a part of a text"),
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


def instead(span: Span, kind: str, expected: frozenset[str]) -> str:
    """What to write instead of a token that is not expected; empty where no habit explains it."""
    text = span.source.text
    found, pair, ahead = text[span.start : span.end], text[max(0, span.start - 1) : span.start + 1], text[span.start : span.start + 2]
    sign = next((help_ for each, help_ in SIGNS if each in (pair, ahead)), "")
    if sign or found[:1] in CHARACTERS:
        return sign or CHARACTERS[found[:1]]
    if expected & {"EQUAL", "RELATES"} and kind != "RELATES" and (found == "==" or ahead in ("->", "<-", ":=")):
        return "a place is related to a value by `<->`" if "RELATES" in expected else "a place is set by `=`"
    if kind == "EQUAL" and "FOR" in expected:
        return "values are compared by `==`; a rule sets one place by `=`"
    if found == "." and text[span.end : span.end + 1].isdigit():
        return "a digit stands before the point: `0.5`"
    if found in ("in", "=") and "FROM" in expected:
        return "a loop counts: `for i from 0 to len(.a)`"
    return _of_a_line(span, kind, expected)


def _of_a_line(span: Span, kind: str, expected: frozenset[str]) -> str:
    """The same where the line, or the one before, tells."""
    text = span.source.text
    start = text.rfind("\n", 0, span.start) + 1
    before = text[start : span.start].strip()
    line = before or text[text.rfind("\n", 0, max(0, start - 1)) + 1 : start].strip()
    if re.match(r"(if|elif|else if)\b", line) and "ELSE" in expected:
        return "rules that depend on a condition stand in a block: `when condition`, the rules, `end`"
    if before == "import" and "STRING" in expected and kind != "UNCLOSED":
        rest = text[span.start :].partition("\n")[0].strip()
        return f'write `import "{shorten(rest)}"`'
    if expected == frozenset(("COLON",)) and (word := re.search(r"([\w-]+)\s*$", text[: span.start][-200:])):
        return f"a colon is missing: `{word[1]}:`"
    if "RPAR" in expected and not before and kind in ("START", "NAME", "$END"):
        return "a bracket is not closed: `)` is missing before"
    return _misspelt(text[span.start : span.start + 40], before, expected) if kind == "NAME" else ""


def _misspelt(text: str, before: str, expected: frozenset[str]) -> str:
    """A word of the language that may be meant."""
    found = re.match(r"[A-Za-z_][\w-]*(?=(:?))", text)
    if found is None:
        return ""
    if before:
        known = BEHIND_VALUES if "STAR" in expected else ()
    else:
        known = (*(STATEMENTS if "IMPORT" in expected else ()), *(() if "FOR" not in expected or found[1] else RULES))
    word = found[0].replace("_", "-")
    near = closest(word, [each.removesuffix(":") for each in known])
    near = near or next((each.removesuffix(":") for each in known if len(word) > 3 and word in each), None)
    meant = next((each for each in known if near is not None and each.removesuffix(":") == near), None)
    return "" if meant is None else f"did you mean `{meant}`?"


def for_function(name: str) -> str:
    """What there is instead of a function of other languages; empty where it is none."""
    return FUNCTIONS.get(name.lower(), "")


def for_name(name: str, known: Collection[str]) -> str:
    """What there is instead of a constant of other languages; empty where it is none."""
    return "" if name in known else NAMES.get(name, "")


def for_member(name: str, span: Span | None) -> str:
    """What there is instead of a member that arrays and texts have in other languages; empty where it is none."""
    if span is None or name not in ("length", "size", "len", "count"):
        return ""
    found = re.search(r"\.[\w.\[\]]+$", span.source.text[max(0, span.start - 200) : span.start])
    return f"`len({shorten(found[0]) if found else '.a'})` is how many it has"
