"""Parentheses around expressions, in the languages where operators need them."""

from __future__ import annotations


def bare(text: str) -> str:
    """A text without the parentheses around all of it."""
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for number, char in enumerate(text):
        depth += (char == "(") - (char == ")")
        if depth == 0 and number < len(text) - 1:
            return text
    return text[1:-1]
