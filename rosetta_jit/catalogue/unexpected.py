"""What to write instead of a token that the grammar does not have there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import habits
from rosetta_jit.catalogue.suggestions import closest, shorten
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.source import Span


STARTS_VALUE = frozenset({"START", "NAME", "QUALIFIED", "INTEGER", "REAL", "STRING", "LPAR", "LSQB"})
COMPARISONS = frozenset({"==", "!=", "<", "<=", ">", ">="})
OPERATORS = frozenset("+-*/%")
BRACKETS = {"RPAR": ")", "RSQB": "]", "RBRACE": "}"}


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a token stands that is not expected.

    Attributes
    ----------
    found, ahead
        The token, and its line from there on.
    before
        What stands before it in its line, without blanks at its ends.
    touches
        What stands before it without a blank between.
    line
        What stands before it in its line, or else the line before.
    """

    span: Span
    kind: str
    expected: frozenset[str]
    found: str
    ahead: str
    before: str
    touches: str
    line: str

    @property
    def is_behind_value(self) -> bool:
        """Whether an operator may stand here."""
        return "STAR" in self.expected


def instead(span: Span, kind: str, expected: frozenset[str]) -> str:
    """What to write instead of a token that is not expected; empty where nothing explains it."""
    place = _place(span, kind, expected)
    found = (_of_character(place), *(each(place) for each in (_of_sign, _of_bracket, _of_number, _of_statement, _of_line, _of_word)))
    return next((each for each in found if each), "")


def _place(span: Span, kind: str, expected: frozenset[str]) -> _Place:
    text = span.source.text
    start = text.rfind("\n", 0, span.start) + 1
    before = text[start : span.start]
    last = text[text.rfind("\n", 0, max(0, start - 1)) + 1 : start].strip()
    ahead = text[span.start :].partition("\n")[0]
    return _Place(span, kind, expected, text[span.start : span.end], ahead, before.strip(), before[-1:].strip(), before.strip() or last)


def _of_character(place: _Place) -> str:
    """Of characters that are not plain: the one that is not expected, or the one behind a dot."""
    return plain(place.ahead[:1]) or (plain(place.ahead[1:2]) if place.found == "." else "")


def _of_sign(place: _Place) -> str:
    found, ahead, expected = place.found, place.ahead, place.expected
    pair = place.touches + ahead[:1]
    sign = next((help_ for each, help_ in habits.SIGNS if ahead.startswith(each) or each == pair), "")
    if sign or found[:1] in habits.CHARACTERS:
        return sign or habits.CHARACTERS[found[:1]]
    if ("RBRACE" in expected or re.search(r"\{[^}]*$", place.before)) and (found == ":" or pair == "=>"):
        return 'a key and its value stand so: `"key" = value`'
    if expected & {"EQUAL", "RELATES"} and place.kind != "RELATES" and (found == "==" or ahead[:2] in ("->", "<-", ":=", "<=", "=>")):
        return "a place is related to a value by `<->`" if "RELATES" in expected else "a place is set by `=`"
    if place.kind == "EQUAL" and "FOR" in expected:
        return "values are compared by `==`; a rule sets one place by `=`"
    if expected & {"EQUAL", "RELATES"} and ahead[:2] in ("+=", "-=", "*=", "/="):
        return "a place is set once for a message; what earlier messages left is `state`"
    if found in OPERATORS and expected & {"EQUAL", "RELATES"}:
        return f"left of `{'<->' if 'RELATES' in expected else '='}` stands a place alone: compute on the right"
    if found == "," and "FOR" in expected and not ahead[1:2].isdigit() and re.search(r"(<->|(?<![=<>!])=(?!=))[^=]*$", place.before):
        return "several values stand in a list, `.x, .y = [1.0, 2.0]`; a field is related to a field by a rule of its own"
    if found in COMPARISONS and "FOR" in expected:
        return "comparisons do not chain: `a < x and x < b`"
    return ""


