"""The rules of the grammar below declarations: names, types, constant expressions, annotations."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.cursor import Cursor, SyntaxProblem
from rosetta_jit.frameworks.omg.expressions import ARITHMETIC, Expr, Literal, Operators, ScopedName, expression
from rosetta_jit.frameworks.omg.lexer import FOLDED, KEYWORDS, SCALARS, SERVICES
from rosetta_jit.frameworks.omg.limits import MAX_NESTING
from rosetta_jit.frameworks.omg.tree import Aggregate, Annotation, Basic, Enum, MapOf, Name, Sequence, Text, TypeSpec, Unsupported

LITERALS = ("number", "string", "wstring", "char", "wchar")

Node = TypeVar("Node")


class TypeReader:
    """Reads names and types. ``modules`` are those around the cursor."""

    __slots__ = ("_depth", "cursor", "modules", "problems")

    def __init__(self, cursor: Cursor, problems: list[Diagnostic]) -> None:
        self.cursor = cursor
        self.problems = problems
        self.modules: list[str] = []
        self._depth = 0

    def constructed(self, annotations: tuple[Annotation, ...] = ()) -> Aggregate | Enum:
        """A struct, union or enum that is declared where a type is wanted."""
        raise NotImplementedError

    def nested(self, read: Callable[[], Node]) -> Node:
        """Read something that may hold more of its kind."""
        if self._depth >= MAX_NESTING:
            raise SyntaxProblem(say.nesting(self.cursor.token.span, MAX_NESTING, "declarations and types"))
        self._depth += 1
        try:
            return read()
        finally:
            self._depth -= 1

    # Names

    @property
    def in_rosidl(self) -> bool:
        """Whether the cursor is in a module that rosidl wrote: names there are not checked against keywords."""
        return len(self.modules) > 1 and self.modules[1] in SERVICES

    def name(self) -> Name:
        """The name of a declaration; one that starts with an underscore is what follows it, and no keyword."""
        token = self.cursor.token
        if token.kind != "word":
            self.cursor.fail("a name")
        text = token.text
        if text.startswith("_"):
            if not text[1:2].isalpha():
                raise SyntaxProblem(say.unexpected(token.span, text, "a name that starts with a letter"))
        elif text.lower() in FOLDED and not self.in_rosidl:
            raise SyntaxProblem(say.keyword(token.span, text, FOLDED[text.lower()]))
        self.cursor.take()
        return Name(text.removeprefix("_"), token.span, self.in_rosidl)

    def scoped_name(self) -> ScopedName:
        first = self.cursor.token
        absolute = self.cursor.accept("::") is not None
        parts = [self.part()]
        while self.cursor.accept("::"):
            parts.append(self.part())
        return ScopedName(tuple(parts), absolute, self.cursor.since(first))

    def part(self) -> str:
        token = self.cursor.token
        if token.kind != "word" or (token.text in KEYWORDS and not self.in_rosidl):
            self.cursor.fail("a name")
        return self.cursor.take().text.removeprefix("_")

    # Types

    def declared_type(self) -> TypeSpec:
        """A type that may be declared on the spot."""
        return self.constructed() if self.cursor.sees("struct", "union", "enum") else self.type()

    def type(self) -> TypeSpec:
        token = self.cursor.token
        if token.kind not in ("word", "symbol"):
            self.cursor.fail("a type")
        match token.text:
            case "sequence":
                return self.nested(self.sequence)
            case "map" if self.cursor.following.text == "<":
                return self.nested(self.map)
            case "string" | "wstring" as word:
                self.cursor.take()
                bound = self.bound() if self.cursor.accept("<") else None
                return Text(word, bound, self.cursor.since(token))
            case "long" | "unsigned":
                return self.integer()
            case "any" | "Object" | "ValueBase" | "fixed":
                return self.unsupported()
            case text if text in SCALARS:
                return Basic(self.cursor.take().text, token.span)
            case text if text == "::" or (token.kind == "word" and text not in KEYWORDS):
                return self.scoped_name()
            case _:
                self.cursor.fail("a type")
                raise AssertionError

    def sequence(self) -> Sequence:
        first = self.cursor.take()
        self.cursor.expect("<")
        element = self.type()
        bound = self.bound() if self.cursor.accept(",") else self.close()
        return Sequence(element, bound, self.cursor.since(first))

    def map(self) -> MapOf:
        first = self.cursor.take()
        self.cursor.expect("<")
        key = self.type()
        self.cursor.expect(",")
        value = self.type()
        bound = self.bound() if self.cursor.accept(",") else self.close()
        return MapOf(key, value, bound, self.cursor.since(first))

    def bound(self) -> Expr:
        bound = expression(self.cursor, Operators(("-", "+", "~"), ARITHMETIC, self.operand, in_angles=True))
        self.close()
        return bound

    def close(self) -> None:
        self.cursor.expect(">")

    def integer(self) -> Basic | Unsupported:
        first = self.cursor.take()
        words = [first.text]
        if first.text == "unsigned":
            if not self.cursor.sees("short", "long"):
                self.cursor.fail("`short` or `long`")
            words.append(self.cursor.take().text)
        if words[-1] == "long" and self.cursor.sees("long"):
            words.append(self.cursor.take().text)
        elif words == ["long"] and self.cursor.accept("double"):
            return Unsupported("long double", self.cursor.since(first))
        return Basic(" ".join(words), self.cursor.since(first))

    def unsupported(self) -> Unsupported:
        first = self.cursor.take()
        if first.text == "fixed" and self.cursor.accept("<"):
            expression(self.cursor, Operators((), ARITHMETIC, self.operand, in_angles=True))
            self.cursor.expect(",")
            self.bound()
        return Unsupported(first.text, self.cursor.since(first))

    # Constants and annotations

    def constant_expression(self) -> Expr:
        return expression(self.cursor, Operators(("-", "+", "~"), ARITHMETIC, self.operand))

    def operand(self, cursor: Cursor) -> Expr:
        first = cursor.token
        if first.kind == "word" and first.text in ("TRUE", "FALSE"):
            cursor.take()
            return Literal((first,), first.span)
        if first.kind == "word" or cursor.sees("::"):
            return self.scoped_name()
        if first.kind not in LITERALS:
            cursor.fail("a constant")
        tokens = [cursor.take()]
        while first.kind in ("string", "wstring") and cursor.token.kind == first.kind:
            tokens.append(cursor.take())
        return Literal(tuple(tokens), cursor.since(first))

    def annotations(self) -> tuple[Annotation, ...]:
        found: list[Annotation] = []
        while self.cursor.sees("@"):
            found.append(self.annotation())
        return tuple(found)

    def annotation(self) -> Annotation:
        first = self.cursor.take()
        absolute = self.cursor.accept("::")
        words = [self.word()]
        while self.cursor.accept("::"):
            words.append(self.word())
        name = ("::" if absolute else "") + "::".join(words)
        arguments = self.arguments() if self.cursor.sees("(") else ()
        return Annotation(name, arguments, self.cursor.since(first))

    def word(self) -> str:
        """A name that may be a keyword: `@default`."""
        return self.cursor.take().text if self.cursor.token.kind == "word" else self.cursor.fail("a name").text

    def arguments(self) -> tuple[tuple[str, Expr], ...]:
        self.cursor.expect("(")
        found: list[tuple[str, Expr]] = []
        while not self.cursor.sees(")"):
            if found:
                self.cursor.expect(",")
            named = self.cursor.token.kind == "word" and self.cursor.following.text == "="
            name = self.cursor.take().text if named else ""
            if named:
                self.cursor.expect("=")
            found.append((name, self.constant_expression()))
        self.cursor.expect(")")
        return tuple(found)
