"""Fields by their names: with dots those of nested messages, of the elements of arrays, and of the values of maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from rosetta_jit.runtime.holder.record import Blob, Child, Entry, Items, Node, Numbers, Pairs, Record, Scalar, Text


def entry_of(record: Record, name: str) -> Entry:
    """The field of one name.

    Raises
    ------
    KeyError
        If there is none; it says which one may have been meant.
    """
    entry = record.entries.get(name)
    if entry is None:
        raise KeyError(_unknown(record, name))
    return entry


def entries_to(record: Record, path: str, *, through_arrays: bool = True) -> Sequence[Entry]:
    """The fields on the way to one, itself the last.

    Raises
    ------
    KeyError
        If there is no such field; or if it lies in an array or a map, and is to be one of a message.
    TypeError
        If it is no name.
    """
    if not isinstance(path, str):  # pyright: ignore[reportUnnecessaryIsInstance] - what users give
        raise TypeError(f"a field is named by a str, not by {path!r}; several are a table: `batch.to_pandas([…])`")
    found: list[Entry] = []
    for name in path.split("."):
        if found:
            record = _inside(found[-1], through_arrays=through_arrays)
        found.append(entry_of(record, name))
    return found


def _inside(entry: Entry, *, through_arrays: bool) -> Record:
    node: Node = entry.node
    if not through_arrays and isinstance(node, Items | Pairs):
        raise KeyError(f"`{entry.name}` has many elements, and no one field of them")
    while isinstance(node, Items | Pairs):
        node = node.element if isinstance(node, Items) else node.value.node
    match node:
        case Record():
            return node
        case Child():
            return node.record
        case Scalar() | Text() | Blob() | Numbers():
            raise KeyError(f"`{entry.name}` is no message, and has no fields")
        case _:
            assert_never(node)


def no_such_field(record: Record, name: str) -> str:
    """What is said of a name that no field has."""
    near = _meant(record, name)
    return f"{record.struct or 'the record'} has no such field{f'; did you mean `{near}`?' if near else ''}"


def _unknown(record: Record, name: str) -> str:
    near = _meant(record, name)
    return f"{record.struct or 'the record'} has no field `{name}`{f'; did you mean `{near}`?' if near else ''}"


def _meant(record: Record, name: str) -> str | None:
    from rosetta_jit.catalogue.suggestions import closest

    return closest(str(name), record.entries)  # the key of a dict may be anything