def _of_number(place: _Place) -> str:
    """Of what stands behind a digit, or before one."""
    found, ahead = place.found, place.ahead
    if found == "." and ahead[1:2].isdigit():
        return "a digit stands before the point: `0.5`"
    if not re.search(r"(?<![\w.])(0[xX])?[0-9.]+$", place.before):
        return ""
    if found == "." and place.touches:
        return "a digit stands behind the point: `1.0`"
    if found == "," and ahead[1:2].isdigit():
        return "decimals stand behind a point: `1.5`"
    if place.before.startswith("limit"):
        return habits.NUMBERED["limit"]
    if place.kind == "NAME" and place.touches:
        together = re.match(r"[_0-9]+\b", found)
        return "the digits of a number stand together: `1000`" if together else "a number ends with its digits: `float32(1.0)`, `int64(10)`"
    return ""


def _of_bracket(place: _Place) -> str:
    found, ahead, expected, before = place.found, place.ahead, place.expected, place.before
    open_ = next((each for kind, each in BRACKETS.items() if kind in expected), "")
    if open_ and not before and place.kind in ("START", "NAME", "IGNORE", "DEFAULT", "REJECT", "FOR", "WHEN", "LEN", "_SAME", "$END"):
        return f"a bracket is not closed: `{open_}` is missing before"
    if open_ and "COMMA" in expected and place.kind in STARTS_VALUE and not habits.ITEMS.get(found):
        return "a comma is missing before it"
    if found in BRACKETS.values() and "FOR" in expected and before:
        return f"no bracket is open that `{found}` closes: leave it out"
    if found in BRACKETS.values() and before.endswith(","):
        return "leave out the comma before it"
    if "RSQB" in expected and (found == ":" or ahead.startswith("..")):
        return "`.a[0 to 3]` are the first three elements"
    if "RSQB" in expected and found == "=" and (key := re.search(r"\[\s*([A-Za-z_]\w*)$", before)):
        return f"a field begins with a dot: `.{shorten(key[1])}`"
    if found == "(" and (called := re.search(r"(?<!\w)(\.[\w.]+)\.([A-Za-z_]\w*)$", before)):
        return f"what a function takes stands in its brackets: `{called[2]}({shorten(called[1])})`"
    if found == "[" and before.endswith(")"):
        return '`part(x, "/", 0)` is the first part of a text; of other arrays, only fields have elements'
    if place.kind in ("NAME", "UNCLOSED") and place.touches == '"':
        return 'a quote within a text is written with a backslash: `"a\\"b"`'
    if place.kind == "STRING" and place.touches == "f":
        return 'texts are joined by `+`: `"joint " + text(.n)`'
    return ""


def _of_statement(place: _Place) -> str:
    """What the statement or rule tells in which the token stands."""
    found, expected, before = place.found, place.expected, place.before
    if "END" in expected and place.kind in ("$END", "RULES", "UNPACK_RULES", "PACK_RULES"):
        return unclosed(place.span.source.text, place.span.start)
    if found in ("in", "=") and "FROM" in expected:
        return "a loop counts: `for i from 0 to len(.a)`"
    if re.match(r"(if|elif|else if)\b", place.line) and "ELSE" in expected:
        return "rules that depend on a condition stand in a block: `when condition`, the rules, `end`"
    if re.search(r"\bif\b", place.line) and "ELSE" in expected and place.kind != "NAME":
        return "a choice has two values, `a if condition else b`; a rule that is left out otherwise stands in a `when`"
    if found in ("*", ".") and (word := re.match(r"(ignore|default)\s*(\.[\w.]*)?", before)):
        return f"`{word[1]} {shorten(word[2])}` is said of all of it" if word[2] else f"`{word[1]} rest` is said of all others"
    if found == "," and re.match(r"(ignore|default)\b", before):
        return f"each field has its own: `{before} {before.split()[0]} .b`"
    if before.startswith("reject") and (found == "if" or ("STRING" in expected and found == "when")):
        return '`reject "why" when condition`'
    if "STRING" in expected and place.kind != "UNCLOSED" and (word := re.search(r"(?<![\w.])(import|via)$", before)):
        return f'write `{word[1]} "{shorten(place.ahead.strip().strip("<>;"))}"`'
    if not before and place.kind in ("IF", "FROM") and found in habits.WORDS:
        return habits.WORDS[found]
    if place.kind == "START" and "IMPORT" in expected and "FOR" not in expected:
        return "rules stand behind `rules:`, or behind `unpack-rules:` or `pack-rules:`"
    if (head := re.match(r"(limit|edition)\s*:", place.before + place.ahead)) is not None:
        return habits.NUMBERED[head[1]]
    if found == "state" and "IMPORT" in expected:
        return "a state variable has a type: `state n: int64 = 0`"
    return _of_colon(place) if expected == frozenset(("COLON",)) or place.ahead.startswith("[") else ""


