"""Lark tree to `tree.File`: one method a rule of the grammar.

What depends on other statements is left to the checks.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, cast

from lark import Token, Tree

from rosetta_jit.catalogue import proto as say
from rosetta_jit.frameworks.protobuf.proto import syntax
from rosetta_jit.frameworks.protobuf.proto.tree import (
    EDITIONS,
    SYNTAXES,
    Enum,
    EnumValue,
    Extend,
    Field,
    File,
    Import,
    ImportKind,
    Label,
    MapType,
    Message,
    Method,
    Name,
    Oneof,
    Range,
    Service,
    Version,
    Visibility,
)
from rosetta_jit.frameworks.protobuf.proto.values import ValueReader, all_of, ends, one, tokens_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.frameworks.protobuf.proto.values import Node
    from rosetta_jit.source import Source

MAX_NUMBER = 2**31 - 1
MAX_MESSAGE_SET_NUMBER = 2**31 - 2
"""`max` in an extension range of a message with `message_set_wire_format`."""
MAX_FIELD_NUMBER = 2**29 - 1


def read(source: Source, problems: list[Diagnostic]) -> File | None:
    """The file that a source holds; None where its syntax is too broken to say."""
    root = syntax.parse(source, problems)
    return None if root is None else _Reader(source, problems, _version(root, ValueReader(source, problems))).file(root)


def _version(root: Node, reader: ValueReader) -> Version:
    for node in all_of(root, "syntax"):
        word, string = tokens_of(node)[0], one(node, "string")
        value = reader.text(string)
        for version in EDITIONS if word == "edition" else SYNTAXES:
            if version == value:
                return version
        unknown = say.unknown_edition if word == "edition" else say.unknown_syntax
        reader.problems.append(unknown(reader.span(string), value))
    return "proto2"


@dataclass(frozen=True, slots=True)
class _Reader(ValueReader):
    version: Version

    def file(self, root: Node) -> File:
        packages = [self.path(one(node, "path")) for node in all_of(root, "package")]
        for extra in packages[1:]:
            self.problems.append(say.second_package(extra.span))
        extends, groups = self.extends(root)
        return File(
            name=self.source.name,
            version=self.version,
            package=packages[0] if packages else None,
            imports=self.imports(root),
            messages=(*(self.message(node) for node in all_of(root, "message")), *groups),
            enums=tuple(self.enum(node) for node in all_of(root, "enum")),
            extends=extends,
            services=tuple(self.service(node) for node in all_of(root, "service")),
            options=self.options(root),
        )

    def imports(self, root: Node) -> tuple[Import, ...]:
        imports = tuple(self.import_(node) for node in all_of(root, "import"))
        for before, import_ in pairwise(imports):
            if before.kind == "option" and import_.kind != "option":
                self.problems.append(say.late_import(import_.span))
        return imports

    def import_(self, node: Node) -> Import:
        path = one(node, "string")
        return Import(self.text(path), self.import_kind(tokens_of(node)), self.span(path))

    def import_kind(self, words: list[Token]) -> ImportKind:
        for word in words:
            match str(word):
                case "public":
                    return "public"
                case "weak":
                    if self.version == "2024":
                        self.problems.append(say.weak_import(self.at(word)))
                    return "weak"
                case "option":
                    if self.version != "2024":
                        self.problems.append(say.option_import(self.at(word)))
                    return "option"
                case other:
                    self.problems.append(say.unexpected(self.at(word), other, {"STRING"}))
        return "plain"

    def visibility(self, node: Node) -> Visibility | None:
        word = tokens_of(node)[0]
        if word.type != "VISIBILITY":
            return None
        if self.version != "2024":
            self.problems.append(say.early_visibility(self.at(word)))
        return cast("Visibility", str(word))

    # Messages

    def message(self, node: Node) -> Message:
        return self.body(node, self.name(tokens_of(node)[-1]), self.doc(node), self.visibility(node))

    def body(self, node: Node, name: Name, doc: str, visibility: Visibility | None = None) -> Message:
        members = tuple(
            self.oneof(child) if child.data == "oneof" else self.field(child) for child in all_of(node, "field", "group", "oneof")
        )
        self.check_words(node)
        extends, extend_groups = self.extends(node)
        reserved, reserved_names = self.reserved(node)
        options = self.options(node)
        message_set = any(option.parts == ("message_set_wire_format",) for option in options)
        return Message(
            name=name,
            members=members,
            messages=(
                *(self.message(child) for child in all_of(node, "message")),
                *self.groups(node),
                *(group for oneof in all_of(node, "oneof") for group in self.groups(oneof)),
                *extend_groups,
            ),
            enums=tuple(self.enum(child) for child in all_of(node, "enum")),
            extends=extends,
            extensions=self.extensions(node, MAX_MESSAGE_SET_NUMBER if message_set else MAX_FIELD_NUMBER),
            extension_options=tuple(option for block in all_of(node, "extensions") for option in self.settings(block)),
            reserved=reserved,
            reserved_names=reserved_names,
            options=options,
            doc=doc,
            visibility=visibility,
        )

    def check_words(self, node: Node) -> None:
        """In edition 2024 a field of a message cannot begin with the words for visibility, though types may have such names."""
        for field in all_of(node, "field"):
            first = ends(field)[0]
            if self.version == "2024" and first in syntax.VISIBILITIES:
                self.problems.append(say.misplaced_visibility(self.at(first), first))

    def groups(self, node: Node) -> Iterator[Message]:
        """The messages that the groups among some fields declare."""
        for child in _fields(node):
            if child.data == "group":
                yield self.body(child, self.name(tokens_of(child)[-2]), self.doc(child))

    def field(self, node: Node) -> Field:
        tokens = tokens_of(node)
        group = node.data == "group"
        # `repeated = 1` without a label is a field of that name: only the count of words tells.
        label = tokens[0] if len(tokens) > 2 + group else None
        number = tokens[-1]
        if group:
            written = self.name(tokens[-2])
            if not written.text[0].isupper():
                # Its field would have the same name.
                self.problems.append(say.lower_case_group(written))
            name, type_ = Name(written.text.lower(), written.span), written
        else:
            name, type_ = self.name(tokens[-2]), self.type(node)
        return Field(
            name=name,
            type=type_,
            number=self.integer(number),
            number_span=self.at(number),
            label=cast("Label", str(label)) if label else None,
            label_span=self.at(label) if label else None,
            group=group,
            options=self.settings(node),
            doc=self.doc(node),
            span=self.at(tokens[-2]),
        )

    def type(self, node: Node) -> Name | MapType:
        for map_ in all_of(node, "map"):
            key, value = all_of(map_, "path")
            return MapType(self.path(key), self.path(value), self.at(tokens_of(map_)[0]))
        return self.path(one(node, "path"))

    def oneof(self, node: Node) -> Oneof:
        return Oneof(
            name=self.name(tokens_of(node)[1]),
            fields=tuple(self.field(child) for child in _fields(node)),
            options=self.options(node),
            doc=self.doc(node),
        )

    def extends(self, node: Node) -> tuple[tuple[Extend, ...], list[Message]]:
        """The extend blocks, and the messages of the groups in them: these are declared where the block stands."""
        blocks = list(all_of(node, "extend"))
        for block in blocks:
            if not _fields(block):
                self.problems.append(say.empty_extend(self.span(one(block, "path"))))
        groups = [group for block in blocks for group in self.groups(block)]
        return tuple(self.extend(block) for block in blocks), groups

    def extend(self, node: Node) -> Extend:
        return Extend(self.path(one(node, "path")), tuple(self.field(child) for child in _fields(node)))

    def extensions(self, node: Node, limit: int) -> tuple[Range, ...]:
        return tuple(self.range(child, limit) for block in all_of(node, "extensions") for child in all_of(block, "range"))

    def reserved(self, node: Node, limit: int = MAX_FIELD_NUMBER) -> tuple[tuple[Range, ...], tuple[Name, ...]]:
        blocks = list(all_of(node, "reserved"))
        return (
            tuple(self.range(child, limit) for block in blocks for child in all_of(block, "range")),
            tuple(name for block in blocks for name in self.reserved_names(block)),
        )

    def reserved_names(self, node: Node) -> Iterator[Name]:
        """Strings in proto2 and proto3, identifiers in editions."""
        quoted = [Name(self.text(string), self.span(string)) for string in all_of(node, "string")]
        bare = [self.name(token) for token in tokens_of(node)]
        if self.version in EDITIONS:
            self.problems.extend(say.reserved_string(name) for name in quoted)
        else:
            self.problems.extend(say.reserved_identifier(name) for name in bare)
        yield from (*quoted, *bare)

    def range(self, node: Node, limit: int) -> Range:
        first, *rest = node.children
        span = self.span(node)
        start = self.end(first, limit)
        if not rest:
            return Range(start, start, span)
        word, last = rest
        if str(word) != "to":
            self.problems.append(say.unexpected(self.at(cast("Token", word)), str(word), {"COMMA", "SEMICOLON", "TO"}))
        return Range(start, self.end(last, limit), span)

    def end(self, node: Node | Token, limit: int) -> int:
        """One end of a range."""
        if isinstance(node, Tree):
            return self.signed(node)
        if str(node) != "max":
            self.problems.append(say.unexpected(self.at(node), str(node), {"NUMBER", "MAX"}))
        return limit

    # Enums and services

    def enum(self, node: Node) -> Enum:
        reserved, reserved_names = self.reserved(node, MAX_NUMBER)
        return Enum(
            name=self.name(tokens_of(node)[-1]),
            values=tuple(self.value(child) for child in all_of(node, "value")),
            reserved=reserved,
            reserved_names=reserved_names,
            options=self.options(node),
            visibility=self.visibility(node),
        )

    def value(self, node: Node) -> EnumValue:
        number = one(node, "signed")
        return EnumValue(self.name(tokens_of(node)[0]), self.signed(number), self.span(number), self.settings(node))

    def service(self, node: Node) -> Service:
        methods = tuple(self.method(child) for child in all_of(node, "rpc"))
        return Service(self.name(tokens_of(node)[0]), methods, self.options(node))

    def method(self, node: Node) -> Method:
        rpc, name, returns = tokens_of(node)
        for word, wanted in ((rpc, "rpc"), (returns, "returns")):
            if word != wanted:
                self.problems.append(say.unexpected(self.at(word), word, {wanted.upper()}))
        return Method(self.name(name), tuple(self.method_type(child) for child in all_of(node, "rpc_type")), self.options(node))

    def method_type(self, node: Node) -> Name:
        path = self.path(one(node, "path"))
        for word in tokens_of(node):
            # `(stream.Foo)` is a stream of `.Foo`; of other names the parser takes the first part for such a word too.
            if word != "stream" and path.text.startswith("."):
                return self.checked(Name(f"{word}{path.text}", self.span(node)))
            if word != "stream":
                self.problems.append(say.unexpected(self.at(word), word, {"RPAR", "DOT", "STREAM"}))
            return path
        if path.text == "stream":
            self.problems.append(say.unexpected(self.span(node), path.text, {"IDENT"}))
        return path


def _fields(node: Node) -> list[Node]:
    return list(all_of(node, "field", "group"))
