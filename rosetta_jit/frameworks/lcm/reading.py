"""Text to words, cut where lcm-gen cuts it, and words to declarations.

A name ends at white space, at an operator, and at any of ``( ) ; " , : ' [ ]``; braces and slashes do not end it. So ``struct t{`` is the
beginning of a struct named ``t{`` to lcm-gen, and ``a//text`` a field. Here such words are cut, and the missing space is a problem.

What cannot be read is reported and skipped, up to the next statement, and reading goes on.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import TypeVar

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.limits import MAX_PROBLEMS
from rosetta_jit.frameworks.lcm.tree import Constant, Declaration, EnumDeclaration, File, Item, Member, Name, StructDeclaration, Word
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass

T = TypeVar("T")

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
DOTTED = re.compile(rf"{IDENTIFIER.pattern}(\.{IDENTIFIER.pattern})*")

_STARTS = frozenset(("package", "struct", "enum"))


def read(source: Source, problems: list[Diagnostic]) -> File:
    """The declarations of a file, as far as they can be read."""
    found = tokens(source, problems)
    return File(source, _Reader(source, found, problems).declarations())


class _Unreadable(Exception):  # noqa: N818  it says that a statement is given up, and its problem is reported
    """The statement cannot be read on."""


@dataclass(slots=True)
class _Reader:
    source: Source
    tokens: list[Token]
    problems: list[Diagnostic]
    index: int = 0
    package: str = ""

    # --- words -------------------------------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The next word; empty at the end."""
        return self.tokens[self.index].text if self.index < len(self.tokens) else ""

    @property
    def span(self) -> Span:
        """The place of the next word; at the end, the place right behind the last one."""
        if self.index < len(self.tokens):
            token = self.tokens[self.index]
            return Span(self.source, token.start, token.end)
        end = self.tokens[-1].end if self.tokens else 0
        return Span(self.source, end, end)

    @property
    def doc(self) -> str:
        return comment_before(self.source, self.tokens[self.index]) if self.text else ""

    def take(self) -> Name:
        name = Name(self.text, self.span)
        self.index += 1
        return name

    def taken(self, text: str) -> bool:
        """Whether the next word is that one, which is then behind us."""
        if self.text != text:
            return False
        self.index += 1
        return True

    def need(self, text: str) -> None:
        if not self.taken(text):
            raise self.wrong(f"`{text}`")

    def name(self, what: str, pattern: re.Pattern[str] = IDENTIFIER) -> Name:
        if not pattern.fullmatch(self.text):
            raise self.wrong(what)
        return self.take()

    def wrong(self, wanted: str, help_: str = "") -> _Unreadable:
        self.problems.append(say.unexpected(self.span, self.text, wanted, help_) if self.text else say.unfinished(self.span, wanted))
        return _Unreadable()

    def skip(self) -> None:
        """Go behind the next ``;``, or to the ``}`` that closes what is open, whatever blocks lie between."""
        depth = 0
        while self.text and (depth or self.text != "}"):
            word = self.take().text
            depth += (word == "{") - (word == "}")
            if word == ";" and depth == 0:
                return

    # --- files -------------------------------------------------------------------------------------------------------

    def declarations(self) -> tuple[Declaration, ...]:
        found: list[Declaration] = []
        while self.text and len(self.problems) < MAX_PROBLEMS:
            try:
                declared = self.declaration()
            except _Unreadable:
                self.skip_to_declaration()
            else:
                found += declared
        return tuple(found)

    def skip_to_declaration(self) -> None:
        """Go to the next word that begins a declaration; those inside a block begin none."""
        depth = 0
        while self.text and (depth or self.text not in _STARTS):
            word = self.take().text
            depth = max(0, depth + (word == "{") - (word == "}"))

    def declaration(self) -> list[Declaration]:
        doc = self.doc
        if self.taken("package"):
            package = self.name("the name of a package", DOTTED).text
            self.need(";")
            self.package = package
            return []
        if self.taken("struct"):
            return [self.struct(doc)]
        if self.taken("enum"):
            return [self.enum()]
        behind = self.index and self.tokens[self.index - 1].text == "}" and self.text == ";"
        raise self.wrong("`package`, `struct` or `enum`", "No `;` stands behind a declaration." if behind else "")

    def struct(self, doc: str) -> StructDeclaration:
        name = self.name("the name of a struct", DOTTED)
        self.need("{")
        items = self.block(self.items)
        return StructDeclaration(self.package, name, tuple(items), doc)

    def enum(self) -> EnumDeclaration:
        name = self.name("the name of an enum", DOTTED)
        self.need("{")
        words = self.block(lambda: [self.word()])
        return EnumDeclaration(self.package, name, tuple(words))

    def block(self, statement: Callable[[], list[T]]) -> list[T]:
        """Statements up to the closing brace."""
        found: list[T] = []
        while not self.taken("}"):
            if not self.text or len(self.problems) >= MAX_PROBLEMS:
                raise self.wrong("`}`")
            try:
                found += statement()
            except _Unreadable:
                self.skip()
        return found

    # --- statements --------------------------------------------------------------------------------------------------

    def items(self) -> list[Item]:
        doc = self.doc
        if self.text in {"struct", "enum"}:
            self.problems.append(say.nested(self.span, self.text))
            raise _Unreadable
        if self.taken("const"):
            type_ = self.name("the type of a constant")
            return list(self.listed(lambda: self.constant(type_, doc)))
        type_ = self.name("a type", DOTTED)
        return list(self.listed(lambda: self.member(type_, doc)))

    def listed(self, read: Callable[[], T]) -> list[T]:
        """One or more of them, with commas between and a semicolon behind."""
        found = [read()]
        while self.taken(","):
            found.append(read())
        self.need(";")
        return found

    def constant(self, type_: Name, doc: str) -> Constant:
        name = self.name("the name of a constant")
        self.need("=")
        if not self.text or self.text in ",;}":
            raise self.wrong("a number")
        return Constant(type_, name, self.take(), doc)

    def member(self, type_: Name, doc: str) -> Member:
        name = self.name("the name of a field")
        sizes: list[Name] = []
        while self.taken("["):
            if not self.text or self.text in ",;[]{}":
                raise self.wrong("a size: a number, a constant, or an integer field")
            sizes.append(self.take())
            self.need("]")
        return Member(type_, name, tuple(sizes), doc)

    def word(self) -> Word:
        name = self.name("the name of an enumerator")
        number = None
        if self.taken("="):
            if not self.text or self.text in ",;}":
                raise self.wrong("a number")
            number = self.take()
        self.taken(",")
        self.taken(";")
        return Word(name, number)


