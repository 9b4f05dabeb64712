"""Names, numbers, strings and options: what the statements of a file are made of.

Numbers and strings get their values here, so what is wrong with one of them is found here.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, cast

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.limits import MAX_COMMENT, MAX_NAME
from rosetta_jit.frameworks.protobuf.proto import literals, syntax
from rosetta_jit.frameworks.protobuf.proto.tree import Aggregate, Entry, Listing, Name, Option, Value, Version, Word
from rosetta_jit.parsing.lalr import Token, Tree
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

Node = Tree


@dataclass(frozen=True, slots=True)
class ValueReader:
    """Reads the parts of one source; what is wrong with them goes to ``problems``."""

    source: Source
    problems: list[Diagnostic]
    version: Version = "proto2"

    # Options

    def options(self, node: Node) -> tuple[Option, ...]:
        return tuple(self.option(child) for child in all_of(node, "option"))

    def settings(self, node: Node) -> tuple[Option, ...]:
        """The options in brackets."""
        return tuple(option for child in all_of(node, "settings") for option in self.options(child))

    def option(self, node: Node) -> Option:
        name, value = cast("list[Node]", node.children)
        parts = tuple(
            f"({self.path(one(part, 'path')).text})" if isinstance(part, Tree) else str(part)
            for part in name.children
            if isinstance(part, Tree) or part.type != "DOT"
        )
        self.checked(Name(".".join(parts), self.span(name)))
        return Option(parts, self.option_value(value), self.span(name))

    def option_value(self, node: Node) -> Value:
        match node.data:
            case "string":
                return self.string(node)
            case "signed":
                return self.number(node)
            case "word":
                return Word("".join(tokens_of(node)))
            case "listing":
                return Listing(tuple(self.option_value(child) for child in cast("list[Node]", node.children)))
            case _:
                return Aggregate(tuple(self.entry(child) for child in cast("list[Node]", node.children)))

    def entry(self, node: Node) -> Entry:
        key, value = cast("tuple[Node | Token, Node]", node.children)
        name = f"({''.join(tokens_of(key))})" if isinstance(key, Tree) else str(key)
        return Entry(name, self.option_value(value))

    # Words, numbers, strings

    def name(self, token: Token) -> Name:
        return self.checked(Name(str(token), self.at(token)))

    def path(self, node: Node) -> Name:
        return self.checked(Name("".join(tokens_of(node)), self.span(node)))

    def checked(self, name: Name) -> Name:
        if len(name.text) > MAX_NAME:
            self.problems.append(of_file.name_too_long(name.span, MAX_NAME))
        return Name(name.text[:MAX_NAME], name.span)

    def integer(self, token: Token) -> int:
        """A number that no sign may precede: that of a field."""
        value = self.unsigned(token)
        return value if isinstance(value, int) else self.wrong(self.at(token), "an integer")

    def signed(self, node: Node) -> int:
        value = self.number(node)
        return value if isinstance(value, int) else self.wrong(self.span(node), "an integer")

    def number(self, node: Node) -> int | float:
        *minus, digits = tokens_of(node)
        value = self.unsigned(digits)
        return -value if minus else value

    def unsigned(self, token: Token) -> int | float:
        value = literals.number(str(token))
        return self.wrong(self.at(token), "a number") if value is None else value

    def wrong(self, span: Span, wanted: Literal["an integer", "a number"]) -> int:
        self.problems.append(of_file.wrong_number(span, wanted))
        return 1

    def text(self, node: Node) -> str:
        try:
            return self.string(node).decode()
        except UnicodeDecodeError:
            self.problems.append(of_file.not_utf8(self.span(node)))
            return ""

    def string(self, node: Node) -> bytes:
        """Adjacent strings are one."""
        return b"".join(self.bytes(token) for token in tokens_of(node))

    def bytes(self, token: Token) -> bytes:
        try:
            return literals.string(str(token))
        except literals.EscapeError as error:
            start = self.at(token).start + 1 + cast("int", error.args[0])
            self.problems.append(of_file.wrong_escape(Span(self.source, start, start + 2)))
            return b""

    # Places

    def at(self, token: Token) -> Span:
        return syntax.span_of(self.source, token)

    def span(self, node: Node) -> Span:
        first, last = ends(node)
        return self.at(first).to(self.at(last))

    def doc(self, node: Node) -> str:
        """The comment before a declaration."""
        return leading_comment(self.source.text, ends(node)[0].start_pos)

    def doc_of_field(self, node: Node) -> str:
        """The comment before a field, or else the one that follows on its line."""
        return self.doc(node) or trailing_comment(self.source.text, ends(node)[1].end_pos)


def all_of(node: Node, *rules: str) -> Iterator[Node]:
    """The children of a node that come from certain rules."""
    return (child for child in node.children if isinstance(child, Tree) and child.data in rules)


def one(node: Node, rule: str) -> Node:
    """The only child that comes from a rule."""
    return next(all_of(node, rule))


def tokens_of(node: Node) -> list[Token]:
    """The tokens right under a node."""
    return [child for child in node.children if isinstance(child, Token)]


def ends(node: Node) -> tuple[Token, Token]:
    """The first and the last token under a node. Rules that matched nothing, such as an empty list, have none."""
    tokens: list[Token] = []
    for step in (1, -1):
        pending: list[Node | Token] = [node]
        while isinstance(top := pending.pop(), Tree):
            pending += top.children[::-step]
        tokens.append(top)
    return tokens[0], tokens[1]


def leading_comment(text: str, start: int) -> str:
    """The text of the comment that ends where the declaration at ``start`` begins; empty where there is none."""
    begin = max(0, start - MAX_COMMENT)
    before = text[begin:start]
    body = before.rstrip()
    if before[len(body) :].count("\n") > 1:
        return ""
    lines = body.split("\n")
    if lines[-1].lstrip().startswith("//"):
        return _line_comments(lines)
    if body.endswith("*/"):
        return _block_comment(body)
    return ""


def trailing_comment(text: str, end: int) -> str:
    """The text of the comment behind the semicolon of the statement whose last word ends at ``end``; empty where there is none."""
    line = text[end : end + MAX_COMMENT].partition("\n")[0]
    behind = line.partition(";")[2].lstrip(" \t")
    if behind.startswith("//"):
        return behind.lstrip("/").strip()
    return behind[2:].partition("*/")[0].strip("* \t") if behind.startswith("/*") and "*/" in behind else ""


def _line_comments(lines: list[str]) -> str:
    kept: list[str] = []
    for line in reversed(lines):
        stripped = line.strip()
        if not stripped.startswith("//"):
            break
        kept.append(stripped.lstrip("/").strip())
    return "\n".join(reversed(kept)).strip()


def _block_comment(body: str) -> str:
    start = body.rfind("/*")
    # A comment behind a statement, on its line, is about that statement.
    if start < 0 or body[:start].rpartition("\n")[2].strip():
        return ""
    return "\n".join(line.strip().lstrip("*").strip() for line in body[start + 2 : -2].split("\n")).strip()
