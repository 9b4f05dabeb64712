"""The preprocessor: `#include`, `#define` without parameters, and conditionals (OMG IDL 4.2, 7.3).

A file is read once, however often it is included: what rosidl writes has no include guards.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.omg import diagnostics as say
from rosetta_jit.frameworks.omg.conditions import answer_defined, holds
from rosetta_jit.frameworks.omg.cursor import SyntaxProblem
from rosetta_jit.frameworks.omg.lexer import LiteralError, Token, tokens, unescape
from rosetta_jit.frameworks.omg.limits import MAX_EXPANDED, MAX_FILES
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load


PREDEFINED = "__OMNIIDL__"
"""Files for several CORBA compilers tell omniidl by this macro; we read what it reads."""

IGNORED = frozenset(("pragma", "ident", "line", "warning"))


@dataclass(slots=True)
class _Condition:
    """An `#if` that is open: whether its lines count now, and whether one of its groups has counted already."""

    first: Token
    outer: bool
    active: bool
    taken: bool
    last: bool = False


@dataclass(slots=True)
class _File:
    name: str
    lines: Iterator[list[Token]]
    conditions: list[_Condition] = field(default_factory=list["_Condition"])

    @property
    def active(self) -> bool:
        return not self.conditions or self.conditions[-1].active


def preprocess(source: Source, load: Load, problems: list[Diagnostic]) -> tuple[list[Token], tuple[str, ...]]:
    """The tokens of a file and of all that it includes, and the names of these files."""
    reader = _Preprocessor(load, problems)
    reader.macros[PREDEFINED] = (Token("number", "1", Span(source, 0, 0)),)
    reader.open(source.name, source)
    reader.run()
    end = Span(source, len(source.text), len(source.text))
    return [*reader.out, Token("end", "", end)], tuple(reader.seen)


@dataclass(slots=True)
class _Preprocessor:
    load: Load
    problems: list[Diagnostic]
    out: list[Token] = field(default_factory=list[Token])
    seen: dict[str, None] = field(default_factory=dict[str, None])
    stack: list[_File] = field(default_factory=list[_File])
    macros: dict[str, tuple[Token, ...]] = field(default_factory=dict[str, tuple[Token, ...]])
    expanded: int = 0

    def open(self, name: str, source: Source) -> None:
        self.seen[source.name] = None
        self.stack.append(_File(name, _lines(source)))

    def run(self) -> None:
        """Line after line of the innermost file that is open; each `#include` opens one more."""
        while self.stack:
            file = self.stack[-1]
            line = next(file.lines, None)
            if line is None:
                self.problems += [say.open_condition(each.first.span) for each in file.conditions]
                self.stack.pop()
            elif line[0].text == "#" and line[0].kind == "symbol":
                self.guarded(line, file)
            elif file.active:
                self.text(line[:-1])

    def text(self, line: list[Token]) -> None:
        try:
            self.out += self.expand(line)
        except SyntaxProblem as error:
            self.problems.append(error.problem)
            self.stack.clear()

    def guarded(self, line: list[Token], file: _File) -> None:
        try:
            self.directive(line, file)
        except SyntaxProblem as error:
            self.problems.append(error.problem)

    def directive(self, line: list[Token], file: _File) -> None:
        word, rest = line[1], line[2:]
        if word.text in ("if", "ifdef", "ifndef", "elif", "else", "endif"):
            self.condition(word, rest, file)
        elif file.active and word.kind == "word" and word.text not in IGNORED:
            self.command(word, rest, file)
        elif file.active and word.kind not in ("word", "number", "newline"):
            raise SyntaxProblem(say.unknown_directive(word.span, word.text))

    def command(self, word: Token, rest: list[Token], file: _File) -> None:
        match word.text:
            case "include":
                self.include(word, rest, file)
            case "define":
                name = _name(rest)
                if rest[1].text == "(" and rest[1].span.start == name.span.end:
                    raise SyntaxProblem(say.macro_parameters(name.span.to(rest[1].span), name.text))
                self.macros[name.text] = tuple(rest[1:-1])
            case "undef":
                self.macros.pop(_name(rest).text, None)
            case "error":
                raise SyntaxProblem(say.user_error(word.span.to(rest[-1].span)))
            case _:
                raise SyntaxProblem(say.unknown_directive(word.span, word.text))

    def condition(self, word: Token, rest: list[Token], file: _File) -> None:
        if word.text in ("if", "ifdef", "ifndef"):
            outer = file.active
            file.conditions.append(_Condition(word, outer, active=False, taken=not outer))
        if not file.conditions:
            raise SyntaxProblem(say.no_condition(word.span, word.text))
        top = file.conditions[-1]
        if word.text == "endif":
            file.conditions.pop()
            return
        if top.last:
            raise SyntaxProblem(say.after_else(word.span, word.text))
        top.last = word.text == "else"
        top.active = False
        if not top.taken:
            top.active = top.taken = self.is_true(word, rest)

    def is_true(self, word: Token, rest: list[Token]) -> bool:
        match word.text:
            case "else":
                return True
            case "ifdef":
                return _name(rest).text in self.macros
            case "ifndef":
                return _name(rest).text not in self.macros
            case _:
                known = list(answer_defined(rest[:-1], self.macros))
                return holds(list(self.expand(known)), Token("end", "\n", rest[-1].span))

    def include(self, word: Token, rest: list[Token], file: _File) -> None:
        path, span = _path(word, rest if rest[0].kind == "string" or rest[0].text == "<" else [*self.expand(rest[:-1]), rest[-1]])
        found = find(path, file.name, self.load)
        if found is None:
            raise SyntaxProblem(say.missing_file(span, path))
        found_as, source = found
        if source.name not in self.seen:
            if len(self.seen) >= MAX_FILES:
                raise SyntaxProblem(say.too_many_files(span, MAX_FILES))
            self.open(found_as, source)

    def expand(self, line: Iterable[Token]) -> Iterator[Token]:
        """The tokens of a line, with macros in place of their names; a macro is not expanded within itself."""
        for token in line:
            if token.kind == "word" and token.text in self.macros:
                yield from self.macro(token)
            else:
                yield token

    def macro(self, use: Token) -> Iterator[Token]:
        inner: dict[str, Iterator[Token]] = {use.text: iter(self.macros[use.text])}
        while inner:
            token = next(inner[next(reversed(inner))], None)
            self.expanded += 1
            if self.expanded > MAX_EXPANDED:
                raise SyntaxProblem(say.expansion(use.span, MAX_EXPANDED))
            if token is None:
                inner.popitem()
            elif token.kind == "word" and token.text in self.macros and token.text not in inner:
                inner[token.text] = iter(self.macros[token.text])
            else:
                yield Token(token.kind, token.text, use.span)


def _lines(source: Source) -> Iterator[list[Token]]:
    """Each line with the newline that ends it."""
    line: list[Token] = []
    for token in tokens(source):
        line.append(token)
        if token.kind == "newline":
            yield line
            line = []


def _name(rest: list[Token]) -> Token:
    if rest[0].kind != "word" or rest[0].text == "defined":
        raise SyntaxProblem(say.unexpected(rest[0].span, rest[0].text.strip() or "end of line", "the name of a macro"))
    return rest[0]


def _path(word: Token, rest: list[Token]) -> tuple[str, Span]:
    """The path that an `#include` writes in quotes or angle brackets."""
    first = rest[0]
    if first.kind == "string":
        try:
            return unescape(first.text[1:-1], wide=False), first.span
        except LiteralError as error:
            raise SyntaxProblem(say.wrong_literal(first.span, str(error))) from error
    closing = next((token for token in rest if token.text == ">"), None)
    if first.text != "<" or closing is None:
        raise SyntaxProblem(say.unexpected(word.span, "include", "a file name in quotes or angle brackets"))
    span = first.span.to(closing.span)
    return span.source.text[first.span.end : closing.span.start], span


SHIPPED = ("", "openrtm", "ros2")
"""Folders of the search path in which files know each other by their names alone."""


def find(path: str, name: str, load: Load) -> tuple[str, Source] | None:
    """The file that an `#include` means, and the name under which it was found.

    Parameters
    ----------
    path
        As the `#include` writes it.
    name
        The name under which the file around it was found: its folder comes first.
    """
    for candidate in dict.fromkeys(_candidates(path, name)):
        source = load(candidate)
        if source is not None:
            return candidate, source
    return None


def _candidates(path: str, name: str) -> Iterator[str]:
    folder = PurePosixPath(name).parent
    for start in (*(() if folder.is_absolute() else (str(folder),)), *SHIPPED):
        candidate = _normal(f"{start}/{path}" if start not in ("", ".") else path)
        if candidate is not None:
            yield candidate


def _normal(path: str) -> str | None:
    """The path without `.` and `..`; None where it leaves the search path, or is no name of a file."""
    if path.startswith(("/", "~")) or "\\" in path or ":" in path or not path.isprintable():
        return None
    parts: list[str] = []
    for part in path.split("/"):
        if part == ".." and not parts:
            return None
        if part == "..":
            parts.pop()
        elif part not in ("", "."):
            parts.append(part)
    return "/".join(parts) or None