def _of_line(place: _Place) -> str:
    """What the line tells in which the token stands, or the one before."""
    found, before = place.found, place.before
    if found == "if" and before == "else":
        return "`else when condition`; each `when` has an `end`"
    rule = place.line + (found if place.kind == "$END" and place.touches else "")
    if "EQUAL" in place.expected and (called := re.search(r"=\s*([a-z]\w*)\s+(\.[\w.]+)$", rule)):
        return f"what a function takes stands in brackets: `{called[1]}({shorten(called[2])})`"
    if not before and (declared := re.match(r"(state \w+: (\w+)|parameter \w+: list)$", place.line)):
        return _of_declaration(declared[1], declared[2])
    return ""


def _of_declaration(declared: str, type_: str | None) -> str:
    """What a state variable or a parameter lacks at the end of its line."""
    if type_ is None:
        return f"a list says of what it is: `{declared} of float64`"
    first = {"bool": "false", "float32": "0.0", "float64": "0.0"}.get(type_, "0")
    return f"it has a first value: `{declared} = {first}`"


def _of_colon(place: _Place) -> str:
    if place.found == "[" and place.before.endswith("list"):
        return "a list says of what it is: `list of float64`"
    if "COLON" not in place.expected:
        return ""
    if (declared := re.match(r"(parameter|state)\s+(\w+)$", place.before)) is not None:
        return f"it has a type: `{declared[1]} {shorten(declared[2])}: float64{' = 0.0' if declared[1] == 'state' else ''}`"
    if (typed := re.match(r"(data-holder|wire-schema)\s+(\S+)$", place.before + place.ahead.strip())) is not None and place.before:
        return f"a colon is missing: `{typed[1]}: {shorten(typed[2])}`"
    word = re.search(r"([\w-]+)\s*$", place.span.source.text[: place.span.start][-200:])
    return f"a colon is missing: `{word[1]}:`" if word else ""


def _of_word(place: _Place) -> str:
    """A word of another language, or one of ours that is misspelt."""
    if place.found in habits.ITEMS and ("RBRACE" in place.expected or re.search(r"\{[^}]*$", place.before)):
        return habits.ITEMS[place.found]
    if "RSQB" in place.expected and place.found == "for":
        return "a rule with `[]` holds for each element: `.a[] = f(.b[])`"
    if place.kind != "NAME":
        return ""
    if place.found in habits.LENGTHS and "FOR" in place.expected and place.ahead[len(place.found) :].startswith("("):
        return "a length is set by `len`: `len(.a)`"
    known = habits.WORDS_BEHIND_VALUES if place.is_behind_value and place.before else habits.WORDS
    return known.get(place.found, "") or _misspelt(place)


