"""Declarations to the meta-model, with every check that lcm-gen makes, and those without which its code would not compile."""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.limits import MAX_DIGITS, MAX_DIMENSIONS, MAX_PROBLEMS
from rosetta_jit.frameworks.lcm.shape import BYTE, CONSTANTS, INTEGERS, PRIMITIVES, SIZES
from rosetta_jit.frameworks.lcm.tree import Constant, EnumDeclaration, Member, Name, StructDeclaration, Word, qualified
from rosetta_jit.model import expr
from rosetta_jit.model.types import Array, Bytes, Enum, Field, Float, Int, NamedConstant, Ref, Schema, Struct, Type
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.frameworks.lcm.files import Gathered


LARGEST_INT32 = (1 << 31) - 1
LARGEST_FLOAT = 3.4028234663852886e38


def schema_of(gathered: Gathered, problems: list[Diagnostic]) -> Schema:
    """The types of the declarations; what is wrong with them is added to the problems."""
    types: dict[str, Struct | Enum] = {}
    for name, declaration in gathered.declarations.items():
        if isinstance(declaration, StructDeclaration):
            types[name] = _Struct(declaration, problems).struct(name)
        else:
            types[name] = _enum(name, declaration, problems)
    return Schema(types, tuple(gathered.sources))


@dataclass(slots=True)
class _Struct:
    """A struct in the making. What is declared further down can be no size yet."""

    declaration: StructDeclaration
    problems: list[Diagnostic]
    names: dict[str, Name] = field(default_factory=dict[str, "Name"])
    members: dict[str, Member] = field(default_factory=dict[str, Member])
    constants: dict[str, NamedConstant] = field(default_factory=dict[str, NamedConstant])
    texts: dict[str, str] = field(default_factory=dict[str, str])

    def struct(self, name: str) -> Struct:
        fields: list[Field] = []
        for item in self.declaration.items:
            if len(self.problems) >= MAX_PROBLEMS:
                break
            if item.name.text in self.names:
                self.problems.append(say.repeated_name(item.name, self.names[item.name.text].span))
                continue
            self.names[item.name.text] = item.name
            if isinstance(item, Constant):
                self.constant(item)
            else:
                fields.append(self.field(item))
                self.members[item.name.text] = item
        span = self.declaration.name.span
        return Struct(name, tuple(fields), self.declaration.doc, span, tuple(self.constants.values()))

    def constant(self, constant: Constant) -> None:
        name, type_ = constant.name.text, PRIMITIVES.get(constant.type.text)
        self.texts[name] = constant.value.text
        if constant.type.text not in CONSTANTS or type_ is None:
            self.problems.append(say.constant_type(constant.type, sorted(CONSTANTS)))
            return
        value = _constant_value(type_, constant.value, self.problems)
        self.constants[name] = NamedConstant(name, type_, value, constant.doc)

    def field(self, member: Member) -> Field:
        if len(member.sizes) > MAX_DIMENSIONS:
            self.problems.append(say.too_many_dimensions(member.sizes[MAX_DIMENSIONS], MAX_DIMENSIONS))
        sizes = [self.size(each) for each in member.sizes[:MAX_DIMENSIONS]]
        written = [self.texts.get(each.text, each.text) for each in member.sizes]
        plain = all(isinstance(size, expr.Path) or text == str(size) for size, text in zip(sizes, written, strict=False))
        return Field(
            member.name.text,
            self.type(member.type, sizes),
            options=() if plain else ((SIZES, ",".join(written)),),
            doc=member.doc,
            span=member.name.span,
        )

    def type(self, name: Name, sizes: list[int | expr.Path]) -> Type:
        outer = sizes
        if name.text == BYTE and sizes:
            *outer, last = sizes
            type_: Type = Bytes(BYTE, last)
        else:
            type_ = PRIMITIVES.get(name.text) or Ref(qualified(self.declaration.package, name.text), name.span)
        for size in reversed(outer):
            type_ = Array(type_, size)
        return type_

    def size(self, size: Name) -> int | expr.Path:
        """A size that a number, a constant or a field tells; where it is wrong, any other stands for it."""
        text = size.text
        if text in self.members:
            return self.size_field(size, self.members[text])
        if text in self.texts:
            return self.fixed(size, self.constants.get(text))
        value = integer(text)
        if value is None:
            self.problems.append(say.unknown_size(size, self.known_sizes(), later=self.declared_later(text)))
        elif not 0 < value <= LARGEST_INT32:
            self.problems.append(say.size_range(size, value, LARGEST_INT32))
        else:
            return value
        return 1

    def size_field(self, size: Name, member: Member) -> expr.Path:
        if member.sizes:
            self.problems.append(say.size_is_array(size))
        elif member.type.text not in INTEGERS:
            self.problems.append(say.size_type(size, member.type.text))
        return expr.Path("wire", (expr.Member(size.text, size.span),), size.span)

    def fixed(self, size: Name, constant: NamedConstant | None) -> int:
        if constant is None:
            return 1
        if not isinstance(constant.value, int):
            self.problems.append(say.size_type(size, "float"))
            return 1
        if not 0 <= constant.value <= LARGEST_INT32:
            self.problems.append(say.size_range(size, constant.value, LARGEST_INT32))
            return 1
        return constant.value

    def known_sizes(self) -> tuple[str, ...]:
        fields = (name for name, each in self.members.items() if each.type.text in INTEGERS and not each.sizes)
        return (*fields, *(name for name, each in self.constants.items() if isinstance(each.type, Int)))

    def declared_later(self, text: str) -> bool:
        return any(item.name.text == text for item in self.declaration.items)


