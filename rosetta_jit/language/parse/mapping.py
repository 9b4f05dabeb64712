"""The mapping language: text → `model.mapping.Mapping`.

In a rule to unpack the place on the left is on the holder's side; in a rule to pack, on the wire's. All that is *read*,
an index within the place included, is on the other side: a target has nothing to read while it is being filled.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import MappingError
from rosetta_jit.language.limits import MAX_CHARACTERS, MAX_IMPORTS, MAX_LIMIT, MAX_LIMIT_DIGITS, MAX_NESTING, MAX_TOKENS
from rosetta_jit.language.parse.rules import Context, read_parameter, read_rule, read_state, read_string
from rosetta_jit.language.parse.templates import grammar, tree_of
from rosetta_jit.language.parse.wires import message_of, read_type_name, read_wires
from rosetta_jit.model.mapping import Function, Import, Mapping, Rule, TypeName
from rosetta_jit.parsing.lalr import Token, Tree
from rosetta_jit.parsing.syntax import Recovery
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

NESTING = frozenset(
    ("binary", "negative", "inversion", "conditional", "table", "group", "call", "index", "slice", "list", "length", "loop", "when")
)
"""Rules of the grammar that one of their kind can stand in."""


ONLY_BEHIND = {"NAMES": ("_SAME",), "LIST": ("COLON",), "OF": ("LIST",), "WITH": ("NAMES",), "REST": ("IGNORE", "DEFAULT")}
"""Words that are words behind some tokens alone."""

RULES = ("START", "LEN", "FOR", "WHEN", "SET_STATE", "REJECT", "IGNORE", "DEFAULT", "_SAME")
"""Tokens that a rule begins with."""

BLOCKS = ("RULES", "UNPACK_RULES", "PACK_RULES")
"""Tokens that a block begins with: behind their colon stands no name of a type."""


def parse(source: Source) -> Mapping:
    """Read a mapping file; raises MappingError with all syntax errors that were found, each with its place."""
    if len(source.text) > MAX_CHARACTERS:
        raise MappingError((words.file_too_large(source.name, MAX_CHARACTERS),))
    text = " " + source.text[1:] if source.text.startswith("\ufeff") else source.text  # a byte order mark, as some editors write it
    tokens = list(islice(_told_apart(grammar().lex(text)), MAX_TOKENS + 1))
    refused = _too_many(tokens, source) or _too_deep(tokens, source)
    if refused is not None:
        raise MappingError((refused,))
    tree = tree_of(tokens, source, _recovery())
    if not isinstance(tree, Tree):
        raise MappingError(tuple(tree))
    return _Reader(source, []).read(tree)


def _told_apart(tokens: Iterator[Token]) -> Iterator[Token]:
    """Tells the `when` of a rejection from one that begins a block, and words from the names that they are elsewhere."""
    kinds = ("", "")
    for token in tokens:
        kind = token.type
        if kind == "WHEN" and kinds == ("REJECT", "STRING"):
            kind = "GUARD"
        if kind == "ROUNDING" and kinds[1] == "PARAMETER":
            kind = "NAME"
        if kind in ONLY_BEHIND and kinds[1] not in ONLY_BEHIND[kind]:
            kind = "NAME"
        if kind in {"STATE", "SET_STATE"} and (kinds[1] == "SLASH" or (kinds[1] == "COLON" and kinds[0] not in BLOCKS)):
            kind = "NAME"
        kinds = kinds[1], kind
        yield token if kind == token.type else token.of_kind(kind)


def _recovery() -> Recovery:
    statements = (
        "IMPORT",
        "PARAMETER",
        "STATE",
        "FUNCTION",
        "DATA_HOLDER",
        "WIRE_SCHEMA",
        "LIMIT",
        "ROUNDING",
        "EDITION",
        *BLOCKS,
        "END",
    )
    starts = {kind: kind for kind in statements} | dict.fromkeys(RULES, "FOR")
    return Recovery(
        starts, frozenset(RULES) - {"FOR"} | {"IMPORT"}, opens=frozenset({"FOR", "WHEN"}), closes="END", mistaken=frozenset({"IF"})
    )


def _too_many(tokens: list[Token], source: Source) -> Diagnostic | None:
    """The token, or the import, from which on there are too many."""
    imports = [token for token in tokens if token.type == "IMPORT"]
    for found, most, what in ((tokens, MAX_TOKENS, "words and signs"), (imports, MAX_IMPORTS, "imports")):
        if len(found) > most:
            return words.too_many(Span(source, found[most].start_pos, found[most].end_pos), what, most)
    return None


def _too_deep(tokens: list[Token], source: Source) -> Diagnostic | None:
    """The token at which brackets and loops nest too deeply, before the parser's stack grows with them."""
    depth = 0
    for token in tokens:
        if token.type in {"LPAR", "LSQB", "LBRACE", "FOR", "WHEN"}:
            depth += 1
        elif token.type in {"RPAR", "RSQB", "RBRACE", "END"}:
            depth = max(0, depth - 1)
        if depth > MAX_NESTING:
            return words.nesting(Span(source, token.start_pos, token.end_pos), MAX_NESTING)
    return None


