"""Holders to objects: an object is filled, or made of a class, by a function that is written for it.

Arrays become what was there: a list, a tuple, an array of numpy's or of Python's; in a new object what its class says, else lists. All
values are the object's own: nothing shows the holder's memory. What is absent becomes None.
"""

from __future__ import annotations

import array
from collections.abc import Callable, Iterator, Mapping
from enum import Enum as Enumeration
from typing import Any, assert_never, cast

import numpy as np

from rosetta_jit.errors import ValuesError
from rosetta_jit.model.types import Enum
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.objects import shapes, unions
from rosetta_jit.runtime.holder.objects.source import ByClass, Source, assignment, attribute
from rosetta_jit.runtime.holder.record import Blob, Child, Choice, Entry, Items, Node, Numbers, Pairs, Record, Scalar, Text

INLINED = 3
"""How deep messages lie in others that one function fills."""

Types = Mapping[str, type]
"""Classes by the names of their structs."""


class Givers:
    """What hands on the holders of a family as objects.

    Parameters
    ----------
    types : mapping of str to type
        The classes of messages within messages, by the names of their structs, where neither an object nor its class tells them.
    """

    def __init__(self, family: HolderFamily, types: Types | None = None) -> None:
        self._family = family
        self._types = types or {}
        self._fillers: dict[int, ByClass] = {}
        self._makers: dict[int, ByClass] = {}

    def fill(self, value: object, holder: Any) -> None:
        """Give an object the values of a holder; raises ValuesError if it lacks an attribute, or no class is known for a message in it."""
        whole = self._family.wholes[type(value)]
        if whole is not None:
            whole.fill(value, holder)
            return
        if not shapes.is_message_like(value) or isinstance(value, Mapping):
            raise TypeError(f"a holder or an object of a message's class is needed, not {type(cast('object', value)).__name__}")
        self._filler(self._family.tree.root, "")[type(value)](value, holder)

    def make(self, object_type: type, holder: Any) -> Any:
        """A new object with the values of a holder. Raises as `fill`."""
        return self.maker(object_type)(holder)

    def maker(self, object_type: type) -> Callable[[Any], Any]:
        """What makes an object of a class, given a holder. Raises as `fill`, now or then."""
        whole = self._family.wholes[object_type]
        return self._maker(self._family.tree.root, "")[object_type] if whole is None else whole.make

    def _filler(self, record: Record, path: str) -> ByClass:
        return self._fillers.setdefault(id(record), ByClass(lambda each: self._written_filler(record, each, path)))

    def _maker(self, record: Record, path: str) -> ByClass:
        return self._makers.setdefault(id(record), ByClass(lambda each: self._written_maker(record, each, path)))

    def _written_filler(self, record: Record, object_type: type, path: str, like: object = None) -> Callable[[Any, Any], None]:
        """The function that fills objects of a class: one assignment a field.

        It fills messages within, as an object that is ``like`` those has them, by itself.
        """
        source = Source("fill")
        self._add_fields(source, record, object_type, path, like)
        return source.made("target, source")

    def _add_fields(self, source: Source, record: Record, object_type: type, path: str, like: object, depth: str = "") -> None:
        target = f"target{depth}"
        for entry, name in self._attributes(record, object_type, path):
            read = self._reads(record, entry.name, f"source{depth}")
            if entry.presence is None and isinstance(entry.node, Scalar | Text) and not isinstance(entry.node.type, Enum):
                source.add(assignment(target, name, read))
                continue
            convert = source.name_of(self._conversion(entry, object_type, name, path))
            source.add(f"old = getattr({target}, {name!r}, None)")
            if entry.presence is None and isinstance(entry.node, Record) and unions.discriminator_of(entry.node) is None:
                self._add_message(source, entry.node, f"{path}.{entry.name}", read, getattr(like, name, None), depth)
                source.add(f"else: {assignment(target, name, f'{convert}({read}, None)')}")
            elif (
                entry.presence is None
                and isinstance(entry.node, Numbers)
                and shapes.kind_in(shapes.annotation(object_type, name)) != "ndarray"
            ):
                kind, exact = source.name_of(type), source.name_of(list)
                source.add(assignment(target, name, f"{read}.tolist() if {kind}(old) is {exact} else {convert}({read}, old)"))
            else:
                source.add(assignment(target, name, self._if_there(source, entry, f"{convert}({read}, old)", f"source{depth}")))

    def _add_message(self, source: Source, record: Record, path: str, read: str, like: object, depth: str) -> None:
        """Lines that fill the message that was there, ``old``, if there was one."""
        fillers, kind = source.name_of(self._filler(record, path)), source.name_of(type)
        known: Any = type(like)
        if (
            len(depth) < INLINED
            and like is not None
            and shapes.has_messages(known)
            and self._family.of_struct(record.struct).family_.wholes[known] is None
        ):
            source.add(f"if {kind}(old) is {source.name_of(known)}:")
            with source.indented():
                source.add(f"target{depth}_, source{depth}_ = old, {read}")
                self._add_fields(source, record, known, path, like, f"{depth}_")
            source.add(f"elif old is not None: {fillers}[{kind}(old)](old, {read})")
        else:
            source.add(f"if old is not None: {fillers}[{kind}(old)](old, {read})")

    def _written_maker(self, record: Record, object_type: type, path: str) -> Callable[[Any], Any]:
        """The function that makes objects of a class: by its constructor if that is a dataclass's, else filling an empty one."""
        if not shapes.fields_of(object_type):
            filler = self._written_filler(record, object_type, path, object_type())

            def make(holder: Any) -> Any:
                made = object_type()
                filler(made, holder)
                return made

            return make
        source, arguments = Source("make"), list[str]()
        for entry, name in self._attributes(record, object_type, path):
            read, value = self._reads(record, entry.name), "{read}"
            if isinstance(entry.node, Record):
                value = f"{source.name_of(self._maker_of(entry.node, object_type, name, f'{path}.{entry.name}'))}({{read}})"
            elif not isinstance(entry.node, Scalar | Text) or isinstance(entry.node.type, Enum):
                value = f"{source.name_of(self._conversion(entry, object_type, name, path))}({{read}}, None)"
            arguments.append(f"{name!r}: {self._if_there(source, entry, value.format(read=read))}")
        source.add(f"return {source.name_of(object_type)}(**{{{', '.join(arguments)}}})")
        return source.made("source")

    def _attributes(self, record: Record, object_type: type, path: str) -> Iterator[tuple[Entry, str]]:
        """The fields of a record, and what a class calls their attributes."""
        for entry in record.entries.values():
            names = self._family.foreign.names(record, entry.name)
            if names:
                yield entry, _spelled(object_type, names, f"{path}.{entry.name}")

    def _if_there(self, source: Source, entry: Entry, value: str, of: str = "source") -> str:
        return value if entry.presence is None else f"{value} if {source.name_of(_has)}({of}, {entry.name!r}) else None"

    def _reads(self, record: Record, name: str, of: str = "source") -> str:
        return attribute(of, name) if name in self._family.shown(record) else f"{of}.access_.getters[{name!r}]({of})"

    def _conversion(self, entry: Entry, owner: type, name: str, path: str) -> Callable[[Any, Any], Any]:
        """What makes a value for an attribute, given the holder's and the one that is there."""
        return self._value(entry.node, owner, shapes.annotation(owner, name), f"{path}.{entry.name}")

    def _value(self, node: Node, owner: type, said: Any, path: str) -> Callable[[Any, Any], Any]:
        match node:
            case Scalar():
                return _enumerator(shapes.class_in(said, owner)) if isinstance(node.type, Enum) else _same
            case Text():
                return _same
            case Blob():
                return _OCTETS[shapes.kind_in(said)]
            case Numbers():
                return _copied if shapes.kind_in(said) == "ndarray" else _like_numbers
            case Items() if node.shape:
                return _copied if shapes.kind_in(said) == "ndarray" else _like_numbers
            case Record():
                return self._message(node, owner, said, path)
            case Child(record=record):
                return self._message(record, owner, said, path)
            case Items(element=element):
                return self._list(element, owner, said, path)
            case Pairs(value=entry):
                each = self._value(entry.node, owner, said, f"{path}[]")
                return lambda shown, _: {key: each(shown[key], None) for key in shown}
            case _:
                assert_never(node)

    def _list(self, element: Node, owner: type, said: Any, path: str) -> Callable[[Any, Any], Any]:
        each = self._value(element, owner, said, f"{path}[]")
        if isinstance(element, Text):
            return lambda shown, old: tuple(shown) if isinstance(old, tuple) else list(shown)

        def convert(shown: Any, old: Any) -> Any:
            others: list[Any] = cast("list[Any]", old) if isinstance(old, list) else []
            made = [each(one, others[index] if index < len(others) else None) for index, one in enumerate(shown)]
            return tuple(made) if isinstance(old, tuple) else made

        return convert

    def _message(self, record: Record, owner: type, said: Any, path: str) -> Callable[[Any, Any], Any]:
        union = unions.discriminator_of(record)
        if union is not None:
            return self._union(record, *union, owner, said, path)
        fillers, makers, found = self._filler(record, path), self._maker(record, path), self._class_of(record, owner, said)

        def convert(shown: Any, old: Any) -> Any:
            if old is not None:
                fillers[type(old)](old, shown)
                return old
            if found is None:
                raise ValuesError(path, f"no class is known for {record.struct}: name it in `types`")
            return makers[found](shown)

        return convert

    def _union(self, record: Record, entry: Entry, choice: Choice, owner: type, said: Any, path: str) -> Callable[[Any, Any], Any]:
        """What makes a union. Objects of it are made anew: not all can be given another case."""
        known = self._class_of(record, owner, said)

        def convert(shown: Any, old: Any) -> Any:
            found = cast("Any", type(old) if old is not None else known)
            if found is None:
                raise ValuesError(path, f"no class is known for {record.struct}: name it in `types`")
            getters, selector = shown.access_.getters, shown.access_.getters[entry.name](shown)
            case = unions.case_of(record, choice, selector)
            value = None
            if case is not None:
                value = self._value(case.node, found, shapes.annotation(found, case.name), f"{path}.{case.name}")(
                    getters[case.name](shown), None
                )
            return unions.made(found, selector, value)

        return convert

    def _maker_of(self, record: Record, owner: type, name: str, path: str) -> Callable[[Any], Any]:
        """What makes the message in an attribute; it cannot contain messages of the class that it is in."""
        union = unions.discriminator_of(record)
        if union is not None:
            convert = self._union(record, *union, owner, shapes.annotation(owner, name), path)
            return lambda shown: convert(shown, None)
        found = self._class_of(record, owner, shapes.annotation(owner, name), name)
        if found is None:
            raise ValuesError(path, f"no class is known for {record.struct}: name it in `types`")
        return self._maker(record, path)[found]

    def _class_of(self, record: Record, owner: type, said: Any, name: str = "") -> type | None:
        found = shapes.class_named(self._types, record.struct) or shapes.class_in(said, owner) or shapes.made_by_default(owner, name)
        return found or self._family.foreign.class_of(owner, record.struct)


