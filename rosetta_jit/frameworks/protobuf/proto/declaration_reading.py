"""The parser's tree to the declarations of `tree`: one method a rule of the grammar.

What depends on other statements is left to the checks.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.proto import tree
from rosetta_jit.frameworks.protobuf.proto.values import Node, ValueReader, all_of, one, tokens_of
from rosetta_jit.parsing.lalr import Token, Tree


class DeclarationReader(ValueReader):
    """Reads messages and enums of a source in some version of the language."""

    __slots__ = ()

    # Messages

    def message(self, node: Node) -> tree.Message:
        return self.body(node, self.name(tokens_of(node)[-1]), self.doc(node))

    def body(self, node: Node, name: tree.Name, doc: str) -> tree.Message:
        members = tuple(
            self.oneof(child) if child.data == "oneof" else self.field(child) for child in all_of(node, "field", "group", "oneof")
        )
        extends, extend_groups = self.extends(node)
        reserved, reserved_names = self.reserved(node)
        options = self.options(node)
        message_set = any(option.parts == ("message_set_wire_format",) for option in options)
        return tree.Message(
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
            extensions=self.extensions(node, tree.LARGEST_MESSAGE_SET_NUMBER if message_set else tree.LARGEST_FIELD_NUMBER),
            extension_options=tuple(option for block in all_of(node, "extensions") for option in self.settings(block)),
            reserved=reserved,
            reserved_names=reserved_names,
            options=options,
            doc=doc,
        )

    def groups(self, node: Node) -> Iterator[tree.Message]:
        """The messages that the groups among some fields declare."""
        for child in _fields(node):
            if child.data == "group":
                yield self.body(child, self.name(tokens_of(child)[-2]), self.doc(child))

    def field(self, node: Node) -> tree.Field:
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
            name, type_ = tree.Name(written.text.lower(), written.span), written
        else:
            name, type_ = self.name(tokens[-2]), self.type(node)
        return tree.Field(
            name=name,
            type=type_,
            number=self.integer(number),
            number_span=self.at(number),
            label=cast("tree.Label", str(label)) if label else None,
            label_span=self.at(label) if label else None,
            group=group,
            options=self.settings(node),
            doc=self.doc_of_field(node),
            span=self.at(tokens[-2]),
        )

    def type(self, node: Node) -> tree.Name | tree.MapType:
        for map_ in all_of(node, "map"):
            key, value = all_of(map_, "path")
            return tree.MapType(self.path(key), self.path(value), self.at(tokens_of(map_)[0]))
        return self.path(one(node, "path"))

    def oneof(self, node: Node) -> tree.Oneof:
        return tree.Oneof(
            name=self.name(tokens_of(node)[1]),
            fields=tuple(self.field(child) for child in _fields(node)),
            options=self.options(node),
            doc=self.doc(node),
        )

    def extends(self, node: Node) -> tuple[tuple[tree.Extend, ...], list[tree.Message]]:
        """The extend blocks, and the messages of the groups in them: these are declared where the block stands."""
        blocks = list(all_of(node, "extend"))
        for block in blocks:
            if not _fields(block):
                self.problems.append(say.empty_extend(self.span(one(block, "path"))))
        groups = [group for block in blocks for group in self.groups(block)]
        return tuple(self.extend(block) for block in blocks), groups

    def extend(self, node: Node) -> tree.Extend:
        return tree.Extend(self.path(one(node, "path")), tuple(self.field(child) for child in _fields(node)))

    def extensions(self, node: Node, limit: int) -> tuple[tree.Range, ...]:
        return tuple(self.range(child, limit) for block in all_of(node, "extensions") for child in all_of(block, "range"))

    def reserved(self, node: Node, limit: int = tree.LARGEST_FIELD_NUMBER) -> tuple[tuple[tree.Range, ...], tuple[tree.Name, ...]]:
        blocks = list(all_of(node, "reserved"))
        return (
            tuple(self.range(child, limit) for block in blocks for child in all_of(block, "range")),
            tuple(name for block in blocks for name in self.reserved_names(block)),
        )

    def reserved_names(self, node: Node) -> Iterator[tree.Name]:
        """Strings in proto2 and proto3, identifiers in editions; either is read in both."""
        quoted = [tree.Name(self.text(string), self.span(string)) for string in all_of(node, "string")]
        bare = [self.name(token) for token in tokens_of(node)]
        yield from (*quoted, *bare)

    def range(self, node: Node, limit: int) -> tree.Range:
        first, *rest = node.children
        span = self.span(node)
        start = self.end(first, limit)
        if not rest:
            return tree.Range(start, start, span)
        word, last = rest
        if str(word) != "to":
            self.problems.append(of_file.unexpected(self.at(cast("Token", word)), str(word), {"COMMA", "SEMICOLON", "TO"}))
        return tree.Range(start, self.end(last, limit), span)

    def end(self, node: Node | Token, limit: int) -> int:
        """One end of a range."""
        if isinstance(node, Tree):
            return self.signed(node)
        if str(node) != "max":
            self.problems.append(of_file.unexpected(self.at(node), str(node), {"NUMBER", "MAX"}))
        return limit

    # Enums

    def enum(self, node: Node) -> tree.Enum:
        reserved, reserved_names = self.reserved(node, tree.LARGEST_ENUM_NUMBER)
        return tree.Enum(
            name=self.name(tokens_of(node)[-1]),
            values=tuple(self.value(child) for child in all_of(node, "value")),
            reserved=reserved,
            reserved_names=reserved_names,
            options=self.options(node),
        )

    def value(self, node: Node) -> tree.EnumValue:
        number = one(node, "signed")
        return tree.EnumValue(self.name(tokens_of(node)[0]), self.signed(number), self.span(number), self.settings(node))


def _fields(node: Node) -> list[Node]:
    return list(all_of(node, "field", "group"))