_SPACE = r" \t\n\v\f\r"
_ENDS = r"();\",:'\[\]!~<>=&|^%*+"

_WORDS = re.compile(
    rf"""
      (?P<space> [{_SPACE}]+)
    | (?P<comment> //[^\n]* | /\*.*?\*/)
    | (?P<unclosed> /\*.*)
    | (?P<text> "[^"\n]*"? | '[^'\n]*'?)
    | (?P<operator> [!~<>=&|^%*+]+)
    | (?P<mark> [();,:\[\]])
    | (?P<brace> [{{}}])
    | (?P<name> / | [^{_SPACE}{_ENDS}{{}}/]+)
    """,
    re.VERBOSE | re.DOTALL,
)

_NOT_CUT = frozenset(("name", "brace"))
"""What lcm-gen reads on from, if no space stands behind it."""


@dataclass(frozen=True, slots=True)
class Token:
    """A word and where it stands. ``behind`` is where the one before it ends: comments lie between."""

    text: str
    start: int
    end: int
    behind: int


def tokens(source: Source, problems: list[Diagnostic]) -> list[Token]:
    """The words of a text, without its comments."""
    return list(_tokens(source, problems))


def _tokens(source: Source, problems: list[Diagnostic]) -> Iterator[Token]:
    before, behind = "", 0
    for match in _WORDS.finditer(source.text):
        kind = match.lastgroup or ""
        start, end = match.span()
        if before in _NOT_CUT and kind in {"name", "brace", "comment", "unclosed"} and len(problems) < MAX_PROBLEMS:
            problems.append(say.no_space(Span(source, start, min(end, start + 2 if kind == "comment" else end))))
        if kind == "unclosed":
            problems.append(say.unclosed_comment(Span(source, start, start + 2)))
        if kind not in {"space", "comment", "unclosed"}:
            yield Token(match.group(), start, end, behind)
            behind = end
        before = kind


def comment_before(source: Source, token: Token) -> str:
    """The comments between a word and the one before it, save what stands on the line of that one; markers are left out."""
    between = source.text[token.behind : token.start]
    own = between if token.behind == 0 else between.partition("\n")[2]
    found = [_bare(match.group()) for match in _WORDS.finditer(own) if match.lastgroup == "comment"]
    return "\n".join(found).strip()


def _bare(comment: str) -> str:
    if comment.startswith("//"):
        return comment.lstrip("/").strip()
    return "\n".join(line.strip().lstrip("*").strip() for line in comment[2:-2].split("\n")).strip()
