"""Random types of messages, as a tree that each framework's IDL can declare, and random values of them.

Kind = Scalar | Array | Enum | Message | Maybe | Choice | Map
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np

from tests.random_mappings.fields import some_value
from tests.random_mappings.meaning import Refused

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator, Mapping

    from tests.random_mappings.meaning import Value

CONSTANTS = ("AUTO", "IDLE", "MOVE")
"""The names of an enum, by their numbers."""


@dataclass(frozen=True)
class Scalar:
    type: str


@dataclass(frozen=True)
class Array:
    """Of scalars or messages; ``size`` is None where it is not fixed."""

    element: Scalar | Message
    size: int | None = None


@dataclass(frozen=True)
class Enum:
    pass


@dataclass(frozen=True)
class Message:
    name: str
    fields: Mapping[str, Kind]


@dataclass(frozen=True)
class Maybe:
    """What may be absent."""

    kind: Scalar | Message


@dataclass(frozen=True)
class Choice:
    """One of several fields, or none; ``is_named`` where the union is a field with a name of its own."""

    name: str
    cases: Mapping[str, Scalar]
    is_named: bool


@dataclass(frozen=True)
class Map:
    """Values beside keys, of scalar types."""

    key: str
    value: str


Kind = Scalar | Array | Enum | Message | Maybe | Choice | Map

OCTETS = Array(Scalar("uint8"))
"""What all frameworks take for bytes."""


@dataclass
class Types:
    """Makes types of what a framework knows."""

    rng: random.Random
    scalars: tuple[str, ...]
    has_optional: bool
    has_unions: bool
    has_named_unions: bool

    def message(self, name: str, leaves: Mapping[str, str], more: Mapping[str, Kind]) -> Message:
        """These leaves, some of them within messages or unions, or optional, and more fields, in some order."""
        fields: dict[str, Kind] = dict(more)
        names = self.rng.sample(list(leaves), len(leaves))
        while names:
            taken = [names.pop() for _ in range(min(len(names), self.rng.choice([1, 1, 1, 2, 3])))]
            group = {each: Scalar(leaves[each]) for each in taken}
            fields.update(self.held(f"{name}{len(fields)}", group))
        return Message(name, {each: fields[each] for each in self.rng.sample(list(fields), len(fields))})

    def held(self, name: str, group: Mapping[str, Scalar]) -> dict[str, Kind]:
        choice = self.rng.random()
        place = name.lower()
        if self.has_unions and len(group) > 1 and choice < 0.5:
            return {place: Choice(f"{name}Un", group, self.has_named_unions)}
        if choice < 0.7 and len(group) > 1:
            inner = Message(f"{name}In", group)
            return {place: Maybe(inner) if self.has_optional and choice > 0.6 else inner}
        return {each: Maybe(kind) if self.has_optional and self.rng.random() < 0.25 else kind for each, kind in group.items()}


# --- values --------------------------------------------------------------------------------------------------------------


def some(rng: random.Random, kind: Kind, count: int = 0) -> Value:
    """A value of a type, as `from_dict` takes it; None is what is absent, and arrays have ``count`` elements."""
    match kind:
        case Scalar(type_):
            return some_value(rng, type_)
        case Array() if kind == OCTETS:
            return rng.randbytes(rng.choice([0, 1, count, 40]))
        case Array(element, size):
            return [some(rng, element) for _ in range(count if size is None else size)]
        case Enum():
            return rng.choice(CONSTANTS)
        case Message(_, fields):
            return held({name: some(rng, each, count) for name, each in fields.items()}, fields)
        case Maybe(inner):
            return some(rng, inner) if rng.random() < 0.6 else None
        case Choice(_, cases, _):
            name = rng.choice(list(cases))
            return {name: some(rng, cases[name])} if rng.random() < 0.85 else {}
        case Map(key, value):
            return {some_value(rng, key): some_value(rng, value) for _ in range(count)}
        case _:
            assert_never(kind)


def held(values: Mapping[str, Value], fields: Mapping[str, Kind]) -> dict[str, Any]:
    """The fields of a message as `from_dict` takes them: without what is absent, and the cases of unnamed unions among them."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        kind = fields[name]
        if isinstance(kind, Choice) and not kind.is_named:
            found.update(value)
        elif value is not None:
            found[name] = value
    return found


def leaves(kind: Kind, path: str = "") -> Iterator[tuple[str, str]]:
    """The paths of all scalars that stand in no array, without the first dot, and their types."""
    match kind:
        case Scalar(type_):
            yield path, type_
        case Message(_, fields):
            for name, each in fields.items():
                yield from leaves(each, below(path, name, each))
        case Choice(_, cases, _):
            yield from ((joint(path, name), each.type) for name, each in cases.items())
        case Maybe(inner):
            yield from leaves(inner, path)
        case Array() | Enum() | Map():
            pass
        case _:
            assert_never(kind)


def presences(kind: Kind, path: str = "") -> Iterator[str]:
    """The paths of which `has` can be asked."""
    match kind:
        case Message(_, fields):
            for name, each in fields.items():
                yield from presences(each, below(path, name, each))
        case Choice(_, cases, _):
            yield from (joint(path, name) for name in cases)
        case Maybe(inner):
            yield path
            yield from presences(inner, path)
        case Scalar() | Array() | Enum() | Map():
            pass
        case _:
            assert_never(kind)


def below(path: str, name: str, kind: Kind) -> str:
    if isinstance(kind, Choice) and not kind.is_named:
        return path
    return joint(path, name)


def joint(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


class Seen(dict[str, Any]):
    """What expressions read of a value, by path; "has a.b" tells whether something is there."""

    def __getitem__(self, path: str) -> Value:
        value = super().__getitem__(path)
        if value is LACKING:
            raise Refused("missing")
        return value


LACKING = object()
"""Stands for what a message requires and does not have."""


def seen(kind: Kind, value: Value, path: str = "", *, requires: bool = False) -> Seen:
    """What is absent gives its default, or is refused if it is a scalar of a message that requires it."""
    match kind:
        case Scalar(type_):
            return Seen({path: (LACKING if requires else default(type_)) if value is None else value})
        case Array() | Enum() | Map():
            return Seen({path: value})
        case Maybe(inner):
            found = seen(inner, value, path, requires=requires and isinstance(inner, Message))
            found[f"has {path}"] = value is not None
            return found
        case Message(_, fields):
            found = Seen()
            for name, each in fields.items():
                part = value or {}
                is_open = isinstance(each, Choice) and not each.is_named
                found |= seen(each, part if is_open else part.get(name), below(path, name, each), requires=requires)
            return found
        case Choice(_, cases, _):
            found = Seen()
            for name, each in cases.items():
                at = joint(path, name)
                found[f"has {at}"] = name in (value or {})
                found |= seen(each, (value or {}).get(name), at, requires=requires and isinstance(each, Message))
            return found
        case _:
            assert_never(kind)


def default(type_: str) -> Value:
    match type_:
        case "string":
            return ""
        case "bool":
            return False
        case "float32" | "float64":
            return np.float32(0) if type_ == "float32" else np.float64(0)
        case _:
            return 0
