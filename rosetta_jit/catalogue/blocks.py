"""Which block of a mapping's text lacks its `end`."""

from __future__ import annotations

import re

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
