"""The front end of typelib's registries: `.tlb` files, which Rock keeps beside the headers that they were read from.

    <numeric name="/int32_t" category="sint" size="4"/>           category: sint, uint, float
    <enum name="/base/Mode"><value symbol="ON" value="1"/></enum>
    <compound name="/base/Pose" size="56"><field name="position" type="/base/Vector" offset="0"/></compound>
    <container name="/std/vector</double>" of="/double" size="24" kind="/std/vector"/>
    <array name="/double[3]" of="/double" dimension="3"/>         or none: a field may say ``/double[3]`` by itself
    <alias name="/int" source="/int32_t"/>
    <opaque/>, <null/>, <pointer/>: known by name, refused as members

Names become those of C++: ``/std/vector</base/Pose>`` is ``std::vector<base::Pose>``. What the rules of the ABI do not give is pinned down
by the offsets of the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.depth import nesting_problems, references
from rosetta_jit.frameworks.orocos.elements import Element, read_elements
from rosetta_jit.frameworks.orocos.layout import STRING, VECTOR, Layouts, pinned, unaccounted
from rosetta_jit.frameworks.orocos.limits import MAX_PROBLEMS, MAX_SIZE, MAX_TYPE_DEPTH
from rosetta_jit.frameworks.orocos.messages import NUMBERS, array, with_messages, wrapped
from rosetta_jit.frameworks.orocos.messages import STRING as TEXT
from rosetta_jit.model.types import Array, Bytes, Declaration, Enum, Field, Float, Int, Ref, Schema, Struct, Type
from rosetta_jit.source import Source, Span
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load

INT32 = range(-(1 << 31), 1 << 31)

_DIGITS = re.compile(r"-?[0-9]{1,18}")
_BRACKETS = re.compile(r"(.*)\[([0-9]{1,18})\]", re.DOTALL)


def parse(source: Source, load: Load) -> Schema:  # noqa: ARG001 - a registry is complete
    """All types of a registry, by their C++ names; aliases of structs and containers are types too.

    As `rosetta_jit.frameworks.orocos.header.parse` does, it declares messages of one number and of vectors.

    Raises
    ------
    SchemaError
        With everything that is wrong in the file.
    """
    registry = _Registry(source)
    for each in read_elements(source):
        registry.register(each)
    registry.declare()
    registry.raise_problems()
    types = with_messages(registry.declared, {}, Span(source, 0, 1))
    return Schema(MappingProxyType(types), (source.name,))


@dataclass(slots=True)
class _Registry:
    """Elements by their name in the file, what they became, and what is wrong."""

    source: Source
    elements: dict[str, Element] = field(default_factory=dict[str, "Element"])
    declared: dict[str, Declaration] = field(default_factory=dict[str, "Declaration"])
    problems: list[Diagnostic] = field(default_factory=list["Diagnostic"])

    def register(self, element: Element) -> None:
        name = self.attribute(element, "name")
        if name is None:
            return
        if name in self.elements:
            self.problems.append(words.repeated_name(element.span_of("name"), name))
        self.elements.setdefault(name, element)

    def declare(self) -> None:
        """Enums and structs, then what names others."""
        for name, element in self.elements.items():
            match element.tag:
                case "enum":
                    self.declared[cxx_name(name)] = self.enum(name, element)
                case "compound":
                    self.declared[cxx_name(name)] = self.compound(name, element)
                case _:
                    pass
        self.raise_problems()
        self.problems += nesting_problems(self.declared)
        self.raise_problems()
        self.pin()
        for name, element in self.elements.items():
            if element.tag in {"alias", "container", "array"}:
                self.name_again(name, element)
        self.problems += nesting_problems(self.declared)

    def raise_problems(self) -> None:
        if self.problems:
            raise SchemaError(tuple(self.problems[:MAX_PROBLEMS]))

    # --- declarations ------------------------------------------------------------------------------------------------

    def enum(self, name: str, element: Element) -> Enum:
        values: list[tuple[str, int]] = []
        for each in element.parts:
            symbol, number = self.attribute(each, "symbol"), self.number(each, "value")
            if number is not None and number not in INT32:
                self.problems.append(words.large_enumerator(each.span_of("value"), name))
            values.append((symbol or "", number or 0))
        return Enum(cxx_name(name), tuple(values), closed=False, span=element.span_of("name"))

    def compound(self, name: str, element: Element) -> Struct:
        fields: dict[str | None, Field | None] = {}
        for each in element.parts:
            member, type_name = self.attribute(each, "name"), self.attribute(each, "type")
            type_ = None if type_name is None else self.type(type_name, each, "type")
            if member in fields and member is not None:
                self.problems.append(words.repeated_member(each.span_of("name"), name, member))
            fields[member] = None if member is None or type_ is None else Field(member, type_, span=each.span_of("name"))
        return Struct(cxx_name(name), tuple(each for each in fields.values() if each is not None), span=element.span_of("name"))

    def pin(self) -> None:
        """Offsets and sizes as the file has them; a struct before those that hold it."""
        layouts = Layouts(self.declared)
        for name in self.inner_first():
            element, struct = self.elements[name], self.declared[cxx_name(name)]
            assert isinstance(struct, Struct)
            offsets = [self.number(each, "offset") for each in element.parts]
            size = self.number(element, "size")
            if size is None or not 0 < size <= MAX_SIZE:
                self.problems.append(words.wrong_attribute(element.span_of("size"), element.attributes.get("size", ""), "a size in bytes"))
                continue
            exact = pinned(struct, offsets, size, None, layouts)
            strange = unaccounted(exact, layouts)
            if strange is not None:
                self.problems.append(words.strange_layout(strange.span, strange.name))
            self.declared[exact.name] = exact

    def inner_first(self) -> Iterator[str]:
        """The names of all compounds, each after those that it holds."""
        names = {cxx_name(name): name for name, element in self.elements.items() if element.tag == "compound"}
        begun: set[str] = set()
        for root in names:
            path = [] if root in begun else [(root, iter(_held(self.declared[root])))]
            begun.add(root)
            while path:
                name, held = path[-1]
                inner = next((each for each in held if each in names and each not in begun), None)
                if inner is None:
                    path.pop()
                    yield names[name]
                else:
                    begun.add(inner)
                    path.append((inner, iter(_held(self.declared[inner]))))

    def name_again(self, name: str, element: Element) -> None:
        """A container, or another name of a struct or container, as a message."""
        type_ = self.type(name, element, "name")
        known, span = cxx_name(name), element.span_of("name")
        match type_:
            case Ref(target) if known not in self.declared:
                struct = self.declared[target]
                if isinstance(struct, Struct):
                    self.declared[known] = Struct(known, struct.fields, span=span, options=struct.options)
            case Array() | Bytes() if known not in self.declared:
                self.declared[known] = wrapped(known, type_, span, {})
            case _:
                pass

    # --- types -------------------------------------------------------------------------------------------------------

    def type(self, name: str, user: Element, attribute: str, depth: int = 0) -> Type | None:
        """The type of a name, None where that is wrong."""
        element = self.elements.get(name)
        if depth > MAX_TYPE_DEPTH:
            return self.refuse(words.nested_too_deep(user.span_of(attribute), name[:80], MAX_TYPE_DEPTH))
        if element is None:
            return self.unregistered(name, user, attribute, depth)
        match element.tag:
            case "numeric" | "character":
                return self.numeric(name, element)
            case "enum" | "compound":
                return Ref(cxx_name(name), user.span_of(attribute))
            case "alias":
                return self.inner(element, "source", depth)
            case "array":
                return self.sized(self.inner(element, "of", depth), self.number(element, "dimension"), element, "dimension")
            case "container":
                return self.container(name, element, depth)
            case kind:
                return self.refuse(words.unusable_type(user.span_of(attribute), name, kind))

    def unregistered(self, name: str, user: Element, attribute: str, depth: int) -> Type | None:
        """An array by its brackets, or a type of C++ itself."""
        brackets = _BRACKETS.fullmatch(name)
        if brackets is not None:
            return self.sized(self.type(brackets[1], user, attribute, depth + 1), int(brackets[2]), user, attribute)
        if name.endswith("*"):
            return self.refuse(words.unusable_type(user.span_of(attribute), name, "pointer"))
        number = NUMBERS.get(name.removeprefix("/"))
        return number or self.refuse(words.unknown_type(user.span_of(attribute), name))

    def inner(self, element: Element, attribute: str, depth: int) -> Type | None:
        name = self.attribute(element, attribute)
        return None if name is None else self.type(name, element, attribute, depth + 1)

    def numeric(self, name: str, element: Element) -> Type | None:
        size, category = self.number(element, "size"), element.attributes.get("category", "sint")
        word = name.removeprefix("/")
        if word == "bool" and size == 1:
            return NUMBERS["bool"]
        match category, size:
            case "float", 4 | 8:
                return Float(32 if size == 4 else 64, word)
            case "sint" | "uint", 1 | 2 | 4 | 8:
                bits = {1: 8, 2: 16, 4: 32, 8: 64}
                return Int(bits[size], category == "sint", word)  # pyright: ignore[reportArgumentType] - one of the four
            case _:
                return self.refuse(words.wrong_attribute(element.span_of("size"), f"{category}, {size}", "a number of at most 64 bits"))

    def container(self, name: str, element: Element, depth: int) -> Type | None:
        kind, size = self.attribute(element, "kind"), element.attributes.get("size", "0")
        inner = self.inner(element, "of", depth)
        if kind not in {"/std/string", "/std/vector", None}:
            return self.refuse(words.wrong_attribute(element.span_of("kind"), kind or "", "/std/vector or /std/string"))
        expected = STRING.size if kind == "/std/string" else VECTOR.size
        if size not in {"0", str(expected)} and _DIGITS.fullmatch(size):
            return self.refuse(words.foreign_container(element.span_of("size"), name, int(size), expected))
        if kind == "/std/string":
            return TEXT
        return None if inner is None else array(inner)

    def sized(self, element: Type | None, length: int | None, user: Element, attribute: str) -> Type | None:
        if element is None or length is None:
            return None
        if not 0 < length <= MAX_SIZE:
            return self.refuse(words.wrong_attribute(user.span_of(attribute), str(length), "a number of elements"))
        return array(element, length)

    # --- attributes --------------------------------------------------------------------------------------------------

    def attribute(self, element: Element, name: str) -> str | None:
        if name not in element.attributes:
            return self.refuse(words.missing_attribute(element.span, element.tag, name))
        return element.attributes[name]

    def number(self, element: Element, name: str) -> int | None:
        text = self.attribute(element, name)
        if text is None or _DIGITS.fullmatch(text):
            return None if text is None else int(text)
        return self.refuse(words.wrong_attribute(element.span_of(name), text, "a number"))

    def refuse(self, problem: Diagnostic) -> None:
        if problem not in self.problems:
            self.problems.append(problem)


def cxx_name(name: str) -> str:
    """A name of typelib as C++ writes it."""
    return re.sub(r"(^|[<,])/", r"\1", name).replace("/", "::")


def _held(struct: Declaration) -> list[str]:
    return [name for name, _, by_value in references(struct) if by_value]
