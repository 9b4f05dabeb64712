"""Which constructs the reports of the wrong mappings in tests/golden/mapping are about.

A report is about the constructs whose text its place lies in, and about those that begin there; of blocks of rules, only what begins
there, and what its condition or its bounds are.
A mapping with mistakes of syntax has no tree: there, a report is about the construct of the word that its line begins with.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from rosetta_jit.language.arrays.array_functions import ARGUMENTS as ORDERS
from rosetta_jit.language.installed import OURS
from rosetta_jit.language.parse import mapping as parsing
from rosetta_jit.language.parse.templates import grammar
from rosetta_jit.parsing.lalr import Tree
from rosetta_jit.parsing.syntax import parse_tokens
from rosetta_jit.source import Source
from tests.constructs.contained import EVERY, own_names
from tests.language.test_check_reports import diagnostics

BLOCKS = {"rules", "unpack_rules", "pack_rules", "start", "when", "loop", "otherwise"}
HEADS = {"when": 1, "loop": 2}
"""How many expressions a block begins with: its condition, its bounds."""

WORDS = {
    "rules": "rules",
    "pack-rules": "pack_rules",
    "unpack-rules": "unpack_rules",
    "else": "otherwise",
    "for": "loop",
    "same": "same",
    "state": "state",
    **{word: word for word in ("edition", "function", "ignore", "default", "limit", "parameter", "reject", "rounding", "when")},
}
PIECES = {
    "assign",
    "call",
    "each",
    "false",
    "inversion",
    "negative",
    "string",
    "true",
    "both directions",
    "unpack_rules",
    "pack_rules",
    "rules",
}
"""What every mapping is made of, and what nothing can be wrong with by itself."""

GROUPS = {
    "otherwise": "when",
    "last": "table",
    "slice by": "slice",
    "to depth": "via",
    "chosen": "family reductions",
    "the rest": "ignore and default",
    "ignore": "ignore and default",
    "default": "ignore and default",
    "component": "functions of several values",
    **{f"family {name}": "functions of several values" for name in ("rotations", "poses", "geodesy", "utm")},
    **{f"family {name}": "functions of whole arrays" for name in ("sequences", "runs", "bits")},
    "state": "state",
    "set_state": "state",
    "renamed": "same",
    "function len": "length",
}
"""What a user takes for one construct."""


def name_of_group(construct: str) -> str:
    """The construct as a user counts it: functions by their family, operators and conversions as one."""
    kind, _, name = construct.partition(" ")
    if kind == "function" and name in ORDERS:
        return "orders"
    if kind == "function" and name:
        family = next((family for family, names in OURS.items() if name in names), None)
        construct = "family octets" if name == "int8_at" else f"family {family}" if family else construct
    if kind in {"operator", "conversion"}:
        return f"{kind}s"
    return GROUPS.get(construct, construct)


EVERY_GROUP = {name_of_group(each) for each in EVERY - PIECES}


def reported(path: Path) -> Iterator[tuple[str, str]]:
    """The constructs that errors of a mapping are about, with what each error says."""
    source = Source(path.name, path.read_text())
    tree = _tree(source)
    for each in diagnostics(path):
        if each.severity == "error" and each.span is not None and each.span.source.name == path.name:
            found = _of_line(source, each.span.start) if tree is None else set(_around(tree, each.span.start))
            for construct in {name_of_group(one) for one in found & EVERY - PIECES}:
                yield construct, f"{each.code}: {each.message}"


def _tree(source: Source) -> Tree | None:
    try:
        tokens = list(parsing._told_apart(grammar().lex(source.text)))
        found = parse_tokens(grammar(), source, tokens, parsing._recovery(), parsing.words.unexpected)
    except AssertionError:
        return None
    return found if isinstance(found, Tree) else None


def _around(tree: Tree, at: int) -> Iterator[str]:
    name = next(own_names(tree))
    inner = [child for child in tree.children if isinstance(child, Tree)]
    if _is_within(tree, at) and (
        name not in BLOCKS or tree.start_pos == at or any(_is_within(each, at) for each in inner[: HEADS.get(name, 0)])
    ):
        yield from own_names(tree)
        if tree.data == "name":
            yield f"function {tree.children[0]}"  # without its brackets
    for child in inner:
        yield from _around(child, at)


def _is_within(tree: Tree, at: int) -> bool:
    return tree.start_pos <= at < max(tree.end_pos, tree.start_pos + 1)


def _of_line(source: Source, at: int) -> set[str]:
    start = source.text.rfind("\n", 0, at) + 1
    words = source.text[start:].replace(":", " ").split(None, 1)
    return {WORDS[words[0]]} if words and words[0] in WORDS else set()
