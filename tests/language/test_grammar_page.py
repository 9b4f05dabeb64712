"""The grammar in the language reference is that of the parser."""

from __future__ import annotations

import os
import re
from pathlib import Path

from rosetta_jit.language.parse.templates import GRAMMAR
from tests.language.ebnf import ebnf

PAGE = Path(__file__).resolve().parents[2] / "docs" / "grammar.md"
BLOCK = re.compile(r"(?<=```ebnf\n).*?(?=```)", re.DOTALL)


def test_the_page_has_the_grammar():
    """``UPDATE_GOLDENS=1 pytest`` writes it anew after a change of the grammar."""
    expected = ebnf(GRAMMAR.read_text("utf-8"), {"GUARD": '"when"'}) + "\n"
    page = PAGE.read_text("utf-8")
    if os.environ.get("UPDATE_GOLDENS"):
        page = BLOCK.sub(lambda _: expected, page, count=1)
        PAGE.write_text(page, "utf-8")
    assert BLOCK.findall(page) == [expected]


def test_words_signs_and_tokens():
    text = """
start: _rule*
_rule: one | "two" [NAME ("," NAME)*] -> named
?one: START (LESS | "(") WORD
    | one
LESS: "<"
WORD.3: /word(?=[ \\t]*:)/
NAME: /[a-z]+/
START.2: /(?<![a-z\\]])\\.[a-z]+/
%declare GUARD
"""
    assert ebnf(text, {}).splitlines() == [
        "start = rule*",
        'rule = one | "two" (NAME ("," NAME)*)?',
        'one = START ("<" | "(") "word" | one',
        "",
        "NAME = /[a-z]+/",
        "START = /\\.[a-z]+/",
    ]
