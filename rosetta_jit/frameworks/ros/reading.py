"""Reads the lines of one definition. Each is a comment, a field, or a constant; what is wrong with one does not keep the others.

Field    = ["@optional"] TypeName Word [default]        Constant = TypeName Word "=" value
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.ros import diagnostics as say
from rosetta_jit.frameworks.ros.dialect import Dialect, Rule
from rosetta_jit.frameworks.ros.limits import MAX_PROBLEMS, MAX_UNIT
from rosetta_jit.frameworks.ros.sections import Section
from rosetta_jit.frameworks.ros.tree import Constant, Definition, Field, TypeName, Values, Word
from rosetta_jit.frameworks.ros.values import array_values, scalar_value, wanted
from rosetta_jit.model.types import Constant as Value
from rosetta_jit.model.types import String
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace

if TYPE_CHECKING:
    from rosetta_jit.frameworks.ros.dialect import Scalar


BLANKS = " \t\r"
AROUND_COMMENTS = f"#{BLANKS}"
DECLARATION = re.compile(r"([^ \t]+)([ \t]*)(.*)", re.DOTALL)


def read(section: Section, dialect: Dialect, problems: list[Diagnostic]) -> Definition:
    """The definition of a section; its mistakes are added to the problems."""
    if not dialect.messages.allows(section.short):
        problems.append(say.wrong_file_name(section.named, section.short, dialect.messages.words))
    return _Reader(section, dialect, problems).definition()


@dataclass(slots=True)
class _Reader:
    section: Section
    dialect: Dialect
    problems: list[Diagnostic]
    optional: Span | None = None
    doc: str = ""
    comments: list[str] = field(default_factory=list[str])
    names: dict[str, Span] = field(default_factory=dict[str, Span])
    constants: list[Constant] = field(default_factory=list[Constant])
    fields: list[Field] = field(default_factory=list[Field])

    def definition(self) -> Definition:
        section = self.section
        at = section.start
        while at < section.end and len(self.problems) < MAX_PROBLEMS:
            match = self.dialect.line_ends.search(section.source.text, at, section.end)
            end = match.start() if match else section.end
            self._line(self._word(at, end))
            at = match.end() if match else section.end
        if self.optional is not None:
            self.problems.append(say.optional_nothing(self.optional))
        name = self.dialect.message(section.package, section.short, section.folder)
        members = tuple(self.constants), tuple(self.fields)
        return Definition(name, section.package, section.source, section.named, section.text, *members, self.doc)

    def _line(self, line: Word) -> None:
        before, sign, comment = line.text.partition("#")
        clean = self._part(line, 0, len(before))
        self._comment(comment.strip(AROUND_COMMENTS), goes_on=bool(sign or clean.text))
        if not clean.text:
            return
        if self.dialect.extended and clean.span.start > line.span.start:
            self.problems.append(say.indented(clean.span))
            return
        if clean.text.startswith("@"):
            clean = self._annotated(clean)
            if not clean.text:
                return
        self._declaration(clean, line)
        self.optional = None
        self.comments.clear()

    def _comment(self, text: str, *, goes_on: bool) -> None:
        """Comments belong to the declaration on their line or right below them; those before the first blank line, to the message."""
        if text:
            self.comments.append(text)
        elif not goes_on:
            self.doc = self.doc or ("" if self.fields or self.constants else "\n".join(self.comments))
            self.comments.clear()

    def _annotated(self, clean: Word) -> Word:
        """The rest of a declaration behind its annotation, which is noted."""
        match = DECLARATION.fullmatch(clean.text)
        assert match is not None
        if not self.dialect.extended or match[1] != "@optional" or self.optional is not None:
            self.problems.append(say.annotation(self._part(clean, 0, match.end(1)).span, match[1], again=self.optional is not None))
            return self._part(clean, len(clean.text))
        self.optional = self._part(clean, 0, match.end(1)).span
        return self._part(clean, match.end(1))

    def _declaration(self, clean: Word, line: Word) -> None:
        match = DECLARATION.fullmatch(clean.text)
        assert match is not None
        first, rest = self._part(clean, 0, match.end(1)), self._part(clean, match.start(3))
        if not rest.text:
            self.problems.append(say.not_a_declaration(clean.span))
        elif not self.dialect.extended and " " not in match[2]:
            self.problems.append(say.tab(Span(clean.span.source, first.span.end, rest.span.start)))
        elif "=" in rest.text:
            self._constant(first, rest, line)
        else:
            self._field(first, rest)

    def _field(self, first: Word, rest: Word) -> None:
        match = DECLARATION.fullmatch(rest.text)
        assert match is not None
        name, value = self._part(rest, 0, match.end(1)), self._part(rest, match.start(3))
        type_ = type_name(first, self.section, self.dialect, self.problems)
        named = self._named(name, "field", self.dialect.fields)
        if value.text and not self.dialect.extended:
            self.problems.append(say.too_much(value.span))
        elif type_ is not None and named:
            self.fields.append(Field(type_, name, self._default(type_, value), self.optional is not None, self._documentation))

    def _default(self, type_: TypeName, value: Word) -> Value | Values | None:
        if not value.text:
            return None
        scalar = self.dialect.scalars.get(type_.base)
        if scalar is None:
            self.problems.append(say.default_of_message(value.span))
            return None
        element = self._bounded(type_)
        default = array_values(value.text, type_, element, self.dialect) if type_.array else scalar_value(value.text, element, self.dialect)
        if default is None:
            self.problems.append(say.not_a_value(value.span, type_.written, wanted(type_, element, self.dialect)))
        return default

    def _constant(self, first: Word, rest: Word, line: Word) -> None:
        equals = rest.text.index("=")
        name, value = self._part(rest, 0, equals), self._part(rest, equals + 1)
        if first.text == "string" and not self.dialect.extended:
            value = self._part(line, rest.span.start + equals + 1 - line.span.start)
            if value.text.partition("#")[2].strip(AROUND_COMMENTS):
                self.comments.pop()  # which is the end of the text
        scalar = self.dialect.scalars.get(first.text)
        named = self._named(name, "constant", self.dialect.constants)
        if scalar is None:
            self.problems.append(say.not_a_constant_type(first.span, first.text, tuple(self.dialect.scalars)))
            return
        type_ = TypeName(first.text, first.text, first.span, builtin=True)
        number = scalar_value(value.text, scalar, self.dialect)
        if number is None:
            place = value.span if value.text else rest.span
            self.problems.append(say.not_a_value(place, first.text, wanted(type_, scalar, self.dialect)))
        elif named:
            self.constants.append(Constant(type_, name, value, number, self._documentation))

    @property
    def _documentation(self) -> str:
        return "\n".join(self.comments)

    def _bounded(self, type_: TypeName) -> Scalar:
        """The scalar type, with the bound of a string."""
        scalar = self.dialect.scalars[type_.base]
        return replace(scalar, maximum=type_.text_maximum) if isinstance(scalar, String) else scalar

    def _named(self, name: Word, what: str, rule: Rule) -> bool:
        """Whether a name is a good one."""
        if not rule.allows(name.text):
            self.problems.append(say.not_a_name(name.span, name.text, what, rule.words))
        elif name.text in self.names:
            self.problems.append(say.duplicate(name.span, name.text, self.names[name.text]))
        else:
            self.names[name.text] = name.span
            return True
        return False

    def _word(self, start: int, end: int) -> Word:
        source = self.section.source
        text = source.text[start:end]
        return Word(text.replace("\t", " ") if self.dialect.extended else text, Span(source, start, end))

    def _part(self, word: Word, start: int, end: int | None = None) -> Word:
        """Characters of a word without the blanks around them."""
        text = word.text[start:end]
        start += len(text) - len(text.lstrip(BLANKS))
        text = text.strip(BLANKS)
        begin = word.span.start + start
        return Word(text, Span(word.span.source, begin, begin + len(text)))


TYPE = re.compile(r"(?P<base>[^\[\]<]+)(?P<bound><=(?P<text>[^\[\]]*))?(?P<array>\[(?P<most><=)?(?P<length>[^\[\]]*)\])?")
LENGTH = re.compile(r"[0-9]{1,12}")
LARGEST_LENGTH = (1 << 32) - 1
"""Counts have 32 bits on the wire."""


def type_name(word: Word, section: Section, dialect: Dialect, problems: list[Diagnostic]) -> TypeName | None:
    """The type that a word of a section names; None, and a problem, if it names none."""
    match = TYPE.fullmatch(word.text)
    if match is None or not _may_have_bounds(match, dialect):
        problems.append(say.not_a_type(word.span, word.text))
        return None
    base = _base(match["base"], word.text, section, dialect)
    if base is None:
        problems.append(say.not_a_type_name(word.span, match["base"], dialect.packages.words, dialect.messages.words))
        return None
    numbers = {part: _length(match[part]) for part in ("text", "length") if match[part]}
    least = {"text": 1, "length": 1 if dialect.extended else 0}
    if any(number is None or number < least[part] for part, number in numbers.items()) or match["text"] == "" or _empty_bound(match):
        problems.append(say.not_a_length(word.span, min(least[part] for part in numbers or least)))
        return None
    length = numbers.get("length")
    return TypeName(
        word.text,
        base,
        word.span,
        builtin=base in dialect.scalars or base in dialect.structs,
        array=match["array"] is not None,
        length=None if match["most"] else length,
        maximum=length if match["most"] else None,
        text_maximum=numbers.get("text"),
    )


def _base(word: str, written: str, section: Section, dialect: Dialect) -> str | None:
    """The builtin word itself, or the qualified name of a message."""
    if word in dialect.scalars or word in dialect.structs:
        return word
    if written in dialect.aliases:
        return dialect.aliases[written]
    if word in section.local:
        return section.local[word]
    package, *folders, short = word.split("/") if "/" in word else (section.package, word)
    folder = folders[0] if len(folders) == 1 else "msg"
    known = len(folders) < 2 and folder in ("msg", *dialect.interfaces) and (dialect.packages.allows(package) or "/" not in word)
    return dialect.message(package, short, folder) if known and dialect.messages.allows(short) else None


def _may_have_bounds(match: re.Match[str], dialect: Dialect) -> bool:
    """Whether it has bounds only where types have some."""
    return dialect.extended and match["base"] in ("string", "wstring") if match["bound"] else dialect.extended or not match["most"]


def _length(text: str) -> int | None:
    number = int(text) if LENGTH.fullmatch(text) else None
    return number if number is not None and number <= LARGEST_LENGTH else None


def _empty_bound(match: re.Match[str]) -> bool:
    return bool(match["most"]) and not match["length"]


IN_BRACKETS = re.compile(r"\[([^,\]]+)\]")
"""A comma makes it a range."""


def unit_in(comment: str) -> str | None:
    """The unit that a field's comment gives, or None: what stands in brackets, ``# start of the scan [rad]``, if nothing else does.

    That is how rosidl_adapter (``parser.py``, ``process_comments``) finds the ``@unit`` of the `.idl` file that it makes. ROS 1 has no
    such rule.
    """
    found = IN_BRACKETS.findall(comment)
    unit = found[0].strip() if len(found) == 1 else ""
    return unit if 0 < len(unit) <= MAX_UNIT and unit.isprintable() else None
