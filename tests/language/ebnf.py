"""A grammar of lark as EBNF, as people read it: without what only the parser needs.

Rules are named by words with hyphens. A token that is one text stands as this text; the others keep their capitals, and are given as
regular expressions below the rules. What looks around a token, to tell it from others, is left out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

WIDTH = 118
DEFINITION = re.compile(r"^\??(?P<name>[A-Za-z_]+)(\.-?\d+)?:\s*(?P<text>.*)$")
PART = re.compile(r'"(?:\\.|[^"\\])*"|/(?:\\.|[^/\\])*/|->\s*\w+|\w+|\S')
AROUND = re.compile(r"\(\?<?[=!](?:\[[^\]]*\]|[^()\[])*\)")
SIGNS = {"[": "(", "]": ")?"}


@dataclass(frozen=True)
class Grammar:
    """Definitions by name, as they are written; ``words`` are the tokens that are one text."""

    rules: dict[str, str]
    words: dict[str, str]
    patterns: dict[str, str]


def ebnf(lark: str, told: dict[str, str]) -> str:
    """The EBNF of a grammar; ``told`` are the texts of tokens that it only declares."""
    grammar = _read(lark, told)
    used = {name for text in grammar.rules.values() for name in PART.findall(text)}
    rules = [_shown(name, text, grammar) for name, text in grammar.rules.items()]
    patterns = [f"{name} = /{pattern}/" for name, pattern in grammar.patterns.items() if name in used]
    return "\n".join([*rules, "", *patterns])


def _read(lark: str, told: dict[str, str]) -> Grammar:
    rules: dict[str, str] = {}
    tokens: dict[str, str] = dict(told)
    for name, text in _definitions(lark):
        (tokens if name.isupper() else rules)[name] = text
    patterns = {name: AROUND.sub("", text[1:-1]) for name, text in tokens.items() if text.startswith("/")}
    plain = {name for name, pattern in patterns.items() if pattern.isalpha()}
    words = {name: f'"{patterns[name]}"' if name in plain else text for name, text in tokens.items() if name not in patterns.keys() - plain}
    return Grammar(rules, words, {name: pattern for name, pattern in patterns.items() if name not in plain})


def _definitions(lark: str) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for line in lark.splitlines():
        started = DEFINITION.match(line)
        if started:
            found.append((started["name"], started["text"]))
        elif line.startswith("    |"):
            name, text = found.pop()
            found.append((name, f"{text} {line.strip()}"))
        else:
            assert not line or line.startswith(("//", "%")), line
    return found


def _shown(name: str, text: str, grammar: Grammar) -> str:
    head = f"{_name(name)} ="
    lines = [head]
    for number, choice in enumerate(_choices([part for part in (_part(each, grammar) for each in PART.findall(text)) if part])):
        joined = f" {choice}" if number == 0 else f" | {choice}"
        if number and len(lines[-1] + joined) > WIDTH:
            lines.append(" " * (len(head) - 2) + joined)
        else:
            lines[-1] += joined
    return "\n".join(lines)


def _choices(parts: list[str]) -> list[str]:
    """What the bars outside of all brackets divide."""
    found: list[list[str]] = [[]]
    depth = 0
    for part in parts:
        depth += (part == "(") - part.startswith(")")
        if part == "|" and depth == 0:
            found.append([])
        else:
            found[-1].append(part)
    return [re.sub(r" ([)*?+]+)", r"\1", re.sub(r"(?<!\S)\( ", "(", " ".join(choice))) for choice in found]


def _part(text: str, grammar: Grammar) -> str:
    if text.startswith(("->", '"', "/")):
        return "" if text.startswith("->") else text
    if text.isupper():
        return grammar.words.get(text, text)
    return SIGNS.get(text, _name(text) if text[0].isalpha() or text[0] == "_" else text)


def _name(name: str) -> str:
    return name.strip("_").replace("_", "-")
