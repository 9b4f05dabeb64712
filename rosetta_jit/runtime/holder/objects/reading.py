"""An object as plain values, by the names of its attributes: what taking one means. `taking` does the same quickly, or leaves it to this.

Every field of the type must be there as an attribute, and every public attribute must be a field. None is a value that is absent. A mapping
is as in `Holder.from_dict`: what it does not name stays as in a new message.
"""

from __future__ import annotations

import array
from collections.abc import Iterable, Mapping
from enum import Enum as Enumeration
from typing import Any, assert_never, cast

import numpy as np

from rosetta_jit.errors import ValuesError
from rosetta_jit.model.types import Enum, Struct
from rosetta_jit.runtime.holder.access import raw
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.objects import shapes, unions
from rosetta_jit.runtime.holder.record import Blob, Child, Choice, Entry, Items, Node, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.limits import MAX_DEPTH

_MISSING = object()


def plain_record(record: Record, value: Any, family: HolderFamily, path: str = "", depth: int = 0) -> dict[str, Any]:
    """The fields of an object, or of a mapping, as `Holder.from_dict` takes them.

    Raises
    ------
    ValuesError
        If an attribute is missing, or is of no field; or if objects contain each other too deep.
    """
    if depth > MAX_DEPTH:
        raise ValuesError(path, f"messages contain each other more than {MAX_DEPTH} deep")
    if isinstance(value, Mapping):
        mapping = cast("Mapping[str, Any]", value)
        return {name: _of_mapping(record, name, each, family, path, depth) for name, each in mapping.items()}
    if not shapes.is_message_like(value):
        raise ValuesError(path, f"expected a message or a dict, {type(value).__name__} found")
    own = family.of_struct(record.struct).family_
    whole = own.wholes[type(value)]
    if whole is not None:
        holder = own.holder()
        whole.take(holder, value)
        return raw(holder)
    union = unions.discriminator_of(record)
    if union is not None:
        return _of_union(record, *union, value, family, path, depth)
    return _by_attributes(record, value, family, path, depth)


def _of_union(record: Record, entry: Entry, choice: Choice, value: object, family: HolderFamily, path: str, depth: int) -> dict[str, Any]:
    discriminator, inner = unions.parts_of(value, path)
    selector = number(discriminator)
    case = unions.case_of(record, choice, selector) if isinstance(selector, int) else None
    found = {entry.name: selector}
    if case is not None:
        found[case.name] = plain(case.node, inner, family, f"{path}.{case.name}", depth + 1)
    elif inner is not None:
        raise ValuesError(path, f"the discriminator {selector!r} selects no case, and there is a value")
    return found


def _by_attributes(record: Record, value: object, family: HolderFamily, path: str, depth: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    known = set(without_meaning(record, family))
    for entry in record.entries.values():
        names = family.foreign.names(record, entry.name)
        known.update(names)
        own = _attribute(value, names, entry, path)
        if own is not _MISSING:
            found[entry.name] = plain(entry.node, own, family, f"{path}.{entry.name}", depth + 1)
    unknown = sorted(shapes.attributes_of(value) - known)
    if unknown:
        raise ValuesError(f"{path}.{unknown[0]}", f"{record.struct} has no such field, and {type(value).__name__} such an attribute")
    return found


def without_meaning(record: Record, family: HolderFamily) -> frozenset[str]:
    """Attributes that an object may have though they are no fields: constants, and what is particular to its framework."""
    struct = family.struct if record.struct == family.struct.name else family.schema.types.get(record.struct)
    constants = struct.constants if isinstance(struct, Struct) else ()
    return family.foreign.besides.union(each.name for each in constants)


def _of_mapping(record: Record, name: str, value: Any, family: HolderFamily, path: str, depth: int) -> Any:
    entry = record.entries.get(name)
    return value if entry is None else plain(entry.node, value, family, f"{path}.{name}", depth + 1)


def _attribute(value: object, names: tuple[str, ...], entry: Entry, path: str) -> Any:
    """The value of a field; `_MISSING` where it is absent, or objects have no such attribute."""
    if not names:
        return _MISSING
    name = next((each for each in names if hasattr(value, each)), None)
    if name is None:
        raise ValuesError(f"{path}.{entry.name}", f"{type(value).__name__} has no attribute {' or '.join(map(repr, names))}")
    found = getattr(value, name)
    return _MISSING if found is None and entry.presence is not None else found


def plain(node: Node, value: Any, family: HolderFamily, path: str = "", depth: int = 0) -> Any:
    """A value of an attribute as `rosetta_jit.runtime.holder.values` takes it."""
    match node:
        case Scalar():
            return number(value) if isinstance(node.type, Enum) else value
        case Text():
            return value
        case Blob():
            return octets(value)
        case Numbers():
            return [number(each) for each in value] if isinstance(node.type, Enum) and _is_sequence(value) else numbers(value)
        case Record():
            return plain_record(node, value, family, path, depth)
        case Child(record=record):
            return plain_record(record, value, family, path, depth)
        case Items() if not _is_sequence(value) or isinstance(value, np.ndarray):
            return cast("object", value)
        case Items(element=element):
            return [plain(element, each, family, f"{path}[{index}]", depth + 1) for index, each in enumerate(value)]
        case Pairs(value=entry):
            if not isinstance(value, Mapping):
                return value
            pairs = cast("Mapping[Any, Any]", value)
            return {key: plain(entry.node, each, family, f"{path}[{key!r:.40}]", depth + 1) for key, each in pairs.items()}
        case _:
            assert_never(node)


def number(value: Any) -> Any:
    """The number of an enumerator, if it is an object that has it as its ``value``."""
    return value if isinstance(value, int | str) and not isinstance(value, Enumeration) else getattr(value, "value", value)


def octets(value: Any) -> Any:
    """Bytes, also of a list of numbers."""
    return bytes(cast("Any", value)) if isinstance(value, list | tuple | array.array) else value


def numbers(value: Any) -> Any:
    """An array of numbers that is quick to take: one of numpy's that is aligned. Of Python's own arrays, it shows the same memory."""
    if isinstance(value, np.ndarray):
        found = cast("Any", value)
        return found if found.flags.aligned else found.copy()
    if isinstance(value, array.array):
        return np.asarray(cast("Any", value)).view()
    return listed(value)


def listed(value: Any) -> Any:
    """A tuple as a list, which is quick to take."""
    return list(cast("tuple[Any, ...]", value)) if isinstance(value, tuple) else value


def _is_sequence(value: Any) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
