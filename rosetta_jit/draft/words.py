"""How alike names are: word by word, with the synonyms of robotics."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

SYNONYMS = (
    ("position", "translation", "location", "point", "place", "coordinate", "pos", "xyz"),
    ("orientation", "rotation", "quaternion", "attitude", "quat", "rot"),
    ("stamp", "timestamp", "time", "moment", "date"),
    ("angle", "position", "joint", "encoder", "radian", "degree"),
    ("effort", "torque", "force", "load", "moment"),
    ("velocity", "speed", "rate"),
    ("data", "value", "buffer", "pixel", "payload", "sample", "element", "entry", "content"),
    ("name", "label", "key", "identifier", "id", "title"),
    ("status", "state", "mode"),
    ("width", "column", "col", "n"),
    ("height", "row", "m"),
    ("cell", "point", "vertex", "corner", "pose"),
    ("sequence", "seq", "number", "counter", "serial", "index"),
    ("encoding", "format", "code", "color"),
    ("frame", "reference", "parent"),
    ("projection", "p", "matrix"),
    ("second", "sec", "s"),
    ("nanosecond", "nsec", "nano", "nanosec", "ns"),
    ("temperature", "temp", "heat"),
    ("information", "info", "description", "message", "text", "comment"),
    ("left", "first"),
    ("right", "second"),
    ("offset", "origin", "left", "top"),
    ("image", "picture", "frame"),
    ("forces", "force"),
    ("battery", "charge"),
    ("percentage", "percent", "share"),
)
"""Words that mean the same in some context, of which this module knows nothing."""

GENERIC = frozenset(("data", "value", "element", "entry", "item", "content", "float", "double", "string", "buffer", "field"))
"""Words that name any value."""

EQUAL, SYNONYM, PART, ANY = 1.0, 0.9, 0.75, 0.4

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


@cache
def tokens(name: str) -> tuple[str, ...]:
    """The words of a name, in singular: ``jointPositions`` and ``joint_positions`` are ``joint`` and ``position``."""
    return tuple(_singular(each.lower()) for each in _WORD.findall(name))


def _singular(word: str) -> str:
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word in {"vertices", "indices"}:
        return word[:-4] + "ex"
    return word[:-1] if word.endswith("s") and not word.endswith(("ss", "us", "is")) and len(word) > 3 else word


@cache
def _meanings(word: str) -> frozenset[int]:
    return frozenset(number for number, group in enumerate(SYNONYMS) if word in group)


@cache
def alike_words(one: str, other: str) -> float:
    """How alike two words are, from 0 to 1."""
    if one == other:
        return EQUAL
    if _meanings(one) & _meanings(other):
        return SYNONYM
    short, long = sorted((one, other), key=len)
    if long.endswith(short) and len(long) - len(short) == 1:  # `qx` and `x`
        return PART
    return PART if len(short) > 2 and long.startswith(short) else 0.0


@cache
def alike(one: str, other: str) -> float:
    """How alike two names are, from 0 to 1: the share of their words that are alike."""
    first, second = tokens(one), tokens(other)
    if not first or not second:
        return float(one.lower() == other.lower())
    if first == second:
        return EQUAL
    few, many = sorted((first, second), key=len)
    best = [max(alike_words(word, each) for each in many) for word in few]
    found = sum(best) / len(few) * (1.0 if len(few) == len(many) else 0.8)
    if found >= ANY:
        return found
    return ANY if GENERIC & {*first, *second} else 0.0


def shared(one: Iterable[str], other: Iterable[str]) -> float:
    """How much of what stands around one value is said around another one: the share of the fewer words."""
    first, second = ({word for name in names for word in tokens(name)} for names in (one, other))
    if not first or not second:
        return 0.0
    few, many = sorted((first, second), key=len)
    return sum(max(alike_words(word, each) for each in many) for word in sorted(few)) / len(few)
