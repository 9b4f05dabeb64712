"""What the rules of a mapping can name: the two messages, constants, loop variables, state variables."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import assert_never

from rosetta_jit.catalogue import fields as words
from rosetta_jit.catalogue import layouts, suggestions
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.constants import Constants
from rosetta_jit.language.conversions import SMALL, describe
from rosetta_jit.language.typed import Const, Expr, FieldStep, IndexStep, Place, StateVariable, Step
from rosetta_jit.language.uses import Signature, UsableMappings
from rosetta_jit.model.expr import Each, Index, Keyed, Member, Path, Pick, Side, Slice
from rosetta_jit.model.expr import Expr as Untyped
from rosetta_jit.model.layout import map_entry
from rosetta_jit.model.mapping import OF_WIRES
from rosetta_jit.model.types import Array, Bytes, Enum, Field, Int, Map, Optional, Schema, Struct, Type, Union
from rosetta_jit.startup.dataclass import dataclass, field, replace


@dataclass(frozen=True, slots=True)
class Message:
    """One side of a mapping: its type, and the schema that its references are looked up in."""

    root: Struct
    schema: Schema

    def value_type(self, type_: Type) -> Type:
        """The type of a value that is there: without Optional, references resolved."""
        resolved = self.schema.resolve(type_)
        return self.value_type(resolved.value) if isinstance(resolved, Optional) else resolved


@dataclass(frozen=True, slots=True)
class Scope:
    """The names that are known at one point of a mapping; where problems go, and the declarations that were ``named``.

    Within a mapping that another one uses, a message is a part of that one's: ``bases`` are the places where its two messages lie, and
    ``suffix`` tells its loop variables from those around. ``values`` are the types of what else has a name:
    `model.expr.NEAREST`, and what the definitions of a function of several values name.
    ``rounds`` is whether the mapping says that float64 is rounded where float32 is set, ``is_old`` that it is one of 2012.
    ``state`` has the direction's state variables, ``counting`` the loop variables that are not larger than rounds can be.
    """

    messages: Mapping[Side, Message]
    enums: Mapping[str, Enum]
    constants: Constants
    target: Side
    locals: tuple[str, ...]
    problems: list[Diagnostic]
    named: set[str]
    functions: Mapping[str, Signature]
    usable: UsableMappings
    bases: Mapping[Side, Place] = field(default_factory=dict["Side", "Place"])
    suffix: str = ""
    values: Mapping[str, Type] = field(default_factory=dict["str", "Type"])
    rounds: bool = False
    state: Mapping[str, StateVariable] = field(default_factory=dict["str", "StateVariable"])
    is_old: bool = False
    counting: frozenset[str] = frozenset()

    def inside(self, variable: str, start: Expr | None = None) -> Scope:
        """Within a loop, which begins at ``start``."""
        counts = isinstance(start, Const) and abs(int(start.value)) <= SMALL
        counting = self.counting | {variable} if counts else self.counting - {variable}
        return replace(self, locals=(*self.locals, variable), counting=counting)

    @property
    def origin(self) -> Side:
        """The side that rules read."""
        return "wire" if self.target == "holder" else "holder"

    def base(self, side: Side) -> Place:
        """The message of a side."""
        return self.bases.get(side) or Place(side, (), self.messages[side].root)


def enums_of(*schemas: Schema) -> dict[str, Enum]:
    """All enums by qualified name."""
    return {name: found for schema in schemas for name, found in schema.types.items() if isinstance(found, Enum)}


@dataclass(frozen=True, slots=True)
class Broken:
    """A path that does not resolve: the fields that it may have meant, so that nothing more is said about them."""

    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Sought:
    """An element that is known by a key: the array whose elements have the keys, the message of each if they are, and which one it is."""

    array: Place
    element: Message | None
    step: Keyed


def resolve_path(path: Path, scope: Scope, index: Callable[[Untyped | Sought, Scope], Expr | None]) -> Place | Broken:
    """The place that a path names; ``index`` types the expressions within."""
    message, base = scope.messages[path.side], scope.base(path.side)
    type_: Type = message.root
    steps: list[Step] = [*base.steps]
    outer = Place(base.side, base.steps, message.root, path.span)  # the message that the last field is in
    for number, step in enumerate(path.steps):
        found: tuple[list[Step], Type] | Broken
        match step:
            case Member():
                outer = Place(base.side, tuple(steps), type_, path.span)
                found = _member(step, type_, message, scope, path.side, path.steps[number + 1 :])
            case Index():
                found = _element(step, type_, scope, index)
            case Keyed():
                found = _sought(step, Place(base.side, tuple(steps), type_, path.span), outer, scope, index)
            case Slice() | Pick() | Each():
                scope.problems.append(layouts.out_of_place(step.span))
                found = Broken(())
            case _:
                assert_never(step)
        if isinstance(found, Broken):
            return Broken(tuple(done.field.name for done in steps if isinstance(done, FieldStep)) + found.fields)
        steps += found[0]
        type_ = message.value_type(found[1])
    return Place(base.side, tuple(steps), type_, path.span)


def _member(
    step: Member, type_: Type, message: Message, scope: Scope, side: Side, behind: Sequence[object] = ()
) -> tuple[list[Step], Type] | Broken:
    if not isinstance(type_, Struct | Union):
        scope.problems.append(words.not_a_struct(step.span, step.name, describe(type_)))
        return Broken(())
    # Most names are a field's own; all that can be named is gathered for the others alone.
    own = next((field for field in (type_.fields if isinstance(type_, Struct) else type_.cases) if field.name == step.name), None)
    if own is not None:
        return [FieldStep(own)], own.type
    members = members_of(type_, message.schema)
    if step.name in members:
        fields = members[step.name]
        return [FieldStep(field) for field in fields], fields[-1].type
    scope.problems.append(_unknown(step, type_, members, scope, side, behind))
    near = suggestions.nearest(step.name, members.keys())
    return Broken(() if near is None else (near,))  # any field may be meant where none has a name like it


def _unknown(
    step: Member, type_: Struct | Union, members: Collection[str], scope: Scope, side: Side, behind: Sequence[object]
) -> Diagnostic:
    """Why there is no such field, and where there may be one."""
    message, other = scope.messages[side], scope.messages["wire" if side == "holder" else "holder"]
    is_root, wires = type_ == message.root, message.root.name.startswith(OF_WIRES)
    having = [wire.name for wire in message.root.fields if wires and step.name in members_of_value(wire.type, message)]
    if is_root and wires:
        return words.unknown_wire(step, members, having)
    elsewhere = words.in_wires(step.name, having) if having else ""
    if is_root and step.name in members_of(other.root, other.schema):
        elsewhere = words.other_side(f".{step.name}", side) if side != scope.target else words.read_side(f".{step.name}", side)
    elif is_root and behind and isinstance(behind[0], Member) and behind[0].name in members:
        elsewhere = words.in_message(behind[0].name)
    return words.unknown_field(step, side, type_.name, members, elsewhere)


def members_of_value(type_: Type, message: Message) -> Collection[str]:
    """What can be named in a value of a type: nothing of what is no message."""
    found = message.value_type(type_)
    return members_of(found, message.schema) if isinstance(found, Struct | Union) else ()


def members_of(type_: Struct | Union, schema: Schema) -> dict[str, tuple[Field, ...]]:
    """What can be named in a struct: its fields, and the cases of its unions as if they were fields."""
    fields = type_.fields if isinstance(type_, Struct) else type_.cases
    members: dict[str, tuple[Field, ...]] = {}
    for each in fields:
        union = schema.resolve(each.type)
        if isinstance(union, Union):
            members |= {case.name: (each, case) for case in union.cases}
    return members | {each.name: (each,) for each in fields}


def _element(step: Index, type_: Type, scope: Scope, typed: Callable[[Untyped, Scope], Expr | None]) -> tuple[list[Step], Type] | Broken:
    index = typed(step.index, scope)
    if not isinstance(type_, Array | Bytes | Map):
        scope.problems.append(words.not_indexable(step.span, describe(type_)))
        return Broken(())
    if index is None or not _in_range(index, type_, scope):
        return Broken(())
    return [IndexStep(index, step.span)], element_type(type_)


def _sought(
    step: Keyed, array: Place, outer: Place, scope: Scope, typed: Callable[[Untyped | Sought, Scope], Expr | None]
) -> tuple[list[Step], Type] | Broken:
    message = scope.messages[array.side]
    keys = _beside(step, outer, scope) if step.beside else array
    if isinstance(keys, Broken):
        return keys
    element: Type | None = None
    if isinstance(keys.type, Array | Map) or (step.beside and isinstance(keys.type, Bytes)):
        element = message.value_type(element_type(keys.type))
    if not (isinstance(element, Struct) or (step.beside and element is not None and not step.names)):
        scope.problems.append(words.no_keys(step.span, describe(keys.type)))
        return Broken(())
    if not isinstance(array.type, Array | Bytes | Map):
        scope.problems.append(words.not_indexable(step.span, describe(array.type)))
        return Broken(())
    index = typed(Sought(keys, Message(element, message.schema) if isinstance(element, Struct) else None, step), scope)
    return Broken(()) if index is None else ([IndexStep(index, step.span)], element_type(array.type))


def _beside(step: Keyed, outer: Place, scope: Scope) -> Place | Broken:
    """The array of the keys: from the message that holds the array of the elements."""
    message, steps, type_ = scope.messages[outer.side], [*outer.steps], outer.type
    for name in step.beside:
        found = _member(Member(name, step.span), type_, message, scope, outer.side)
        if isinstance(found, Broken):
            return found
        steps += found[0]
        type_ = message.value_type(found[1])
    return Place(outer.side, tuple(steps), type_, step.span)


def _in_range(index: Expr, type_: Array | Bytes | Map, scope: Scope) -> bool:
    length = type_.fixed if isinstance(type_, Array) else None
    if not isinstance(index, Const) or 0 <= int(index.value) < (2**63 if length is None else length):
        return True
    scope.problems.append(words.index_range(index.span, int(index.value), length))
    return False


def element_type(type_: Array | Bytes | Map) -> Type:
    """The type of one element; a byte is a uint8, an entry of a map has the fields ``key`` and ``value``."""
    match type_:
        case Array(element):
            return element
        case Bytes():
            return Int(8, signed=False)
        case Map(key, value):
            return map_entry(key, value)
