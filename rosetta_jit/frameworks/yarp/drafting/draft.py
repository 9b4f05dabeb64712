"""Shapes as the text of a bottle schema. Nothing that messages contain gets into it but as a checked word or a comment."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import assert_never

from rosetta_jit.frameworks.yarp.drafting.shape import Entries, Fixed, Keyed, Many, Scalar, Shape
from rosetta_jit.frameworks.yarp.limits import MAX_VALUE_SHOWN
from rosetta_jit.frameworks.yarp.names import unique_names
from rosetta_jit.frameworks.yarp.tags import vocab
from rosetta_jit.frameworks.yarp.text import to_text
from rosetta_jit.frameworks.yarp.tree import List, Value

Line = tuple[str, str]
"""Code, and a comment to stand behind it."""

_VOCAB_TEXT = re.compile(rb"[ !-{}~]+")


def draft(name: str, top: Fixed | Many, messages: int) -> str:
    """The schema of a type whose messages have this shape at the top."""
    head = f"; Drafted from {messages} message{'s' if messages > 1 else ''}: name the fields, add units, and see what never varied."
    match top:
        case Fixed(places):
            fields = [_field(f"f{index}", place) for index, place in enumerate(places)]
        case Many():
            fields = [_field("f0", top, " :rest")]
        case _:
            assert_never(top)
    lines = _close([("(", ""), *_indent(fields)], ")")
    return "\n".join([head, "", f'"{name}"', *map(_text, lines), ""])


def _field(name: str, shape: Shape, options: str = "") -> list[Line]:
    lines = _type(shape)
    constant = _constant(shape)
    if isinstance(shape, Many) and shape.element is not None and not shape.greatest:
        options += " :vector"  # only a vector tells the type of elements that it does not have
    code, comment = lines[0]
    lines[0] = (f'("{name}" {code}', comment or _comment(shape, constant))
    return _close(lines, f"{' ' + constant if constant else ''}{options})")


def _type(shape: Shape) -> list[Line]:
    match shape:
        case Scalar(tag):
            return [(f":{tag}", "")]
        case Many(element, least, greatest):
            if element is None:
                return [("(:bottle)", "")]
            fixed = f" (:length {least})" if least == greatest and least > 0 else ""
            return _close(_open("(:list ", _type(element)), f"{fixed})")
        case Fixed(places):
            fields = [_field(f"f{index}", place) for index, place in enumerate(places)]
            return _close([("(:bottle", ""), *_indent(fields)], ")")
        case Keyed(values):
            names = unique_names(key for key, _ in values)
            fields = [_field(name, value, _key(key)) for name, (key, value) in zip(names, values, strict=True)]
            return _close([("(:dict", ""), *_indent(fields)], ")")
        case Entries(value):
            return _close(_open("(:dict ", [(":string", "")] if value is None else _type(value)), ")")
        case _:
            assert_never(shape)


def _key(key: str) -> str:
    escaped = key.replace("\\", "\\\\").replace('"', '\\"')
    return f' (:key "{escaped}")'


def _constant(shape: Shape) -> str:
    """The vocab that a field always carried. True and false are no constants: they have not varied yet."""
    match shape:
        case Scalar("vocab32" | "vocab64", always=Value(_, int(code))) if code not in {0, vocab(b"1")}:
            octets = (code & (2**64 - 1)).to_bytes(8, "little") if code > 0 else b""
            text = octets.rstrip(b"\0")
            return f":|{text.decode()}|" if _VOCAB_TEXT.fullmatch(text) else ""
        case _:
            return ""


def _comment(shape: Shape, constant: str) -> str:
    match shape:
        case Scalar(_, seen) if constant:
            return f"the same in all {seen}" if seen > 1 else "a constant, if one message can tell"
        case Scalar(_, seen, always=Value() as value):
            return f"always {_shown(value)}" if seen > 1 else ""
        case Scalar("string" | "blob", _, least, greatest):
            return f"{least} to {greatest} bytes" if least != greatest else f"{least} bytes"
        case Scalar("vocab32" | "vocab64"):
            return "varies"
        case Scalar(tag, _, least, greatest) if least is not None and greatest is not None:
            return f"{least:.6g} to {greatest:.6g}" if tag.startswith("float") else f"{least} to {greatest}"
        case Many(None) | Entries(None):
            return "always empty"
        case Many(element, least, greatest):
            counts = f"{least} to {greatest} elements" if least != greatest else ""
            inner = _comment(element, "") if isinstance(element, Scalar) else ""
            return " of ".join(part for part in (counts, inner) if part)
        case _:
            return ""


def _shown(value: Value) -> str:
    if isinstance(value.value, bytes) and len(value.value) > MAX_VALUE_SHOWN:
        return f"the same {len(value.value)} bytes"
    text = to_text(List((value,))).decode("utf-8", "replace")[:MAX_VALUE_SHOWN]
    return "".join(char if char.isprintable() else "?" for char in text)


def _open(code: str, lines: Sequence[Line]) -> list[Line]:
    (first, comment), *rest = lines
    return [(code + first, comment), *rest]


def _close(lines: Sequence[Line], code: str) -> list[Line]:
    *rest, (last, comment) = lines
    return [*rest, (last + code, comment)]


def _indent(fields: Iterable[Sequence[Line]]) -> list[Line]:
    return [(f"  {code}", comment) for lines in fields for code, comment in lines]


def _text(line: Line) -> str:
    code, comment = line
    return f"{code}  ; {comment}" if comment else code
