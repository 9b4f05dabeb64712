"""Characters that word processors, web pages and PDF files put where the language has plain ones."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

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
