"""The front end of YARP's Thrift, as yarpidl_thrift reads it (os/idl, t_yarp_generator.cc).

A function of a service is several messages: ``Service.function.request``, a bottle whose first elements are the words of the name, or
``.call``, where it is one text, and ``.reply``. Field ids mean nothing to YARP, and neither does ``optional``: fields are in their order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.limits import MAX_ANCESTORS, MAX_FILES, MAX_FUNCTIONS, MAX_TYPE_DEPTH
from rosetta_jit.frameworks.yarp.tags import vocab
from rosetta_jit.frameworks.yarp.thrift import diagnostics as say
from rosetta_jit.frameworks.yarp.thrift import grammar as tree
from rosetta_jit.frameworks.yarp.thrift.lexer import words_of
from rosetta_jit.model import expr
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Constant,
    Declaration,
    Enum,
    Field,
    Float,
    Int,
    Map,
    NamedConstant,
    Ref,
    Schema,
    String,
    Struct,
    Type,
)
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load

VOCAB_LETTERS = 4
"""Words of a function's name that are longer are texts."""

SCALARS: dict[str, Type] = {
    "bool": Bool("vocab32"),
    "byte": Int(8, spelling="int8"),
    "i8": Int(8, spelling="int8"),
    "i16": Int(16, spelling="int16"),
    "i32": Int(32, spelling="int32"),
    "i64": Int(64, spelling="int64"),
    "double": Float(64, "float64"),
    "string": String("octets", "string"),
    "binary": Bytes("blob"),
}
NATIVE: dict[str, Type] = {
    "vocab32_t": Int(32, spelling="vocab32"),
    "vocab64_t": Int(64, spelling="vocab64"),
    "uint8_t": Int(8, signed=False, spelling="int8"),
    "uint16_t": Int(16, signed=False, spelling="int16"),
    "uint32_t": Int(32, signed=False, spelling="int32"),
    "uint64_t": Int(64, signed=False, spelling="int64"),
    "size_t": Int(64, signed=False, spelling="int64"),
    "float32_t": Float(32, "float32"),
    "float64_t": Float(64, "float64"),
}
"""What ``yarp.type`` makes of a number, by the last part of the C++ name."""

VECTORS = ("yarp::sig::Vector", "yarp::sig::VectorOf<double>")


def parse(source: Source, load: Load) -> Schema:
    """All structs, enums and messages of services of a `.thrift` file and of what it includes.

    Raises
    ------
    SchemaError
        With everything that is wrong.
    """
    reading = _Reading(load)
    reading.read(source)
    if not reading.problems:
        reading.declare()
    if reading.problems:
        raise SchemaError(tuple(reading.problems[:100]))
    return Schema(reading.types, tuple(dict.fromkeys(each.name for each, _ in reading.files)), reading.constants)