def _misspelt(place: _Place) -> str:
    found = re.match(r"[A-Za-z_][\w-]*(?=(:?))", place.ahead[:40])
    if found is None:
        return ""
    if place.before:
        known = habits.BEHIND_VALUES if place.is_behind_value else ()
    else:
        rules = () if "FOR" not in place.expected or found[1] else habits.RULES
        known = (*(habits.STATEMENTS if "IMPORT" in place.expected else ()), *rules)
    word = found[0].replace("_", "-")
    near = closest(word, [each.removesuffix(":") for each in known])
    near = near or next((each.removesuffix(":") for each in known if len(word) > 3 and word in each), None)
    meant = next((each for each in known if near is not None and each.removesuffix(":") == near), None)
    return "" if meant is None else f"did you mean `{meant}`?"


TOKEN = re.compile(r'"(?:\\.|[^"\\\n])*"|#[^\n]*|\.?[A-Za-z_][\w-]*')
"""A text, a comment, a field, or a word: what may hold the words of blocks without being one."""


def unclosed(text: str, stop: int) -> str:
    """What to say of the block that is open at a place of a text."""
    open_: list[tuple[str, int]] = []
    last = ("", "")
    for found in TOKEN.finditer(text, 0, stop):
        word = found[0]
        if word.startswith("#"):
            continue
        if word in ("for", "when") and last[1] != "reject" and not (last[0] == "reject" and last[1].startswith('"')):
            open_.append((word, found.start()))
        elif word == "end" and open_:
            open_.pop()
        last = last[1], word
    if not open_:
        return "every `for` and every `when` needs an `end`"
    word, start = open_[-1]
    before = text[text.rfind("\n", 0, start) + 1 : start].strip()
    said = f"the `{word}` of line {text.count(chr(10), 0, start) + 1} has no `end`"
    if word == "when" and before == "else":
        return f"{said}: each `when` needs one, also behind `else`"
    if word == "when" and before:
        return f"{said}: it begins a block, for the rules behind it; elements are chosen by `where`"
    return said


PLAIN: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys("\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019\u201a\u2033", '"'),
        **dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2015\u2212", "-"),
        **dict.fromkeys("\u00d7\u00b7\u22c5\u2217\u2219", "*"),
        **dict.fromkeys("\u00f7\u2215\u2044", "/"),
        **dict.fromkeys("\u2194\u21d4\u27f7", "<->"),
        **dict.fromkeys("\u2190\u2254", "="),
        "\u2264": "<=",
        "\u2265": ">=",
        "\u2260": "!=",
        "\u2227": "and",
        "\u2228": "or",
        "\u00ac": "not",
        "\u03c0": "pi",
    }
)
"""A character, and how the language writes it."""

ROOTS_AND_POWERS: Mapping[str, str] = MappingProxyType(
    {
        "\u00b2": "a square is `x * x`",
        "\u00b3": "a cube is `x * x * x`",
        "\u221a": "a root is `sqrt(x)`",
        "\u00b0": "`radians(x)` turns degrees into radians",
        "\u2026": "three dots stand for nothing: write what they leave out",
        "\u2208": "whether a value is one of several is `x == a or x == b`",
    }
)
"""Characters that stand for more than a character."""

UNSEEN = ("Cf", "Cc", "Zl", "Zp")
"""Categories of characters that are not seen."""


def plain(character: str) -> str:
    """How to write a character that the language does not have; empty where nothing is known of it."""
    if character.isascii():
        return ""
    from unicodedata import category, name, normalize  # whoever writes plain characters does not import it

    if character in ROOTS_AND_POWERS:
        return ROOTS_AND_POWERS[character]
    code = f"U+{ord(character):04X}" + (f" {called}" if (called := name(character, "")) else "")
    if category(character) == "Zs":
        return f"this is {code}: write a plain blank"
    if category(character) in UNSEEN:
        return f"this is {code}, which is not seen: delete it"
    known = PLAIN.get(character) or normalize("NFKC", character)
    return f"write the plain character{'s' * (len(known) > 1)} `{known}`" if known.isascii() and known.isprintable() else ""
