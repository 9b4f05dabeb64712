"""Which constructs of the language a mapping has: what its grammar can say, its functions, its operators, and its conversions.

The names come from the grammar and from the records of functions, so that a new construct is in `EVERY` by itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache

from rosetta_jit.language.arrays.array_functions import ARGUMENTS as ORDERS
from rosetta_jit.language.installed import OURS, shipped
from rosetta_jit.language.parse import mapping as parsing
from rosetta_jit.language.parse.templates import GRAMMAR, grammar
from rosetta_jit.parsing.lalr import Token, Tree
from rosetta_jit.parsing.syntax import parse_tokens
from rosetta_jit.source import Source

RULE = re.compile(r"^\??(?P<name>[a-z_]+):(?P<text>(?:.*\n?(?:    .*\n)*))", re.MULTILINE)
ALIAS = re.compile(r"-> (\w+)")
FRAME = {"start", "import_file", "data_holder", "wire_schema", "path", "index", "integer", "real", "name", "group", "entry"}
"""What every mapping has, or what means nothing by itself."""

OPERATORS = {
    f"operator {sign}" for sign in ("or", "and", "==", "!=", "<", "<=", ">", ">=", "|", "^", "&", "<<", ">>", "+", "-", "*", "/", "%")
}
TYPES = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64", "bool")
CONVERSIONS = {f"conversion {rule}" for rule in ("as it is", "saturate", "wrap", "round", "truncate", "exact")}
ALIKE = {
    "relation": "assign",
    "arranged_both": "arranged",
    "length_relation": "set_length",
    "loop_of_both": "loop",
    "when_of_both": "when",
    "same_of_both": "same",
    "renamed_of_both": "renamed",
    "otherwise_of_both": "otherwise",
}
"""A rule for both directions is the one for each of them."""

SPECIAL = {
    "WIRES": "several wires",
    "REST": "the rest",
    "DEPTH": "to depth",
    "BY": "slice by",
    "BOTH": "both directions",
}


def functions() -> set[str]:
    """The functions and orders that a mapping can name, groups by the name of the group; one that reads a number stands for all."""
    names = {each.name.partition(".")[0] for each in shipped()}
    alike = {name for name in OURS["octets"] if name.endswith("_at")}
    reads = {f"function {name}" for name in names - alike - {"len"} if name.isidentifier()}
    return reads | {f"function {name}" for name in ("int8_at", "index", "has", *ORDERS)}


def constructs_of_grammar() -> set[str]:
    """The rules of the grammar by the names that their trees have."""
    found: set[str] = set()
    for each in RULE.finditer(GRAMMAR.read_text("utf-8")):
        aliases = ALIAS.findall(each["text"])
        found |= {*aliases} if aliases or each[0].startswith("?") else {each["name"]}
    return {ALIKE.get(name, name) for name in found if not name.startswith("_")} - FRAME - {"binary"}


EVERY = constructs_of_grammar() | functions() | OPERATORS | CONVERSIONS | set(SPECIAL.values())


@cache
def contained(text: str) -> frozenset[str]:
    """The constructs that the text of a mapping has."""
    source = Source("m.mapping", text)
    tokens = list(parsing._told_apart(grammar().lex(text)))
    tree = parse_tokens(grammar(), source, tokens, parsing._recovery(), lambda *_: None)
    assert isinstance(tree, Tree), text
    return frozenset(_named(tree)) & EVERY


def _named(tree: Tree) -> Iterator[str]:
    yield from own_names(tree)
    for child in tree.children:
        if isinstance(child, Tree):
            yield from _named(child)


def own_names(tree: Tree) -> Iterator[str]:
    """The constructs that a tree is, without those in it."""
    yield ALIKE.get(tree.data, tree.data)
    yield from _special(tree)
    kinds = {child.type: str(child) for child in tree.children if isinstance(child, Token)}
    match tree.data:
        case "binary":
            yield f"operator {next(str(child) for child in tree.children if isinstance(child, Token))}"
        case "call" | "component" | "chosen":
            yield from _called(kinds["NAME"], tree)
        case _:
            pass


def _called(name: str, tree: Tree) -> Iterator[str]:
    if name in TYPES:
        rule = next((str(each.children[0]) for each in tree.children[1:] if isinstance(each, Tree) and each.data == "name"), "")
        yield f"conversion {rule}" if f"conversion {rule}" in CONVERSIONS else "conversion as it is"
    yield f"function {'int8_at' if name in OURS['octets'] and name.endswith('_at') else name}"


def _special(tree: Tree) -> Iterator[str]:
    kinds = [child.type for child in tree.children if isinstance(child, Token)]
    match tree.data:
        case "wire_schema" if "COLON" in kinds and kinds[0] == "NAME":
            yield SPECIAL["WIRES"]
        case "ignore" | "default" if not any(isinstance(child, Tree) for child in tree.children):
            yield SPECIAL["REST"]
        case "via" if "INTEGER" in kinds:
            yield SPECIAL["DEPTH"]
        case "slice" if sum(isinstance(child, Tree) for child in tree.children) > 2:
            yield SPECIAL["BY"]
        case "rules":
            yield SPECIAL["BOTH"]
        case _:
            pass