@dataclass(slots=True)
class _Reading:
    """The files that were read, and what they declare."""

    load: Load
    files: list[tuple[Source, tree.File]] = field(default_factory=list["tuple[Source, tree.File]"])
    problems: list[Diagnostic] = field(default_factory=list["Diagnostic"])
    names: dict[str, tuple[tree.File, tree.Struct | tree.Enum]] = field(
        default_factory=dict[str, "tuple[tree.File, tree.Struct | tree.Enum]"]
    )
    services: dict[str, tuple[tree.File, tree.Service]] = field(default_factory=dict[str, "tuple[tree.File, tree.Service]"])
    types: dict[str, Declaration] = field(default_factory=dict[str, "Declaration"])
    constants: dict[str, NamedConstant] = field(default_factory=dict[str, "NamedConstant"])
    making: set[str] = field(default_factory=set[str])
    functions: int = 0

    def read(self, source: Source) -> None:
        """A file, after those that it includes."""
        pending, seen = [source], {source.name}
        while pending and len(self.files) < MAX_FILES:
            current = pending.pop()
            file = tree.parse(words_of(current))
            self.files.append((current, file))
            for word in file.includes:
                included = self.load(word.text.strip("\"'")) if word.kind == "text" else None
                if included is None:
                    self.problems.append(say.not_included(word.span, word.text.strip("\"'")))
                elif included.name not in seen:
                    seen.add(included.name)
                    pending.append(included)

    def declare(self) -> None:
        for _, file in reversed(self.files):
            for each in file.declared:
                if isinstance(each, tree.Service):
                    self.services[each.name] = file, each
                    continue
                if each.name in self.names:
                    self.problems.append(say.repeated(each.span, each.name))
                self.names[each.name] = file, each
        for _, file in reversed(self.files):
            for name, (type_, value) in file.constants.items():
                made = self.type(file, type_, 0)
                if value is not None and made is not None:
                    self.constants[qualified(file, name)] = NamedConstant(name, made, value)
            for each in file.declared:
                match each:
                    case tree.Struct() | tree.Enum():
                        self.named(each.name)
                    case tree.Service():
                        self.service(file, each)
                    case _:
                        assert_never(each)

    def named(self, name: str) -> str:
        """Declare a struct or enum; gives its qualified name."""
        file, declared = self.names[name]
        full = qualified(file, name)
        if full in self.types or full in self.making:
            return full
        if isinstance(declared, tree.Enum):
            self.types[full] = Enum(full, declared.values, closed=False, span=declared.span)
            return full
        self.making.add(full)
        fields = tuple(made for each in declared.members if (made := self.member(file, each, full)) is not None)
        self.making.discard(full)
        self.types[full] = Struct(full, fields, span=declared.span, options=(("thrift", True),))
        return full

    def member(self, file: tree.File, member: tree.Member, owner: str) -> Field | None:
        type_ = self.type(file, member.type, 0)
        if type_ is None:
            return None
        nested = member.notes.get("yarp.nested") == "true"
        if isinstance(type_, Ref) and type_.name in {owner, *self.making}:
            self.problems.append(say.endless(member.span, type_.name))
            return None
        options: list[tuple[str, Constant]] = [("nested", True)] if nested else []
        options += [("set", True)] if isinstance(member.type, tree.Container) and member.type.kind == "set" else []
        default = member.default if not isinstance(type_, Ref | Array | Map) else None
        return Field(member.name, type_, default=default, options=tuple(options), span=member.span)

    def type(self, file: tree.File, type_: tree.Type, depth: int) -> Type | None:
        if depth > MAX_TYPE_DEPTH:
            self.problems.append(say.nesting(type_.span, MAX_TYPE_DEPTH))
            return None
        if isinstance(type_, tree.Named):
            return self.by_name(file, type_, depth)
        inner = [self.type(file, each, depth + 1) for each in type_.inner]
        if None in inner:
            return None
        first = inner[0]
        if type_.kind == "map":
            if not isinstance(first, Bool | Int | String):
                self.problems.append(say.no_wire(type_.span, "a map with such keys"))
                return None
            assert inner[1] is not None
            return Map(first, inner[1])
        if type_.kind == "set" and not isinstance(first, Bool | Int | Float | String):
            self.problems.append(say.no_wire(type_.span, "a set of such elements"))
            return None
        assert first is not None
        return Array(first)

    def by_name(self, file: tree.File, type_: tree.Named, depth: int) -> Type | None:
        native = NATIVE.get(type_.notes.get("yarp.type", "").rpartition("::")[2])
        if native is not None:
            return native
        short = type_.name.rpartition(".")[2]
        if type_.name in SCALARS:
            return SCALARS[type_.name]
        typedef = next((each.typedefs[short] for each in (file, *(f for _, f in self.files)) if short in each.typedefs), None)
        if typedef is not None:
            return self.type(file, typedef, depth + 1)
        if short not in self.names:
            self.problems.append(say.unknown_type(type_.span, type_.name, (*SCALARS, *self.names)))
            return None
        declared = self.names[short][1]
        wanted = declared.notes.get("yarp.name") if isinstance(declared, tree.Struct) else None
        if wanted in VECTORS:
            return Array(Float(64, "float64"))
        if wanted is not None:
            self.problems.append(say.native_type(type_.span, wanted))
            return None
        return Ref(self.named(short), type_.span)

    def service(self, file: tree.File, service: tree.Service) -> None:
        """The functions of a service, then those that it inherits and does not have itself."""
        functions: dict[str, tuple[tree.File, tree.Function]] = {}
        for declaring, each in self.lineage(file, service):
            for function in each.functions:
                functions.setdefault(function.name, (declaring, function))
        self.functions += len(functions)
        if self.functions > MAX_FUNCTIONS:
            self.problems = [say.too_many_functions(service.span, MAX_FUNCTIONS)]
            return
        for declaring, function in functions.values():
            self.function(declaring, f"{qualified(file, service.name)}.{function.name}", function)

    def lineage(self, file: tree.File, service: tree.Service) -> list[tuple[tree.File, tree.Service]]:
        """A service and those that it extends, each with its file."""
        found = [(file, service)]
        while (extends := found[-1][1].extends) is not None:
            short = extends.text.rpartition(".")[2]
            if short not in self.services:
                self.problems.append(say.unknown_service(extends.span, extends.text, self.services))
                break
            if len(found) == MAX_ANCESTORS:
                self.problems.append(say.endless_service(service.span, service.name))
                break
            found.append(self.services[short])
        return found

    def function(self, file: tree.File, name: str, function: tree.Function) -> None:
        words = tuple(_word(number, each) for number, each in enumerate(function.name.split("_"), 1) if each)
        arguments = tuple(made for each in function.arguments if (made := self.member(file, each, name)) is not None)
        options: tuple[tuple[str, Constant], ...] = (("call", True), ("thrift", True))
        self.types[f"{name}.request"] = Struct(f"{name}.request", (*words, *arguments), span=function.span, options=options)
        if len(words) > 1:
            whole = Field("function", String("octets", "string"), constant=expr.Literal(function.name))
            self.types[f"{name}.call"] = Struct(f"{name}.call", (whole, *arguments), span=function.span, options=options)
        if function.oneway:
            return
        result = None if function.result is None else self.type(file, function.result, 0)
        fields = () if result is None else (Field("value", result, span=function.span),)
        self.types[f"{name}.reply"] = Struct(f"{name}.reply", fields, span=function.span, options=options)


def _word(number: int, word: str) -> Field:
    """A word of a function's name, as the constant that it is on the wire."""
    if len(word) > VOCAB_LETTERS:
        return Field(f"word_{number}", String("octets", "string"), constant=expr.Literal(word))
    return Field(f"word_{number}", Int(32, spelling="vocab32"), constant=expr.Literal(vocab(word.encode())))


def qualified(file: tree.File, name: str) -> str:
    """A name with the namespace of its file."""
    return f"{file.namespace}.{name}" if file.namespace else name
