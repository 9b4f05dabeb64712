"""The first word of a declaration: a builtin type or a message, perhaps an array of it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.tree import TypeName

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.ros.dialect import Dialect
    from rosetta_jit.frameworks.ros.sections import Section
    from rosetta_jit.frameworks.ros.tree import Word

TYPE = re.compile(r"(?P<base>[^\[\]<]+)(?P<bound><=(?P<text>[^\[\]]*))?(?P<array>\[(?P<most><=)?(?P<length>[^\[\]]*)\])?")
LENGTH = re.compile(r"[0-9]{1,12}")
LARGEST_LENGTH = (1 << 32) - 1
"""Counts have 32 bits on the wire."""


def type_name(word: Word, section: Section, dialect: Dialect, problems: list[Diagnostic]) -> TypeName | None:
    """What a word of a section means as a type; None, and a problem, if nothing."""
    match = TYPE.fullmatch(word.text)
    if match is None or not _may_have_bounds(match, dialect):
        problems.append(say.not_a_type(word.span, word.text))
        return None
    base = _base(match["base"], word.text, section, dialect)
    if base is None:
        problems.append(say.not_a_type_name(word.span, match["base"], dialect.packages.words, dialect.messages.words))
        return None
    numbers = {part: _length(match[part]) for part in ("text", "length") if match[part]}
    least = {"text": 1, "length": 1 if dialect.extended else 0}
    if any(number is None or number < least[part] for part, number in numbers.items()) or match["text"] == "" or _empty_bound(match):
        problems.append(say.not_a_length(word.span, min(least[part] for part in numbers or least)))
        return None
    length = numbers.get("length")
    return TypeName(
        word.text,
        base,
        word.span,
        builtin=base in dialect.scalars or base in dialect.structs,
        array=match["array"] is not None,
        length=None if match["most"] else length,
        maximum=length if match["most"] else None,
        text_maximum=numbers.get("text"),
    )


def _base(word: str, written: str, section: Section, dialect: Dialect) -> str | None:
    """The builtin word itself, or the qualified name of a message."""
    if word in dialect.scalars or word in dialect.structs:
        return word
    if written in dialect.aliases:
        return dialect.aliases[written]
    if word in section.local:
        return section.local[word]
    package, *folders, short = word.split("/") if "/" in word else (section.package, word)
    folder = folders[0] if len(folders) == 1 else "msg"
    known = len(folders) < 2 and folder in ("msg", *dialect.interfaces) and (dialect.packages.allows(package) or "/" not in word)
    return dialect.message(package, short, folder) if known and dialect.messages.allows(short) else None


def _may_have_bounds(match: re.Match[str], dialect: Dialect) -> bool:
    """Whether it has bounds only where types have some."""
    return dialect.extended and match["base"] in ("string", "wstring") if match["bound"] else dialect.extended or not match["most"]


def _length(text: str) -> int | None:
    number = int(text) if LENGTH.fullmatch(text) else None
    return number if number is not None and number <= LARGEST_LENGTH else None


def _empty_bound(match: re.Match[str]) -> bool:
    return bool(match["most"]) and not match["length"]