def _spelled(object_type: type, names: tuple[str, ...], path: str) -> str:
    """What a class calls an attribute; raises ValuesError if it has none: a value would be lost."""
    own = shapes.declared(object_type)
    known = next((name for name in names if name in own or hasattr(object_type, name)), None)
    if known is None and not (shapes.has_dict(object_type) and not shapes.fields_of(object_type)):
        raise ValuesError(path, f"{object_type.__name__} has no attribute {' or '.join(map(repr, names))}")
    return known or names[0]


def _has(holder: Any, name: str) -> bool:
    from rosetta_jit.runtime.holder.classes import Holder

    return Holder.has(holder, name)


def _same(value: Any, _: Any) -> Any:
    return value


def _enumerator(found: type | None) -> Callable[[Any, Any], Any]:
    """The member of an enum, where one is there or its class is known; else the number."""

    def convert(value: Any, old: Any) -> Any:
        kind = type(old) if isinstance(old, Enumeration) else found
        return value if kind is None or not issubclass(kind, Enumeration) else kind(value)

    return convert


def _like_numbers(value: Any, old: Any) -> Any:
    match old:
        case np.ndarray():
            return _copied(value, old)
        case tuple():
            return tuple(value.tolist())
        case array.array():
            return array.array(old.typecode, value.tolist())
        case _:
            return value.tolist()


def _copied(value: Any, _: Any) -> Any:
    return value.copy() if type(value) is np.ndarray else np.array(value)


def _like_octets(value: bytes, old: Any) -> Any:
    match old:
        case list() | tuple() | bytearray():
            return type(cast("list[Any]", old))(value)
        case array.array():
            return array.array(old.typecode, value)
        case np.ndarray():
            return _as_octets(value, old)
        case _:
            return value


def _listed_octets(value: bytes, old: Any) -> Any:
    return list(value) if old is None else _like_octets(value, old)


def _as_octets(value: bytes, _: Any) -> Any:
    return np.frombuffer(value, np.uint8).copy()


_OCTETS = {"ndarray": _as_octets, "list": _listed_octets, "": _like_octets}
"""What bytes become, by what the class says of the attribute."""
