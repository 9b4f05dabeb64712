"""The elements of a typelib registry with their places. XML may be hostile: no document type is read, so no entities."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NoReturn
from xml.parsers import expat

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.limits import MAX_ELEMENTS
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field

TYPES = ("alias", "array", "character", "compound", "container", "enum", "null", "numeric", "opaque", "pointer")
PARTS = {"compound": "field", "enum": "value"}
"""What stands inside of a type, besides metadata."""


@dataclass(slots=True)
class Element:
    """An element, and those of interest within it."""

    tag: str
    attributes: Mapping[str, str]
    span: Span
    parts: list[Element] = field(default_factory=list["Element"])

    def span_of(self, attribute: str) -> Span:
        """The value of an attribute as it is written."""
        source = self.span.source
        end = source.text.find(">", self.span.start)
        found = re.compile(rf"\b{attribute}\s*=\s*[\"']([^\"']*)").search(source.text, self.span.start, max(end, self.span.end))
        return self.span if found is None else Span(source, found.start(1), max(found.end(1), found.start(1) + 1))


@dataclass(slots=True)
class _Reading:
    """The elements that expat has met while it reads."""

    source: Source
    parser: expat.XMLParserType
    types: list[Element] = field(default_factory=list[Element])
    open: list[Element] = field(default_factory=list[Element])
    offsets: tuple[int, int] = (0, 0)  # of the last element, in bytes and in characters
    elements: int = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, self.here(len(tag) + 1))
        self.elements += 1
        depth = len(self.open)
        if self.elements > MAX_ELEMENTS:
            _refuse(words.too_large(element.span, "typelib", MAX_ELEMENTS))
        if depth == 0 and tag != "typelib":
            _refuse(words.unexpected_element(element.span, tag, "`<typelib>`"))
        if depth == 1:
            if tag not in TYPES:
                _refuse(words.unexpected_element(element.span, tag, f"one of {', '.join(TYPES)}"))
            self.types.append(element)
        elif depth > 1 and tag == PARTS.get(self.open[-1].tag):
            self.open[-1].parts.append(element)
        elif depth > 1 and tag != "metadata":
            _refuse(words.unexpected_element(element.span, tag, "metadata"))
        self.open.append(element)

    def end(self, _tag: str) -> None:
        self.open.pop()

    def doctype(self, *_: object) -> None:
        start = max(0, self.source.text.find("<!DOCTYPE"))
        _refuse(words.document_type(Span(self.source, start, start + 9)))

    def here(self, width: int) -> Span:
        """The next characters at the parser's position."""
        start = self.character(max(0, self.parser.CurrentByteIndex))
        return Span(self.source, start, max(start + 1, min(start + width, len(self.source.text))))

    def character(self, byte: int) -> int:
        """The character at a byte; the parser moves on, so each is counted once."""
        if self.source.text.isascii():
            return byte
        known_byte, known = self.offsets
        while known_byte < byte and known < len(self.source.text):
            known_byte += len(self.source.text[known].encode(errors="replace"))
            known += 1
        self.offsets = known_byte, known
        return known


def read_elements(source: Source) -> list[Element]:
    """The types of a registry, in order; raises SchemaError if it is no registry."""
    parser = expat.ParserCreate("UTF-8")
    reading = _Reading(source, parser)
    parser.StartElementHandler = reading.start
    parser.EndElementHandler = reading.end
    parser.StartDoctypeDeclHandler = reading.doctype
    try:
        parser.Parse(source.text.encode(errors="replace"), True)
    except expat.ExpatError as error:
        start = min(reading.character(max(0, parser.ErrorByteIndex)), max(0, len(source.text) - 1))
        raise SchemaError((words.not_xml(Span(source, start, start + 1), expat.ErrorString(error.code) or ""),)) from error
    return reading.types


def _refuse(problem: Diagnostic) -> NoReturn:
    raise SchemaError((problem,))
