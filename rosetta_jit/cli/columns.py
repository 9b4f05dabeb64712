"""Many messages as columns of a numpy archive.

A field is one array with a row a message. Where the rows differ in length, their elements stand end to end, and ``NAME.offsets`` (n + 1
indices) says where each row begins. Fields of nested types have dotted names; lists of nested types are kept as JSON text.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from rosetta_jit.cli.values import dump
from rosetta_jit.file_errors import named

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import Holder

    Array = np.ndarray[tuple[int, ...], np.dtype[np.generic]]


def write_columns(holders: Iterable[Holder], path: Path) -> None:
    """Write one `.npz`; rows are copied, because a decoder fills the same holder again and again."""
    rows = [dict(_row(holder)) for holder in holders]
    names = dict.fromkeys(name for row in rows for name in row)
    columns: dict[str, Array] = {}
    for name in names:
        columns |= _column(name, [row[name] for row in rows if name in row])
        if any(name not in row for row in rows):
            columns[f"{name}.present"] = np.array([name in row for row in rows])
    with named(path), path.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **columns)


def _row(holder: Holder) -> Iterator[tuple[str, Array]]:
    for name, value in holder.to_dict().items():
        native = cast("object", getattr(holder, name, None))
        if isinstance(native, np.ndarray):  # knows its type better than a list of Python numbers does
            yield name, cast("Array", native).view(np.ndarray).copy()
        else:
            yield from _flat(name, value)


def _flat(name: str, value: object) -> Iterator[tuple[str, Array]]:
    match value:
        case dict():
            for key, item in cast("Mapping[str, object]", value).items():
                yield from _flat(f"{name}.{key}", item)
        case bytes():
            yield name, np.frombuffer(value, np.uint8).copy()
        case list() if any(isinstance(item, dict | list | bytes) for item in cast("list[object]", value)):
            yield name, np.asarray(dump({name: value}))
        case _:
            yield name, np.asarray(value)


def _column(name: str, rows: list[Array]) -> dict[str, Array]:
    if len({row.shape for row in rows}) == 1:
        return {name: np.stack(rows)}
    offsets = np.cumsum([0, *(len(row) for row in rows)], dtype=np.int64)
    return {name: np.concatenate(rows), f"{name}.offsets": offsets}
