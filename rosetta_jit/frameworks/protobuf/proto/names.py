"""Make every name of a file absolute: `Image` becomes `.rst.vision.Image`.

Scalar types keep their words. A name that stands for nothing becomes empty, is reported here, and nowhere again.
"""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.catalogue import suggestions
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.protobuf import diagnostics as say
from rosetta_jit.frameworks.protobuf.limits import MAX_REPORTED
from rosetta_jit.frameworks.protobuf.proto import tree
from rosetta_jit.frameworks.protobuf.proto.scalars import SCALARS
from rosetta_jit.frameworks.protobuf.proto.symbols import ALL_KINDS, TYPES, Kind, Symbols, join, package_of
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

EXTENSION: frozenset[Kind] = frozenset(("extension",))
MESSAGE: frozenset[Kind] = frozenset(("message",))
FEATURE_SET = "google.protobuf.FeatureSet"
"""The message that custom features extend."""


def absolute(file: tree.File, symbols: Symbols, problems: list[Diagnostic]) -> tree.File:
    """The same file with every type and every custom option by its absolute name."""
    return _Resolver(symbols.visible[file.name], symbols.visible_in_options[file.name], symbols, problems).file(file)


@dataclass(frozen=True, slots=True)
class _Resolver:
    visible: frozenset[str]
    visible_in_options: frozenset[str]
    symbols: Symbols
    problems: list[Diagnostic]

    def file(self, file: tree.File) -> tree.File:
        scope = package_of(file)
        return replace(
            file,
            messages=tuple(self.message(scope, message) for message in file.messages),
            enums=tuple(self.enum(scope, enum) for enum in file.enums),
            extends=tuple(self.extend(scope, extend) for extend in file.extends),
            services=tuple(self.service(scope, service) for service in file.services),
            options=self.options(scope, file.options),
        )

    def message(self, outer: str, message: tree.Message) -> tree.Message:
        scope = join(outer, message.name.text)
        return replace(
            message,
            members=tuple(self.member(scope, member) for member in message.members),
            messages=tuple(self.message(scope, inner) for inner in message.messages),
            enums=tuple(self.enum(scope, enum) for enum in message.enums),
            extends=tuple(self.extend(scope, extend) for extend in message.extends),
            extension_options=self.options(outer, message.extension_options),
            options=self.options(outer, message.options),
        )

    def member(self, scope: str, member: tree.Field | tree.Oneof) -> tree.Field | tree.Oneof:
        match member:
            case tree.Field():
                return self.field(scope, member)
            case tree.Oneof():
                fields = tuple(self.field(scope, field) for field in member.fields)
                return replace(member, fields=fields, options=self.options(scope, member.options))
            case _:
                assert_never(member)

    def field(self, scope: str, field: tree.Field) -> tree.Field:
        return replace(field, type=self.type(scope, field.type), options=self.options(scope, field.options))

    def type(self, scope: str, type_: tree.Name | tree.MapType) -> tree.Name | tree.MapType:
        match type_:
            case tree.MapType(key, value, span):
                return tree.MapType(self.reference(scope, key), self.reference(scope, value), span)
            case tree.Name():
                return self.reference(scope, type_)
            case _:
                assert_never(type_)

    def reference(self, scope: str, name: tree.Name) -> tree.Name:
        return name if name.text in SCALARS else self.lookup(scope, name, TYPES)

    def extend(self, scope: str, extend: tree.Extend) -> tree.Extend:
        fields = tuple(self.field(scope, field) for field in extend.fields)
        return tree.Extend(self.lookup(scope, extend.extendee, MESSAGE), fields)

    def enum(self, outer: str, enum: tree.Enum) -> tree.Enum:
        values = tuple(replace(value, options=self.options(outer, value.options)) for value in enum.values)
        return replace(enum, values=values, options=self.options(outer, enum.options))

    def service(self, outer: str, service: tree.Service) -> tree.Service:
        scope = join(outer, service.name.text)
        methods = tuple(self.method(scope, method) for method in service.methods)
        return replace(service, methods=methods, options=self.options(outer, service.options))

    def method(self, scope: str, method: tree.Method) -> tree.Method:
        types = tuple(self.lookup(scope, name, MESSAGE) for name in method.types)
        return replace(method, types=types, options=self.options(scope, method.options))

    def options(self, scope: str, options: tuple[tree.Option, ...]) -> tuple[tree.Option, ...]:
        return tuple(self.option(scope, option) for option in options)

    def option(self, scope: str, option: tree.Option) -> tree.Option:
        parts = tuple(self.part(scope, part, option.span) for part in option.parts)
        value = option.value
        if parts == ("features",) and isinstance(value, tree.Aggregate):
            # In text format the name of an extension is looked up from the message that it extends.
            value = tree.Aggregate(tuple(replace(entry, name=self.part(FEATURE_SET, entry.name, option.span)) for entry in value.entries))
        return replace(option, parts=parts, value=value)

    def part(self, scope: str, part: str, span: Span | None) -> str:
        """A part of an option's name; an extension's is in parentheses."""
        if not part.startswith("("):
            return part
        return f"({self.lookup(scope, tree.Name(part[1:-1], span), EXTENSION).text})"

    def lookup(self, scope: str, name: tree.Name, kinds: frozenset[Kind]) -> tree.Name:
        if not name.text:
            return name
        files = self.files(kinds)
        full = self.symbols.find(files, scope, name.text, kinds)
        if full is None:
            self.problems.append(self.unknown(files, scope, name, kinds))
            return tree.Name("", name.span)
        symbol = self.symbols.table[full]
        if symbol.kind not in kinds:
            self.problems.append(say.wrong_kind(name, full, symbol.kind, kinds))
            return tree.Name("", name.span)
        return tree.Name(f".{full}", name.span)

    def files(self, kinds: frozenset[Kind]) -> frozenset[str]:
        """Where a name is looked for: extensions are named in options alone."""
        return self.visible_in_options if kinds == EXTENSION else self.visible

    def unknown(self, files: frozenset[str], scope: str, name: tree.Name, kinds: frozenset[Kind]) -> Diagnostic:
        """Why a name was not found: it means something else, an inner scope hides it, its file is not imported, or it is nowhere."""
        bare = name.text.removeprefix(".")
        other = self.symbols.find(files, scope, name.text, ALL_KINDS)
        if other:
            return say.wrong_kind(name, other, self.symbols.table[other].kind, kinds)
        inner = self.symbols.scope_of(files, scope, name.text, kinds)
        if inner and "." in bare:
            return say.hidden_name(name, join(inner, bare))
        scopes = [scope, *(scope[:end] for end in range(len(scope)) if scope[end] == "."), ""]
        for full in (join(outer, bare) for outer in sorted(scopes, key=len, reverse=True)):
            symbol = self.symbols.table.get(full)
            if symbol and symbol.kind in kinds:
                return say.not_imported(name, full, min(symbol.files))
        return say.unknown_name(name, kinds, self.elsewhere(bare, kinds) if len(self.problems) < MAX_REPORTED else None)

    def elsewhere(self, name: str, kinds: frozenset[Kind]) -> str | None:
        """A declaration whose name ends in the same way, or almost so."""
        known = {full.rpartition(".")[2]: full for full, symbol in self.symbols.table.items() if symbol.kind in kinds}
        last = name.rpartition(".")[2]
        close = last if last in known else suggestions.closest(last, known)
        return None if close is None else known[close]
