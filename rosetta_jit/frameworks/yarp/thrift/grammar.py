"""The grammar of YARP's Thrift: what a file says, before any name is looked up.

File   = Include*, Namespace*, (Typedef | Enum | Const | Struct | Service)*
Type   = Named(name) | List(element) | Set(element) | Map(key, value)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.yarp.limits import MAX_THRIFT_DIGITS, MAX_TYPE_DEPTH
from rosetta_jit.frameworks.yarp.thrift import diagnostics as say
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.frameworks.yarp.thrift.lexer import Word
    from rosetta_jit.source import Span

Value = bool | int | float | str | None
"""Of a default or a constant; None for lists and maps, which no field can have."""


@dataclass(frozen=True, slots=True)
class Named:
    """A type by its name, with its annotations."""

    name: str
    span: Span
    notes: dict[str, str]


@dataclass(frozen=True, slots=True)
class Container:
    """``kind`` is list, set or map; a map has two inner types."""

    kind: str
    inner: tuple[Type, ...]
    span: Span


Type = Named | Container


@dataclass(frozen=True, slots=True)
class Member:
    """A field, or an argument of a function."""

    name: str
    type: Type
    default: Value
    required: bool
    notes: dict[str, str]
    span: Span


@dataclass(frozen=True, slots=True)
class Struct:
    """A struct, or an exception, which YARP takes for one."""

    name: str
    members: tuple[Member, ...]
    notes: dict[str, str]
    span: Span


@dataclass(frozen=True, slots=True)
class Enum:
    """Names and their numbers."""

    name: str
    values: tuple[tuple[str, int], ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Function:
    """``result`` is None for void."""

    name: str
    result: Type | None
    oneway: bool
    arguments: tuple[Member, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Service:
    """Functions that a port answers, and those of the service that it extends."""

    name: str
    functions: tuple[Function, ...]
    span: Span
    extends: Word | None = None


@dataclass(slots=True)
class File:
    """Everything that one file declares, in its order."""

    includes: list[Word] = field(default_factory=list["Word"])
    namespace: str = ""
    typedefs: dict[str, Type] = field(default_factory=dict[str, Type])
    constants: dict[str, tuple[Type, Value]] = field(default_factory=dict[str, "tuple[Type, Value]"])
    declared: list[Struct | Enum | Service] = field(default_factory=list["Struct | Enum | Service"])


def parse(words: list[Word]) -> File:
    """The file that some words are; raises SchemaError at the first word that the grammar does not allow."""
    return _Reading(words).file()


class _Reading:
    def __init__(self, words: list[Word]) -> None:
        self.words, self.at, self.depth = words, 0, 0

    # --- words -------------------------------------------------------------------------------------------------------

    @property
    def next(self) -> Word:
        return self.words[self.at]

    def take(self) -> Word:
        word = self.next
        self.at += word.kind != "end"
        return word

    def has(self, text: str) -> bool:
        """Take a word if it is that one."""
        found = self.next.text == text and self.next.kind in ("name", "sign")
        self.at += found
        return found

    def expect(self, text: str) -> Word:
        word = self.next
        if not self.has(text):
            raise self.wrong(f"`{text}`")
        return word

    def name(self) -> Word:
        if self.next.kind != "name":
            raise self.wrong("a name")
        return self.take()

    def wrong(self, wanted: str) -> SchemaError:
        found = self.next.text if self.next.kind == "end" else f"`{self.next.text:.30}`"
        return SchemaError((say.expected(self.next.span, wanted, found),))

    def deeper(self) -> None:
        self.depth += 1
        if self.depth > MAX_TYPE_DEPTH:
            raise SchemaError((say.nesting(self.next.span, MAX_TYPE_DEPTH),))

    # --- declarations ------------------------------------------------------------------------------------------------

    def file(self) -> File:
        file = File()
        while self.next.kind != "end":
            keyword = self.name()
            match keyword.text:
                case "include" | "cpp_include":
                    included = self.take()
                    file.includes += [included] if keyword.text == "include" else []
                case "namespace":
                    scope, name = (self.take() if self.next.text == "*" else self.name()), self.name()
                    file.namespace = name.text if scope.text in ("yarp", "*") or not file.namespace else file.namespace
                case "typedef":
                    type_ = self.type()
                    file.typedefs[self.name().text] = type_
                    self.separator()
                case "const":
                    type_, name = self.type(), self.name()
                    self.expect("=")
                    file.constants[name.text] = (type_, self.value())
                    self.separator()
                case "enum":
                    file.declared.append(self.enum())
                case "struct" | "exception":
                    file.declared.append(self.struct())
                case "service":
                    file.declared.append(self.service())
                case "union":
                    raise SchemaError((say.union(keyword.span),))
                case _:
                    self.at -= 1
                    raise self.wrong("a declaration: struct, enum, typedef, const, service, include or namespace")
        return file

    def separator(self) -> None:
        if not self.has(","):
            self.has(";")

    def enum(self) -> Enum:
        name, following = self.name(), 0
        values: list[tuple[str, int]] = []
        self.expect("{")
        while not self.has("}"):
            word = self.name()
            if self.has("="):
                number = self.value()
                if not isinstance(number, int) or isinstance(number, bool) or not -(1 << 31) <= number < 1 << 31:
                    self.at -= 1
                    raise self.wrong("a number of 32 bits")
                following = number
            values.append((word.text, following))
            following += 1
            self.notes()
            self.separator()
        self.notes()
        return Enum(name.text, tuple(values), name.span)

    def struct(self) -> Struct:
        name = self.name()
        self.expect("{")
        members = self.members("}")
        return Struct(name.text, members, self.notes(), name.span)

    def members(self, close: str) -> tuple[Member, ...]:
        members: list[Member] = []
        while not self.has(close):
            if self.next.kind == "number":
                self.take()
                self.expect(":")
            required = self.has("required")
            if not required:
                self.has("optional")
            type_, name = self.type(), self.name()
            default = self.value() if self.has("=") else None
            members.append(Member(name.text, type_, default, required, self.notes(), name.span))
            self.separator()
        return tuple(members)

    def service(self) -> Service:
        name = self.name()
        extends = self.name() if self.has("extends") else None
        self.expect("{")
        functions: list[Function] = []
        while not self.has("}"):
            oneway = self.has("oneway")
            result = None if self.has("void") else self.type()
            word = self.name()
            self.expect("(")
            arguments = self.members(")")
            if self.has("throws"):
                self.expect("(")
                self.members(")")
            functions.append(Function(word.text, result, oneway, arguments, word.span))
            self.notes()
            self.separator()
        self.notes()
        return Service(name.text, tuple(functions), name.span, extends)

    # --- types and values --------------------------------------------------------------------------------------------

    def type(self) -> Type:
        self.deeper()
        word = self.name()
        if word.text in ("list", "set", "map") and self.has("<"):
            inner = [self.type()]
            if word.text == "map":
                self.expect(",")
                inner.append(self.type())
            self.expect(">")
            self.notes()
            found: Type = Container(word.text, tuple(inner), word.span)
        else:
            found = Named(word.text, word.span, self.notes())
        self.depth -= 1
        return found

    def notes(self) -> dict[str, str]:
        """Annotations in parentheses: pairs of name and text."""
        found: dict[str, str] = {}
        if self.has("("):
            while not self.has(")"):
                name = self.name().text
                found[name] = self.text() if self.has("=") else "true"
                self.separator()
        return found

    def text(self) -> str:
        if self.next.kind != "text":
            raise self.wrong("a text in quotes")
        return self.take().text[1:-1]

    def value(self) -> Value:
        word = self.take()
        match word.kind:
            case "number" if len(word.text) <= MAX_THRIFT_DIGITS:
                return _number(word.text)
            case "text":
                return word.text[1:-1]
            case "name":
                return {"true": True, "false": False}.get(word.text, word.text)
            case _ if word.text in "[{":
                self.several("]" if word.text == "[" else "}")
                return None
            case _:
                self.at -= word.kind != "end"
                raise self.wrong("a value")

    def several(self, close: str) -> None:
        """Skip the values of a list or a map."""
        self.deeper()
        while not self.has(close):
            self.value()
            if self.has(":"):
                self.value()
            self.separator()
        self.depth -= 1


def _number(text: str) -> int | float:
    parse_: Callable[[str], int | float] = float if any(sign in text for sign in ".eE") and "x" not in text else lambda each: int(each, 0)
    try:
        return parse_(text)
    except ValueError:  # a decimal with a leading zero
        return int(text)
