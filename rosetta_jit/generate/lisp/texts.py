"""Texts of schemas and mappings in Lisp source, where none can end what it stands in; and forms that are too long for a line."""

from __future__ import annotations

import re

from rosetta_jit.startup.dataclass import dataclass

MAX_COMMENT = 200
MAX_DOC = 400
WIDTH = 120
PLAIN = re.compile(r"[ -~]*")
RUN = re.compile(r"[ -~]+|[^ -~]+")
TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|#\\.[a-z]*|[^\s()]+|[()]|\n', re.DOTALL)
WITH_BODY = {"let": 1, "let*": 1, "when": 1, "unless": 1, "dotimes": 1, "for": 1, "while": 1, "elements": 2, "entries": 2, "with-floats": 0}
"""How many forms stand before the body of these."""


def literal(text: str) -> str:
    """A string, or the form for one: characters that are not printable ASCII are told by their codes."""
    parts = [f'"{_escaped(each)}"' if PLAIN.fullmatch(each) else " ".join(str(ord(char)) for char in each) for each in RUN.findall(text)]
    return parts[0] if len(parts) == 1 and parts[0].startswith('"') else f"(text {' '.join(parts)})" if parts else '""'


def doc(text: str) -> str:
    """A docstring of one line."""
    return f'"{_escaped(_plain(text)[:MAX_DOC])}"'


def comment(text: str) -> str:
    """What stands behind a semicolon."""
    plain = _plain(text)
    return plain if len(plain) <= MAX_COMMENT else f"{plain[:MAX_COMMENT]}..."


def _plain(text: str) -> str:
    return ascii(" ".join(text.split()))[1:-1].replace("\\'", "'")


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


def broken(form: str, depth: int) -> list[str]:
    """A form as lines that begin at a column; it is broken where it is too long for one."""
    return [form] if depth + len(form) <= WIDTH else _lines(_parsed(form), depth)


@dataclass(frozen=True, slots=True)
class Prefixed:
    """A form behind a quote, or behind the sign of a vector."""

    sign: str
    tree: Tree


Tree = str | Prefixed | list["Tree"]


def _parsed(form: str) -> Tree:
    stack: list[list[Tree]] = [[]]
    for token in TOKEN.findall(form):
        match token:
            case "(":
                stack.append([])
            case ")":
                done: Tree = stack.pop()
                if stack[-1][-1:] in (["'"], ["#"]):
                    done = Prefixed(str(stack[-1].pop()), done)
                stack[-1].append(done)
            case _:
                stack[-1].append(token)
    return stack[0][0]


def _flat(tree: Tree) -> str:
    match tree:
        case str():
            return tree
        case Prefixed(sign, inner):
            return f"{sign}{_flat(inner)}"
        case list():
            return f"({' '.join(map(_flat, tree))})"


def _lines(tree: Tree, depth: int) -> list[str]:
    """Operator and first operand stay together where that fits; the others stand below the first, or within the body two columns in."""
    flat = _flat(tree)
    if isinstance(tree, Prefixed):
        first, *others = _lines(tree.tree, depth + 1)
        return [f"{tree.sign}{first}", *others]
    if isinstance(tree, str) or depth + len(flat) <= WIDTH or len(tree) < 2:
        return [flat]
    head = tree[0]
    if not isinstance(head, str):
        return _below(tree, depth + 1, "(")
    if head in WITH_BODY:
        before = " ".join(map(_flat, tree[: 1 + WITH_BODY[head]]))
        return _joined(f"({before}", tree[1 + WITH_BODY[head] :], depth + 2)
    if head == "setf":
        return _pairs(tree, depth)
    if head == "declare":
        return _filled(tree, depth)
    inner = depth + len(head) + 2
    if inner > WIDTH // 2:
        return _joined(f"({head}", tree[1:], depth + 2)
    return _below(tree[1:], inner, f"({head} ")


def _filled(tree: list[Tree], depth: int) -> list[str]:
    """As many operands in each line as fit."""
    lines = [""]
    for each in map(_flat, tree[1:]):
        if lines[-1] and depth + len(lines[-1]) + len(each) > WIDTH - len("(declare ") - 1:
            lines.append("")
        lines[-1] += f" {each}" if lines[-1] else each
    return [f"{'(declare ' if number == 0 else ' ' * (depth + 9)}{each}" for number, each in enumerate([*lines[:-1], f"{lines[-1]})"])]


def _pairs(tree: list[Tree], depth: int) -> list[str]:
    """Places and what they get."""
    lines: list[str] = []
    for place, value in zip(tree[1::2], tree[2::2], strict=True):
        first = "(setf " if not lines else " " * (depth + 6)
        lines.append(f"{first}{_flat(place)}")
        lines += _indented(_lines(value, depth + 6), depth + 6)
    lines[-1] += ")"
    return lines


def _below(trees: list[Tree], depth: int, first: str) -> list[str]:
    lines: list[str] = []
    for each in trees:
        inner = _lines(each, depth)
        lines += [f"{first}{inner[0]}", *inner[1:]] if not lines else _indented(inner, depth)
    lines[-1] += ")"
    return lines


def _joined(first: str, trees: list[Tree], depth: int) -> list[str]:
    lines = [first]
    for each in trees:
        lines += _indented(_lines(each, depth), depth)
    lines[-1] += ")"
    return lines


def _indented(lines: list[str], depth: int) -> list[str]:
    """Lines of which all but the first are where they belong already."""
    return [" " * depth + lines[0], *lines[1:]]