@dataclass(frozen=True, slots=True)
class _Reader:
    """Turns the tree of one source into the model; problems are collected on the way."""

    source: Source
    problems: list[Diagnostic]

    def read(self, tree: Tree) -> Mapping:
        self._bound_depth(tree)
        statements = [child for child in tree.children if isinstance(child, Tree)]
        holder, holder_span = self._type_name(statements, "data_holder", "data-holder")
        wires = read_wires([child for child in statements if child.data == "wire_schema"], self.source, self.problems)
        wire, wire_span = (message_of(wires), wires[0].span) if wires else self._type_name(statements, "wire_schema", "wire-schema")
        is_old = self._is_old(statements)
        mapping = Mapping(
            self.source,
            tuple(self._import(child) for child in statements if child.data == "import_file"),
            holder,
            wire,
            self._rules(statements, "", Context(self.source, "holder", "wire", self.problems)),
            self._rules(statements, "unpack", Context(self.source, "holder", "wire", self.problems)),
            self._rules(statements, "pack", self.writing),
            holder_span,
            wire_span,
            tuple(self._function(child) for child in statements if child.data == "function"),
            tuple(read_parameter(child, self.writing) for child in statements if child.data == "parameter"),
            self._limit(statements),
            self._rounds(statements) or is_old,
            tuple(read_state(child, self.writing) for child in statements if child.data == "state"),
            is_old,
            wires,
        )
        if self.problems:
            raise MappingError(tuple(sorted(self.problems, key=lambda problem: problem.span.start if problem.span else 0)))
        return mapping

    @property
    def writing(self) -> Context:
        """Of expressions that stand in statements; of rules to pack."""
        return Context(self.source, "wire", "holder", self.problems)

    def _bound_depth(self, tree: Tree) -> None:
        """Refuse operator chains and paths that are too long, without recursion of our own."""
        pending = [(tree, 0)]
        while pending:
            node, depth = pending.pop()
            if depth > MAX_NESTING or (node.data == "path" and len(node.children) > MAX_NESTING):
                raise MappingError((words.nesting(self._span(node), MAX_NESTING),))
            # Statements, rules and blocks are already bounded by the nesting of `for` … `end`.
            inner = depth + 1 if node.data in NESTING else depth
            pending += [(child, inner) for child in node.children if isinstance(child, Tree)]

    def _import(self, tree: Tree) -> Import:
        token = _token(tree)
        return Import(read_string(token, self.source, self.problems), self._token_span(token))

    def _function(self, tree: Tree) -> Function:
        name, *types = (child for child in tree.children if isinstance(child, Token) and child.type == "NAME")
        *parameters, result = (TypeName(str(token), self._token_span(token)) for token in types)
        return Function(str(name), tuple(parameters), result, self._span(tree))

    def _type_name(self, statements: list[Tree], rule: str, keyword: str) -> tuple[str, Span | None]:
        found = self._only(statements, rule, keyword)
        if found is None:
            self.problems.append(words.missing_statement(Span(self.source, 0, 0), keyword))
            return "", None
        return read_type_name(found, self.source, self.problems)

    def _limit(self, statements: list[Tree]) -> int | None:
        found = self._only(statements, "limit", "limit")
        if found is None:
            return None
        token = next(child for child in found.children if isinstance(child, Token) and child.type == "INTEGER")
        if len(token) > MAX_LIMIT_DIGITS or int(token, 0) > MAX_LIMIT:
            self.problems.append(words.limit_too_large(self._token_span(token), MAX_LIMIT))
            return None
        return int(token, 0)

    def _rounds(self, statements: list[Tree]) -> bool:
        """Whether the mapping says that what is set to float32 is rounded."""
        found = self._only(statements, "rounding", "rounding")
        if found is None:
            return False
        type_ = next(child for child in found.children if isinstance(child, Token) and child.type == "NAME")
        if type_ != "float32":
            self.problems.append(words.rounding_type(self._token_span(type_), str(type_)))
        return True

    def _is_old(self, statements: list[Tree]) -> bool:
        """Whether the mapping says that it is one of 2012."""
        found = self._only(statements, "edition", "edition")
        if found is None:
            return False
        year = next(child for child in found.children if isinstance(child, Token) and child.type == "INTEGER")
        if year != "2012":
            self.problems.append(words.unknown_edition(self._token_span(year), str(year)))
        return True

    def _rules(self, statements: list[Tree], direction: str, context: Context) -> tuple[Rule, ...] | None:
        block = self._only(statements, f"{direction}_rules".lstrip("_"), f"{direction}-rules".lstrip("-"))
        if block is None:
            return None
        return tuple(read_rule(child, context) for child in block.children if isinstance(child, Tree))

    def _only(self, statements: list[Tree], rule: str, keyword: str) -> Tree | None:
        found = [child for child in statements if child.data == rule]
        self.problems.extend(words.repeated_statement(self._span(extra), keyword) for extra in found[1:])
        return found[0] if found else None

    def _span(self, tree: Tree) -> Span:
        return Span(self.source, tree.start_pos, tree.end_pos)

    def _token_span(self, token: Token) -> Span:
        return Span(self.source, token.start_pos, token.end_pos)


def _token(tree: Tree) -> Token:
    (token,) = (child for child in tree.children if isinstance(child, Token))
    return token
