"""Checks of one direction's rules taken together: every field that must be set is set, once, and arrays are filled.

A field that can be absent (an optional one, a union, a map) may be left out; one that cannot must be set, an array by
its length and all of its elements. Fields that the schema fixes need no rule.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from itertools import pairwise

from rosetta_jit.catalogue import check as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.algebra.polynomial import Polynomial, TooComplexError, number
from rosetta_jit.language.check.block_paths import TooManyWaysError, ways
from rosetta_jit.language.check.coverage import contradictions, contradictions_in_elements, coverage, implied
from rosetta_jit.language.check.tiling import Run
from rosetta_jit.language.check.written_places import Write, enter, writes_of
from rosetta_jit.language.limits import MAX_CHECKED_WAYS
from rosetta_jit.language.places import field_names, places_in
from rosetta_jit.language.resolve.rules import TypedRules
from rosetta_jit.language.scope import Message, element_type
from rosetta_jit.language.typed import Const, Rule
from rosetta_jit.model.expr import Literal, Side
from rosetta_jit.model.types import Array, Bytes, Field, Map, Optional, Struct, Type, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass


def check_complete(rules: TypedRules, target: Message, missing: Missing) -> list[Diagnostic]:
    """What is wrong with a block as a whole; ``missing`` says how missing rules are reported."""
    shared: list[Diagnostic] = []
    try:
        found = [_check_way(way, rules, target, missing) for way in ways(rules.rules, shared)]
    except TooManyWaysError as error:
        return [words.too_many_ways(error.span, MAX_CHECKED_WAYS)]
    ways_with = Counter(problem for problems in found for problem in dict.fromkeys(problems))
    # Where rounds set different places, what one way through them lacks is the same mistake again.
    some = [words.in_one_way(problem) for problem, count in ways_with.items() if count < len(found) and not shared]
    return [*shared, *(problem for problem, count in ways_with.items() if count == len(found)), *some]


def _check_way(way: tuple[Rule, ...], rules: TypedRules, target: Message, missing: Missing) -> list[Diagnostic]:
    """What is wrong with one way through a block."""
    problems: list[Diagnostic] = []
    broken = set(rules.broken)
    writes = writes_of(way, problems, broken)
    assigned = frozenset(field_names(place) for place in places_in(rules.rules))
    checker = _Checker(target, missing, broken, problems, assigned)
    checker.struct(_Where("", (), 0), target.root, writes)
    return problems


@dataclass(frozen=True, slots=True)
class Missing:
    """How a missing rule is reported: the side that it would set, where its type is named, and the block in which to write it.

    ``wires`` are where the types of several wires are named.
    """

    side: Side
    span: Span | None
    block: words.Block
    wires: Mapping[str, Span | None] | None = None

    def place(self, fields: tuple[str, ...]) -> Span | None:
        """Where a field is to be reported."""
        return (self.wires or {}).get(fields[0], self.span)


@dataclass(frozen=True, slots=True)
class _Where:
    """A place as text, as field names without indices, and the number of indices in it."""

    text: str
    fields: tuple[str, ...]
    level: int

    def field(self, name: str) -> _Where:
        return _Where(f"{self.text}.{name}", (*self.fields, name), self.level)

    def around(self) -> str:
        """What a union, which is named by its cases, stands in."""
        return self.text.removesuffix(f".{self.fields[-1]}")

    def case(self, name: str) -> _Where:
        """A case of a union: named as a field of what is around."""
        return _Where(f"{self.around()}.{name}", (*self.fields, name), self.level)

    def element(self) -> _Where:
        return _Where(f"{self.text}[]", self.fields, self.level + 1)


@dataclass(frozen=True, slots=True)
class _Extent:
    """The length of an array, and the rule that sets it."""

    length: Polynomial
    span: Span | None


@dataclass(frozen=True, slots=True)
class _Checker:
    """Descends along the places that are written; the depth is bounded by the longest path of a rule."""

    target: Message
    missing: Missing
    broken: set[tuple[str, ...]]
    problems: list[Diagnostic]
    assigned: frozenset[tuple[str, ...]]

    def struct(self, where: _Where, struct: Struct, writes: list[Write]) -> None:
        by_field = _by_field(writes)
        implied_fields = self.implied(where, struct, by_field)
        for field in struct.fields:
            if field.name not in implied_fields:
                self.field(where.field(field.name), field, by_field.get(field.name, []))
        self.problems.extend(contradictions(where.text, struct, by_field, self.target))

    def implied(self, where: _Where, struct: Struct, by_field: dict[str, list[Write]], step: int = 0) -> set[str]:
        """Discriminators that no rule sets, and that a case implies."""
        return {name for name in implied(struct, by_field, step) if (*where.fields, name) not in self.assigned}

    def field(self, where: _Where, field: Field, writes: list[Write]) -> None:
        if field.constant is not None:
            self.constant(where, field.constant, writes)
        elif writes:
            self.value(where, field.type, writes)
        elif self.must_be_set(field) and not self.is_broken(where):
            type_ = self.target.value_type(field.type)
            kind = "value" if not isinstance(type_, Array) else "array" if type_.length is None else "fixed"
            missing = self.missing
            self.problems.append(
                words.never_set(missing.place(where.fields), missing.side, where.text, field.span, kind=kind, block=missing.block)
            )

    def constant(self, where: _Where, constant: object, writes: list[Write]) -> None:
        known = constant.value if isinstance(constant, Literal) else None
        for write in writes:
            if not (isinstance(write.value, Const) and known is not None and write.value.value == known):
                self.problems.append(words.constant(write.span, where.text, "" if known is None else repr(known)))

    def value(self, where: _Where, type_: Type, writes: list[Write]) -> None:
        whole = [write for write in writes if not write.steps and write.length is None]
        for write in whole:
            self.not_repeated(where, write)
        if whole:
            others = [write for write in writes if write is not whole[0]]
            self.problems.extend(words.set_twice(other.span, where.text, whole[0].span) for other in others)
            return
        match self.target.value_type(type_):
            case Struct() as struct:
                self.struct(where, struct, writes)
            case Union() as union:
                self.union(where, union, writes)
            case (Array() | Bytes() | Map()) as sequence:
                self.sequence(where, sequence, writes)
            case _:
                pass

    def union(self, where: _Where, union: Union, writes: list[Write]) -> None:
        by_field = _by_field(writes)
        shown = where.around() if union.discriminator else where.text
        for first, second in pairwise(by_field):
            self.problems.append(words.cases(by_field[second][0].span, shown, first, second))
        for case in union.cases:
            if case.name in by_field:
                self.field(where.case(case.name), case, by_field[case.name])

    def sequence(self, where: _Where, type_: Array | Bytes | Map, writes: list[Write]) -> None:
        lengths = [write for write in writes if write.length is not None and not write.steps]
        elements = [write for write in writes if write.steps]
        for write in lengths:
            self.not_repeated(where, write)
        self.problems.extend(words.set_twice(extra.span, f"len({where.text})", lengths[0].span) for extra in lengths[1:])
        if self.is_broken(where):
            return
        extent = _extent(type_, lengths)
        if extent is None:
            self.problems.append(words.elements_without_length(elements[0].span, where.text, self.missing.side, self.missing.block))
        elif elements:
            self.elements(where, element_type(type_), extent, elements)
        elif extent.length.constant() != 0:
            self.problems.append(words.length_without_elements(extent.span, where.text))

    def elements(self, where: _Where, element: Type, extent: _Extent, writes: list[Write]) -> None:
        """Elements of structs are checked field by field, as each field may be set by other loops."""
        struct = self.target.value_type(element)
        parts = [write for write in writes if len(write.steps) > 1]
        if not isinstance(struct, Struct) or not parts:
            for group in self.fill(where, where.level, extent, writes):
                self.value(where.element(), element, group)
            return
        whole = [write for write in writes if len(write.steps) == 1]
        by_field = _by_field(parts, 1)
        implied_fields = self.implied(where, struct, by_field, 2)
        self.problems.extend(contradictions_in_elements(where.element().text, struct, parts, where.level, self.target))
        for field in struct.fields:
            if field.name in implied_fields:
                continue
            name = where.element().field(field.name)
            mine = whole + by_field.get(field.name, [])
            if not mine or field.constant is not None:
                self.field(name, field, [])
                continue
            teller = field.type.discriminator if isinstance(field.type, Union) else ""
            owed = self.must_be_set(field) or teller in implied_fields
            filled = where.element().field(teller) if teller in implied_fields else name
            for group in self.fill(filled, where.level, extent, mine, optional=not owed):
                self.part(name, field, group)

    def part(self, where: _Where, field: Field, group: list[Write]) -> None:
        """One field of one element, given the writes to it and to the whole element."""
        whole = [write for write in group if not write.steps]
        parts = [write.below() for write in group if write.steps]
        if whole:
            self.value(where, field.type, whole + parts)
        else:
            self.field(where, field, parts)

    def fill(self, where: _Where, level: int, extent: _Extent, writes: list[Write], *, optional: bool = False) -> list[list[Write]]:
        """Check that writes fill an array; the writes to one element, for each kind of element that they tell apart.

        ``level`` is how many arrays are around it.
        """
        groups: dict[Run, list[Write]] = {}
        for write in writes:
            try:
                entered = enter(write, level)
            except TooComplexError:
                self.problems.append(words.too_complex(write.span))
                return []
            if entered is None:
                self.problems.append(words.not_affine(write.span, where.text))
                return []
            groups.setdefault(entered[0], []).append(entered[1])
        if any(sum(not write.steps for write in group) > 1 for group in groups.values()):
            return list(groups.values())  # one is set twice, and another probably not for this reason
        try:
            self.problems.extend(coverage(where.text, list(groups), extent.length, extent.span or self.missing.span, optional=optional))
        except TooComplexError:
            self.problems.append(words.too_complex(extent.span))
        return list(groups.values())

    def not_repeated(self, where: _Where, write: Write) -> None:
        repeated = [loop for loop in write.loops if loop.count != number(1)]
        if repeated:
            self.problems.append(words.set_in_loop(write.span, where.text, repeated[-1].variable))

    def is_broken(self, where: _Where) -> bool:
        """Whether a broken rule may have meant this place, something within, or something around."""
        return any(all(a == b for a, b in zip(where.fields, other, strict=False)) for other in self.broken)

    def must_be_set(self, field: Field) -> bool:
        """Whether leaving a field out would leave something undefined; recursive types are walked once."""
        pending, seen = [field], set[str]()
        while pending:
            current = pending.pop()
            type_ = self.target.schema.resolve(current.type)
            if isinstance(type_, Optional) and current.required:
                type_ = self.target.value_type(type_)
            match type_:
                case _ if current.constant is not None:
                    pass
                case Optional() | Union() | Map():
                    pass
                case Struct(name=name, fields=fields):
                    pending += fields if name not in seen else ()
                    seen.add(name)
                case _:
                    return True
        return False


def _extent(type_: Array | Bytes | Map, lengths: list[Write]) -> _Extent | None:
    if lengths and lengths[0].length is not None:
        return _Extent(lengths[0].length, lengths[0].span)
    fixed = type_.fixed if isinstance(type_, Array) else None
    return None if fixed is None else _Extent(number(fixed), None)


def _by_field(writes: list[Write], step: int = 0) -> dict[str, list[Write]]:
    found: dict[str, list[Write]] = {}
    for write in writes:
        field = write.steps[step]
        if not isinstance(field, Polynomial):
            found.setdefault(field.name, []).append(write if step else write.below())
    return found
