"""Tokens to definitions, by recursive descent: one method a rule (OMG IDL 4.2, 7.4).

After a mistake the statement around it is skipped, and the next one is read.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg.cursor import Cursor, SyntaxProblem
from rosetta_jit.frameworks.omg.expressions import Expr, ScopedName
from rosetta_jit.frameworks.omg.grammar_types import TypeReader
from rosetta_jit.frameworks.omg.lexer import OPAQUE, SKIPPED, Token
from rosetta_jit.frameworks.omg.limits import MAX_SYNTAX_ERRORS
from rosetta_jit.frameworks.omg.tree import (
    Aggregate,
    Annotation,
    Constant,
    Declarator,
    Definition,
    Enum,
    Enumerator,
    Interface,
    Member,
    Module,
    Name,
    Opaque,
    Typedef,
)

OPENING, CLOSING = ("{", "(", "["), ("}", ")", "]")


class _TooMany(Exception):  # noqa: N818  it ends the reading, and is no error of ours
    """`MAX_SYNTAX_ERRORS` are reached."""


def parse(tokens: list[Token], problems: list[Diagnostic]) -> tuple[Definition, ...]:
    """The definitions of a file; those that cannot be read are problems."""
    reader = _Reader(Cursor(tokens), problems)
    try:
        return reader.definitions(closed=False)
    except _TooMany:
        return ()


class _Reader(TypeReader):
    __slots__ = ("_errors",)

    def __init__(self, cursor: Cursor, problems: list[Diagnostic]) -> None:
        super().__init__(cursor, problems)
        self._errors = 0

    def definitions(self, *, closed: bool) -> tuple[Definition, ...]:
        """Definitions up to the brace that closes them, or to the end of the file."""
        found: list[Definition] = []
        self.statements(lambda: found.extend(self.definition()), closed=closed)
        return tuple(found)

    def statements(self, statement: Callable[[], object], *, closed: bool = True) -> None:
        """Read statements up to a closing brace, skipping those that are wrong."""
        cursor = self.cursor
        while cursor.token.kind != "end" and not (closed and cursor.sees("}")):
            before = cursor.index
            try:
                statement()
            except SyntaxProblem as error:
                self.problems.append(error.problem)
                self._errors += 1
                if self._errors >= MAX_SYNTAX_ERRORS:
                    raise _TooMany from error
                self.skip(before, closed=closed)

    def skip(self, start: int, *, closed: bool) -> None:
        """Go behind the statement that the cursor is in, or before the brace that closes the one around it."""
        cursor, depth = self.cursor, 0
        while cursor.token.kind != "end":
            if cursor.sees("}") and depth == 0 and closed:
                break
            token = cursor.take()
            depth = max(0, depth + (token.text == "{") - (token.text == "}")) if token.kind == "symbol" else depth
            if depth == 0 and token.text == ";" and cursor.index > start:
                break

    # Definitions

    def definition(self) -> tuple[Definition, ...]:
        if self.cursor.sees("@") and self.cursor.following.text == "annotation":
            return self.skipped()
        annotations = self.annotations()
        word = self.cursor.token
        if word.kind != "word":
            self.cursor.fail("a declaration")
        match word.text:
            case "module":
                return (self.nested(lambda: self.module(annotations)),)
            case "struct" | "union" | "exception" | "enum":
                return self.ended(self.constructed(annotations))
            case "typedef":
                self.cursor.take()
                type_ = self.declared_type()
                return self.ended(Typedef(type_, self.declarators()))
            case "const":
                return self.ended(self.constant(annotations))
            case "abstract" | "local" | "custom" | "interface" | "valuetype":
                return self.interface()
            case text if text in OPAQUE:
                return self.opaque()
            case text if text in SKIPPED:
                return self.skipped()
            case _:
                self.cursor.fail("a declaration")
                raise AssertionError

    def ended(self, *found: Definition) -> tuple[Definition, ...]:
        self.cursor.expect(";")
        return found

    def module(self, annotations: tuple[Annotation, ...]) -> Module:
        self.cursor.take()
        name = self.name()
        self.modules.append(name.text)
        try:
            self.cursor.expect("{")
            first = self.cursor.token
            definitions = self.definitions(closed=True)
            if not definitions and self.cursor.token is first:
                self.cursor.fail("a declaration")
            self.cursor.expect("}")
            self.cursor.expect(";")
        finally:
            self.modules.pop()
        return Module(name, definitions, annotations)

    def constructed(self, annotations: tuple[Annotation, ...] = ()) -> Aggregate | Enum:
        """A struct, union, enum or exception, from its word to its closing brace."""
        word = self.cursor.take().text
        name = self.name()
        match word:
            case "enum":
                return self.enum(name, annotations)
            case "union":
                return self.nested(lambda: self.union(name, annotations))
            case "struct":
                return self.nested(lambda: self.struct(name, annotations))
            case _:
                return Aggregate("exception", name, self.nested(self.members))

    def struct(self, name: Name, annotations: tuple[Annotation, ...]) -> Aggregate:
        if self.cursor.sees(";"):
            return Aggregate("struct", name, None)
        base = self.scoped_name() if self.cursor.accept(":") else None
        return Aggregate("struct", name, self.members(), base=base, annotations=annotations)

    def members(self) -> tuple[Member, ...]:
        found: list[Member] = []
        self.cursor.expect("{")
        self.statements(lambda: found.append(self.member()))
        self.cursor.expect("}")
        return tuple(found)

    def member(self) -> Member:
        annotations = self.annotations()
        member = Member(self.declared_type(), self.declarators(), annotations)
        self.cursor.expect(";")
        return member

    def union(self, name: Name, annotations: tuple[Annotation, ...]) -> Aggregate:
        if self.cursor.sees(";"):
            return Aggregate("union", name, None)
        for text in ("switch", "("):
            self.cursor.expect(text)
        switch_annotations = self.annotations()
        switch = self.declared_type()
        for text in (")", "{"):
            self.cursor.expect(text)
        cases: list[Member] = []
        first = self.cursor.token
        self.statements(lambda: cases.append(self.case()))
        if not cases and self.cursor.token is first:
            self.cursor.fail("a case")
        self.cursor.expect("}")
        return Aggregate("union", name, tuple(cases), None, switch, switch_annotations, annotations)

    def case(self) -> Member:
        labels: list[Expr | None] = []
        annotations = self.annotations()
        while self.cursor.sees("case", "default"):
            labels.append(self.constant_expression() if self.cursor.take().text == "case" else None)
            self.cursor.expect(":")
            annotations += self.annotations()
        if not labels:
            self.cursor.fail("`case` or `default`")
        member = Member(self.declared_type(), (self.declarator(),), annotations, tuple(labels))
        self.cursor.expect(";")
        return member

    def enum(self, name: Name, annotations: tuple[Annotation, ...]) -> Enum:
        self.cursor.expect("{")
        found = [self.enumerator()]
        while self.cursor.accept(","):
            found.append(self.enumerator())
        self.cursor.expect("}")
        return Enum(name, tuple(found), annotations)

    def enumerator(self) -> Enumerator:
        annotations = self.annotations()
        return Enumerator(self.name(), annotations)

    def constant(self, annotations: tuple[Annotation, ...]) -> Constant:
        self.cursor.take()
        type_ = self.type()
        name = self.name()
        self.cursor.expect("=")
        return Constant(type_, name, self.constant_expression(), annotations)

    def declarators(self) -> tuple[Declarator, ...]:
        found = [self.declarator()]
        while self.cursor.accept(","):
            found.append(self.declarator())
        return tuple(found)

    def declarator(self) -> Declarator:
        name = self.name()
        dimensions: list[Expr] = []
        while self.cursor.accept("["):
            dimensions.append(self.constant_expression())
            self.cursor.expect("]")
        return Declarator(name, tuple(dimensions))

    # What is skipped but for the types in it

    def interface(self) -> tuple[Definition, ...]:
        while self.cursor.sees("abstract", "local", "custom"):
            self.cursor.take()
        if not self.cursor.sees("interface", "valuetype"):
            self.cursor.fail("`interface` or `valuetype`")
        word: Literal["interface", "valuetype"] = "interface" if self.cursor.take().text == "interface" else "valuetype"
        name = self.name()
        if self.cursor.sees(";"):
            return self.ended(Interface(word, name, (), None))
        if word == "valuetype" and not self.cursor.sees(":", "{", "supports"):
            self.rest_of_statement()
            return (Interface(word, name, (), ()),)
        return (self.nested(lambda: self.interface_body(name, word)),)

    def interface_body(self, name: Name, word: Literal["interface", "valuetype"]) -> Interface:
        bases = self.bases()
        self.cursor.expect("{")
        found: list[Definition] = []
        self.statements(lambda: found.extend(self.export()))
        self.cursor.expect("}")
        self.cursor.expect(";")
        return Interface(word, name, bases, tuple(found))

    def bases(self) -> tuple[ScopedName, ...]:
        found: list[ScopedName] = []
        while self.cursor.sees(":", ",", "supports"):
            self.cursor.take()
            self.cursor.accept("truncatable")
            found.append(self.scoped_name())
        return tuple(found)

    def export(self) -> tuple[Definition, ...]:
        """A type in an interface, or an operation, attribute or state, which is skipped."""
        annotations = self.cursor.sees("@")
        if annotations or self.cursor.sees("struct", "union", "exception", "enum", "typedef", "const", "native"):
            return self.definition()
        return self.skipped()

    def opaque(self) -> tuple[Definition, ...]:
        word = self.cursor.take().text
        name = self.name()
        self.rest_of_statement()
        return (Opaque(word, name),)

    def skipped(self) -> tuple[Definition, ...]:
        self.rest_of_statement()
        return ()

    def rest_of_statement(self) -> None:
        """Go behind the semicolon that ends the statement, over all brackets in it."""
        depth = 0
        while not (depth == 0 and self.cursor.sees(";")):
            if self.cursor.token.kind in ("end", "wrong") or (depth == 0 and self.cursor.sees(*CLOSING)):
                self.cursor.fail("`;`")
            depth += self.cursor.sees(*OPENING) - self.cursor.sees(*CLOSING)
            self.cursor.take()
        self.cursor.take()
