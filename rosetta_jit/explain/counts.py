"""How often a loop of a kernel runs, in words: ``len(.position)``, ``.height * .width * 3``.

A kernel calls its locals after the fields whose values they hold. What it calls a count or a sum is followed to what it was made of; a
number that a message or a holder said of an array is named by the field that the check of it is about.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from rosetta_jit.explain.limits import MAX_COUNT_DEPTH, MAX_COUNT_TEXT
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.printer import SYMBOL
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import replace

ROUNDS = "round of a loop"
"""How often a loop runs of which no more is known."""

OWN = re.compile(r"len\([^()]*\)|\.[A-Za-z_][\w.\[\]]*|\b(?:min|max)\b")
"""In the text of a count: lengths, fields and functions. What is left are locals of the kernel, whose names say nothing to a user."""

TIGHT = frozenset(("mul", "div", "rem"))


def named_counts(block: nodes.Block, sites: Sequence[ir.Site]) -> dict[str, str]:
    """For each local that is checked to be no negative length, or to leave room for so many bytes, the field that it is the length of."""
    names: dict[str, str] = {}
    for stmt, _ in statements(block):
        match stmt:
            case nodes.Expect(nodes.Compare("ge", nodes.Local(_, name), nodes.Const(_, 0)), failure) if sites[failure.site].kind in {
                "length",
                "count",
            }:
                site = sites[failure.site]
            case nodes.Expect(condition, failure) if sites[failure.site].detail == "the holder is damaged":
                site = sites[failure.site]
                found = sorted(each for each in locals_in(condition) if each.startswith("count"))
                name = found[0] if found else ""
            case nodes.Require(_, size, failure):
                site = sites[failure.site]
                found = sorted(locals_in(size))
                name = found[0] if len(found) == 1 else ""
            case _:
                continue
        if name and site.path:
            names.setdefault(name, f"len({_path(site.path)})")
    return names


def factored(expr: nodes.Expr, values: Mapping[str, nodes.Expr]) -> tuple[nodes.Expr, int]:
    """A count, and by which constant it is multiplied."""
    factor = 1
    for _ in range(MAX_COUNT_DEPTH):
        match expr:
            case nodes.Local(_, name) if name in values and _is_product(values[name]):
                expr = values[name]
            case nodes.Binary("mul", inner, nodes.Const(_, number)) | nodes.Binary("mul", nodes.Const(_, number), inner) if int(number) > 0:
                expr, factor = inner, factor * int(number)
            case nodes.Binary("mul" as op, nodes.Binary("mul", inner, nodes.Const(_, number)), other) if int(number) > 0:
                expr, factor = replace(expr, op=op, left=inner, right=other), factor * int(number)
            case _:
                break
    return expr, factor


def _is_product(value: nodes.Expr) -> bool:
    return isinstance(value, nodes.Binary) and value.op == "mul"


def count_text(expr: nodes.Expr, values: Mapping[str, nodes.Expr], names: Mapping[str, str]) -> str:
    """A count as text, at most `MAX_COUNT_TEXT` long; `ROUNDS` where it is no product of fields, lengths and what is made of them."""
    text = _text(expr, values, names, 0).replace(" + -", " - ")
    bare = OWN.sub("", text)
    if re.search(r"[A-Za-z_]", bare) and (text.isidentifier() or re.search(r" [-+&] |\(", bare)):
        return ROUNDS
    return text if len(text) <= MAX_COUNT_TEXT else f"{text[: MAX_COUNT_TEXT - 1]}…"


def _text(expr: nodes.Expr, values: Mapping[str, nodes.Expr], names: Mapping[str, str], depth: int) -> str:
    match expr:
        case nodes.Const(_, value):
            return str(value)
        case nodes.Local(_, name) if name in names:
            return names[name]
        case nodes.Local(_, name) if name in values and depth < MAX_COUNT_DEPTH and _is_made(values[name]):
            return _text(values[name], values, names, depth + 1)
        case nodes.Local(_, name):
            stem = re.sub(r"_[0-9]+$", "", name)
            return names.get(stem, stem)
        case nodes.Convert(_, operand) | nodes.Bits(_, operand):
            return _text(operand, values, names, depth)
        case nodes.Binary(op, left, right) if op in {"min", "max"}:
            return f"{op}({_text(left, values, names, depth)}, {_text(right, values, names, depth)})"
        case nodes.Binary(op, left, right):
            before, behind = (_operand(each, op, values, names, depth) for each in (left, right))
            rest = before.removeprefix(f"{behind} + ") if op == "sub" else before
            return rest if rest != before else f"{before} {SYMBOL[op]} {behind}"
        case _:
            return ROUNDS


def _operand(expr: nodes.Expr, op: str, values: Mapping[str, nodes.Expr], names: Mapping[str, str], depth: int) -> str:
    """In brackets where a sum stands in a product."""
    text = _text(expr, values, names, depth)
    return f"({text})" if op in TIGHT and re.search(r" [-+] ", text) else text


def _is_made(value: nodes.Expr) -> bool:
    """Whether a local only stands for arithmetic of other locals."""
    return isinstance(value, nodes.Binary | nodes.Local) or (isinstance(value, nodes.Convert) and isinstance(value.operand, nodes.Local))


def _path(path: str) -> str:
    return path.replace("{{", "{").replace("}}", "}").replace("{}", "")
