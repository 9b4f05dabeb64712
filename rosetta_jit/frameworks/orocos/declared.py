"""From what the compiler saw to a schema: every struct is judged, members become fields, and what the ABI does not tell is pinned down."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.orocos import diagnostics as words
from rosetta_jit.frameworks.orocos.depth import dependents, nesting_problems, reached
from rosetta_jit.frameworks.orocos.includes import MAIN
from rosetta_jit.frameworks.orocos.layout import Extent, Layouts, pinned, unaccounted
from rosetta_jit.frameworks.orocos.limits import MAX_PROBLEMS, MAX_SIZE
from rosetta_jit.frameworks.orocos.messages import NUMBERS, STRING, array, options_of, with_messages, wrapped
from rosetta_jit.model.types import Array, Bytes, Declaration, Enum, Field, Int, NamedConstant, Ref, Schema, Struct, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.frameworks.orocos.compiler import Places

_MARKS = re.compile(r"^\s*(/\*\*<?|/\*!<?|///?!?<?|\*)")
INT32 = range(-(1 << 31), 1 << 31)


@dataclass(slots=True)
class Judging:
    """What is wrong with each declaration by its name, and the types of those that are right."""

    places: Places
    problems: dict[str, list[Diagnostic]] = field(default_factory=dict[str, "list[Diagnostic]"])
    types: dict[str, Declaration] = field(default_factory=dict[str, "Declaration"])
    enums: dict[str, str] = field(default_factory=dict[str, str])
    constants: dict[str, NamedConstant] = field(default_factory=dict[str, NamedConstant])
    main: set[str] = field(default_factory=set[str])
    known: frozenset[str] = frozenset()

    def span(self, item: Any) -> Span:
        return self.places.span(item["place"])

    def refuse(self, name: str, problem: Diagnostic) -> None:
        self.problems.setdefault(name, []).append(problem)

    # --- declarations ------------------------------------------------------------------------------------------------

    def declare(self, name: str, declaration: Declaration, place: list[Any]) -> None:
        if name in self.types:
            self.refuse(name, words.repeated_name(self.places.span(place), name))
        self.types[name] = declaration
        if place[0] == MAIN:
            self.main.add(name)

    def enum(self, item: Any) -> None:
        name, scalar = item["name"], f"{'i' if item['signed'] else 'u'}{item['bits']}"
        scope = f"{item['scope']}::" if item["scope"] else ""
        numbers: list[tuple[str, int]] = [(each, number) for each, number in item["values"]]
        if not name:
            found = {scope + each: number for each, number in numbers if number in INT32}
            self.constants |= {each: NamedConstant(each, NUMBERS["int"], number) for each, number in found.items()}
            return
        if item["bits"] > 32 or any(number not in INT32 for _, number in numbers):
            self.refuse(name, words.large_enumerator(self.span(item), name))
        if item["bits"] < 32:
            self.enums[name] = scalar
        # An enum has the values of its underlying type, or of as many bits as its enumerators need. (ISO C++17, [dcl.enum] 8)
        self.declare(name, Enum(name, tuple(numbers), closed=False, span=self.span(item)), item["place"])

    def record(self, item: Any) -> None:
        name, span = item["name"], self.span(item)
        if item["again"] is not None:
            self.refuse(name, words.repeated_name(self.places.span(item["again"]), name))
        if item["virtual"] or any(base["virtual"] for base in item["bases"]):
            self.refuse(name, words.virtual_class(span, name))
        for base in item["bases"]:
            if not base["name"] or not base["public"]:
                self.refuse(name, words.unusable_base(self.span(base), name))
            self.problems.setdefault(name, []).extend(self.problems.get(base["name"], []))
        fields = [self.field(name, member) for member in item["members"]]
        self.unique(name, item["members"])
        self.declare(name, Struct(name, tuple(fields), _doc(item["doc"]), span), item["place"])

    def unique(self, record: str, members: list[Any]) -> None:
        seen: set[str] = set()
        for member in members:
            if member["name"] in seen - {""}:
                self.refuse(record, words.repeated_member(self.span(member), record, member["name"]))
            seen.add(member["name"])

    def field(self, record: str, member: Any) -> Field:
        name, span = member["name"], self.span(member)
        if not name:
            self.refuse(record, words.unnamed_member(span, record))
            return Field("", NUMBERS["int"], span=span)
        type_ = self.type(record, name, member["type"], span)
        if member["bits"]:
            self.refuse(record, words.bit_field(span, name))
        if not member["public"]:
            self.refuse(record, words.hidden_member(span, name))
        return Field(name, type_, options=options_of(type_, self.enums), doc=_doc(member["doc"]), span=span)

    def type(self, record: str, member: str, seen: list[Any], span: Span) -> Type:
        match seen:
            case ["bool"]:
                return NUMBERS["bool"]
            case ["int" | "float", *_, word] if word in NUMBERS:
                return NUMBERS[word]
            case ["int", bits, signed, word]:
                return _integer(bits, signed, word)
            case ["string"]:
                return STRING
            case ["vector", element]:
                return array(self.type(record, member, element, span))
            case ["array", element, length]:
                if not 0 < length <= MAX_SIZE:
                    self.refuse(record, words.empty_array(span, member) if length == 0 else words.too_large(span, member, MAX_SIZE))
                return array(self.type(record, member, element, span), length)
            case ["record" | "enum", name] if name in self.known:
                return Ref(name, span)
            case ["record" | "enum", name]:  # it is part of a template, or of a function
                return self.type(record, member, ["no", "template", name], span)
            case ["no", reason, word]:
                self.refuse(record, words.refused_type(span, member, reason, word))
                return NUMBERS["int"]
            case _:
                raise AssertionError(seen)

    def alias(self, name: str, seen: list[Any], place: list[Any], doc: str) -> None:
        """What a typedef names, if it can be a message of its own: a struct once more, or a vector or array as one."""
        if name in self.types or _refused_within(seen):
            return
        span = self.places.span(place)
        match self.type(name, name, seen, span):
            case Ref(target):
                struct = self.types.get(target)
                if isinstance(struct, Struct):
                    self.declare(name, Struct(name, struct.fields, _doc(doc), span, options=struct.options), place)
            case Array() | Bytes() as type_:
                self.declare(name, wrapped(name, type_, span, self.enums), place)
            case _:
                pass

    # --- what is left ------------------------------------------------------------------------------------------------

    def raise_problems(self) -> None:
        """Everything in the header counts, and of included files what it refers to."""
        needed = reached(self.main, self.types)
        found = dict.fromkeys(each for name, problems in self.problems.items() if name in needed for each in problems)
        if found:
            raise SchemaError(tuple(found)[:MAX_PROBLEMS])

    def drop_unusable(self) -> None:
        """Types of included files that are no data, or refer to such."""
        for name in dependents((name for name, problems in self.problems.items() if problems), self.types):
            self.types.pop(name, None)


def declared(answer: dict[str, Any], places: Places) -> Schema:
    """The schema of what `compiler.declarations` answers; raises SchemaError with what is no plain data, up to `MAX_PROBLEMS`."""
    judging = Judging(places, known=frozenset(item["name"] for item in (*answer["enums"], *answer["records"])))
    for item in answer["enums"]:
        judging.enum(item)
    for item in answer["records"]:
        judging.record(item)
    _pin(answer["records"], judging)
    for name, seen, place, doc in answer["aliases"]:
        judging.alias(name, seen, place, doc)
    judging.raise_problems()
    judging.drop_unusable()
    problems = nesting_problems(judging.types)
    if problems:
        raise SchemaError(tuple(problems[:MAX_PROBLEMS]))
    types = with_messages(judging.types, judging.enums, places.span([MAIN, 0, 1]))
    return Schema(MappingProxyType(types), tuple(source.name for source in places.texts.sources.values()), judging.constants)


def _pin(records: list[Any], judging: Judging) -> None:
    """The structs with what the compiler says of their layout."""
    layouts = Layouts(judging.types, {item["name"]: Extent(item["size"], item["alignment"]) for item in records})
    for item in records:
        name, struct = item["name"], judging.types[item["name"]]
        if judging.problems.get(name) or not isinstance(struct, Struct):
            continue
        if item["size"] > MAX_SIZE:
            judging.refuse(name, words.too_large(struct.span, name, MAX_SIZE))
            continue
        offsets = [member["offset"] for member in item["members"]]
        exact = pinned(struct, offsets, item["size"], item["alignment"], layouts)
        strange = struct if None in offsets else unaccounted(exact, layouts)
        if strange is not None:
            judging.refuse(name, words.strange_layout(strange.span, strange.name))
        judging.types[name] = exact


def _integer(bits: int, signed: bool, word: str) -> Int:
    match bits:
        case 8 | 16 | 32 | 64:
            return Int(bits, signed, word)
        case _:
            raise AssertionError(bits)


def _refused_within(seen: list[Any]) -> bool:
    while seen[0] in {"vector", "array"}:
        seen = seen[1]
    return seen[0] == "no"


def _doc(comment: str) -> str:
    """The text of a documentation comment."""
    lines = (_MARKS.sub("", line).strip() for line in comment.removesuffix("*/").splitlines())
    return "\n".join(lines).strip()