def _constant_value(type_: Type, value: Name, problems: list[Diagnostic]) -> int | float:
    if isinstance(type_, Int):
        number = integer(value.text)
        limit = 1 << (type_.bits - 1)
        if number is None:
            problems.append(say.no_integer(value))
        elif not -limit <= number < limit:
            problems.append(say.constant_range(value, type_.spelling))
        else:
            return number
        return 1
    real = floating(value.text)
    if real is None:
        problems.append(say.no_number(value))
    elif isinstance(type_, Float) and type_.bits == 32 and abs(real) > LARGEST_FLOAT:
        problems.append(say.constant_range(value, type_.spelling))
    return 1.0 if real is None else real


def _enum(name: str, declaration: EnumDeclaration, problems: list[Diagnostic]) -> Enum:
    """Open, as lcm-gen's are: words are added over time, and the fingerprint stays the same."""
    names: dict[str, Name] = {}
    words: dict[int, str] = {}
    largest = 0
    for word in declaration.words:
        if len(problems) >= MAX_PROBLEMS:
            break
        number = _enumerator(word, largest + 1, problems)
        if word.name.text in names:
            problems.append(say.repeated_name(word.name, names[word.name.text].span))
        elif number in words:
            problems.append(say.repeated_number(word.name, words[number], number))
        elif number is not None:
            words[number] = word.name.text
            largest = max(largest, number)
        names.setdefault(word.name.text, word.name)
    return Enum(name, tuple((word, number) for number, word in words.items()), closed=False, span=declaration.name.span)


def _enumerator(word: Word, following: int, problems: list[Diagnostic]) -> int | None:
    value = following if word.number is None else integer(word.number.text)
    if value is None:
        problems.append(say.no_integer(word.number or word.name))
    elif not -LARGEST_INT32 - 1 <= value <= LARGEST_INT32:
        problems.append(say.constant_range(word.number or word.name, "int32_t"))
    else:
        return value
    return None


_INTEGER = re.compile(r"-?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_DECIMAL = re.compile(r"-?([0-9]+(?:\.[0-9]*)?|\.[0-9]+)([eE]-?[0-9]+)?")
_HEXADECIMAL = re.compile(r"-?0[xX]([0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)([pP]-?[0-9]+)?")


def integer(text: str) -> int | None:
    """A decimal, hexadecimal or octal number (``010`` is 8); None if it is none."""
    if len(text) > MAX_DIGITS or not _INTEGER.fullmatch(text):
        return None
    digits = text.removeprefix("-")
    base = 16 if digits[1:2] in {"x", "X"} else 8 if digits.startswith("0") else 10
    return -int(digits, base) if text.startswith("-") else int(digits, base)


def floating(text: str) -> float | None:
    """A finite number; None if it is none."""
    if len(text) > MAX_DIGITS:
        return None
    try:
        value = float.fromhex(text) if _HEXADECIMAL.fullmatch(text) else float(text) if _DECIMAL.fullmatch(text) else None
    except OverflowError:
        return None
    return value if value is not None and isfinite(value) else None
