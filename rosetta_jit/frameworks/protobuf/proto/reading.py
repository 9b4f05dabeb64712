"""The parser's tree to `tree.File`: its version, what it imports, and its services; `declaration_reading` reads the rest."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import edition_diagnostics as say_edition
from rosetta_jit.frameworks.protobuf import file_diagnostics as of_file
from rosetta_jit.frameworks.protobuf.proto import syntax, tree
from rosetta_jit.frameworks.protobuf.proto.declaration_reading import DeclarationReader
from rosetta_jit.frameworks.protobuf.proto.values import Node, ValueReader, all_of, one, tokens_of
from rosetta_jit.parsing.lalr import Token
from rosetta_jit.source import Source


def read(source: Source, problems: list[Diagnostic]) -> tree.File | None:
    """The file that a source holds; None where its syntax is too broken to say."""
    root = syntax.parse(source, problems)
    return None if root is None else _Reader(source, problems, _version(root, ValueReader(source, problems))).file(root)


def _version(root: Node, reader: ValueReader) -> tree.Version:
    for node in all_of(root, "syntax"):
        word, string = tokens_of(node)[0], one(node, "string")
        value = reader.text(string)
        for version in tree.EDITIONS if word == "edition" else tree.SYNTAXES:
            if version == value:
                return version
        unknown = say_edition.unknown_edition if word == "edition" else of_file.unknown_syntax
        reader.problems.append(unknown(reader.span(string), value))
    return "proto2"


class _Reader(DeclarationReader):
    __slots__ = ()

    def file(self, root: Node) -> tree.File:
        packages = [self.path(one(node, "path")) for node in all_of(root, "package")]
        for extra in packages[1:]:
            self.problems.append(of_file.second_package(extra.span))
        extends, groups = self.extends(root)
        return tree.File(
            name=self.source.name,
            version=self.version,
            package=packages[0] if packages else None,
            imports=tuple(self.import_(node) for node in all_of(root, "import")),
            messages=(*(self.message(node) for node in all_of(root, "message")), *groups),
            enums=tuple(self.enum(node) for node in all_of(root, "enum")),
            extends=extends,
            services=tuple(self.service(node) for node in all_of(root, "service")),
            options=self.options(root),
        )

    def import_(self, node: Node) -> tree.Import:
        path = one(node, "string")
        return tree.Import(self.text(path), self.import_kind(tokens_of(node)), self.span(path))

    def import_kind(self, words: list[Token]) -> tree.ImportKind:
        for word in words:
            match str(word):
                case "public":
                    return "public"
                case "weak":
                    return "weak"
                case "option":
                    return "option"
                case other:
                    self.problems.append(of_file.unexpected(self.at(word), other, {"STRING"}))
        return "plain"

    def service(self, node: Node) -> tree.Service:
        methods = tuple(self.method(child) for child in all_of(node, "rpc"))
        return tree.Service(self.name(tokens_of(node)[0]), methods, self.options(node))

    def method(self, node: Node) -> tree.Method:
        rpc, name, returns = tokens_of(node)
        for word, wanted in ((rpc, "rpc"), (returns, "returns")):
            if word != wanted:
                self.problems.append(of_file.unexpected(self.at(word), word, {wanted.upper()}))
        return tree.Method(self.name(name), tuple(self.method_type(child) for child in all_of(node, "rpc_type")), self.options(node))

    def method_type(self, node: Node) -> tree.Name:
        path = self.path(one(node, "path"))
        for word in tokens_of(node):
            # `(stream.Foo)` is a stream of `.Foo`; of other names the parser takes the first part for such a word too.
            if word != "stream" and path.text.startswith("."):
                return self.checked(tree.Name(f"{word}{path.text}", self.span(node)))
            if word != "stream":
                self.problems.append(of_file.unexpected(self.at(word), word, {"RPAR", "DOT", "STREAM"}))
            return path
        if path.text == "stream":
            self.problems.append(of_file.unexpected(self.span(node), path.text, {"IDENT"}))
        return path
