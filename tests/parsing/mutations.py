"""Random texts that are nearly right: parts of real ones changed byte by byte, token by token, or derived from a grammar."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from lark import Lark

if TYPE_CHECKING:
    import random

ROOT = Path(__file__).resolve().parents[2]
MOST = 12_000
"""Characters of a text that is changed."""
TOKEN = re.compile(r"\w+|\s+|.", re.DOTALL)
SPECIAL = [
    "\0",
    "\ud800",
    "\ufeff",
    "\u202e",
    "\r",
    "\x0c",
    "\\",
    '"',
    "'",
    "/*",
    "//",
    "#",
    "-1",
    "0",
    "9" * 30,
    "9" * 5_000,
    "0x" + "f" * 20,
    "1e999999",
    str(1 << 31),
    str(1 << 63),
    str(1 << 64),
    "(" * 300,
    "[" * 300,
    "{" * 300,
    "<" * 300,
    "a" * 3_000,
    ".." * 50,
    "[1000]" * 12,
]
FOLDERS = ("idl", "mappings", "tests/golden", "tests/vectors")


@cache
def corpus(suffix: str) -> tuple[str, ...]:
    """The tree's own texts in a language, those that are right and those that are meant to be wrong."""
    paths = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob(f"*{suffix}"))
    texts = [path.read_bytes().decode(errors="replace") for path in paths if path.is_file() and path.stat().st_size < MOST]
    assert texts, suffix
    return tuple(texts)


@cache
def words(suffix: str) -> tuple[str, ...]:
    """The tokens of those texts."""
    return tuple(sorted({token for text in corpus(suffix) for token in TOKEN.findall(text)}))


def mutated(suffix: str, random_: random.Random) -> str:
    """A text with some tokens changed."""
    tokens = TOKEN.findall(random_.choice(corpus(suffix)))
    for _ in range(random_.choice([1, 1, 1, 2, 3, 10])):
        tokens = _changed(tokens, suffix, random_)
    return "".join(tokens)


def _changed(tokens: list[str], suffix: str, random_: random.Random) -> list[str]:
    at, other = sorted(random_.randrange(len(tokens) + 1) for _ in range(2))
    part = tokens[at : min(other, at + random_.choice([1, 1, 5, 50]))]
    before, behind = tokens[:at], tokens[at + len(part) :]
    match random_.randrange(8):
        case 0:
            return [*before, *behind] or [""]
        case 1:
            return [*before, *part, *part, *behind]
        case 2:
            return [*before, *(part * random_.choice([3, 30, 300]))[:3_000], *behind]
        case 3:
            return [*before, random_.choice(words(suffix)), *behind]
        case 4:
            return [*before, random_.choice(words(suffix)), *part, *behind]
        case 5:
            return [*before, random_.choice(SPECIAL), *part[1:], *behind]
        case 6:
            found = TOKEN.findall(random_.choice(corpus(suffix)))
            start = random_.randrange(len(found) + 1)
            return [*before, *found[start : start + 40], *behind]
        case _:
            return [*before, *reversed(part), *behind]


def mutated_bytes(data: bytes, random_: random.Random) -> bytes:
    """Bytes of which some are changed, left out, repeated or put in."""
    changed = bytearray(data)
    for _ in range(random_.choice([1, 1, 2, 5, 20])):
        at = random_.randrange(len(changed) + 1)
        size = random_.choice([1, 1, 4, 30])
        match random_.randrange(6):
            case 0 if at < len(changed):
                changed[at] ^= 1 << random_.randrange(8)
            case 1:
                del changed[at : at + size]
            case 2:
                changed[at:at] = changed[at : at + size] * random_.choice([1, 2, 50])
            case 3:
                changed[at : at + 1] = bytes([random_.choice([0, 9, 10, 34, 127, 128, 0xC0, 0xED, 0xFE, 255])])
            case 4:
                changed[at:at] = random_.randbytes(size)
            case _:
                changed[at : at + 4] = random_.choice([b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0\0\0\0"])
    return bytes(changed)


class Derivation:
    """Texts that a grammar has, by any of its rules; a terminal is one of the corpus's tokens that match it."""

    def __init__(self, grammar: Path, suffix: str, start: str = "start") -> None:
        made = Lark(grammar.read_text("utf-8"), parser="lalr", start=start, keep_all_tokens=True)
        self._start = start
        self._rules: dict[str, list[list[tuple[bool, str]]]] = {}
        for rule in made.rules:
            self._rules.setdefault(str(rule.origin.name), []).append([(part.is_term, str(part.name)) for part in rule.expansion])
        pieces = {word for word in words(suffix) if word.strip()} | set(
            re.findall(r'"[^"\n]*"|[.]\w+|[-\w]+(?:[./]\w+)*|<->|[<>=!]=', "\n".join(corpus(suffix)))
        )
        self._tokens = {each.name: [p for p in sorted(pieces) if re.fullmatch(each.pattern.to_regexp(), p)] for each in made.terminals}
        for each in made.terminals:
            self._tokens[each.name] = self._tokens[each.name] or [each.pattern.value if type(each.pattern).__name__ == "PatternStr" else ""]

    def text(self, random_: random.Random, most: int = 400) -> str:
        """A text of about so many tokens at most."""
        pending, found = [(False, self._start)], []
        while pending:
            is_term, name = pending.pop()
            if is_term:
                found.append(random_.choice(self._tokens.get(name, [""])))
                continue
            ways = self._rules[name]
            way = min(ways, key=len) if len(found) + len(pending) > most else random_.choice(ways)
            if len(found) > 4 * most:
                break
            pending += reversed(way)
        return " ".join(found)
