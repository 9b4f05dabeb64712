"""One column of a batch as an array of Arrow's: what `Columns` and `Ragged` give to those who ask for it, `pl.Series(batch.header)`.

path = field of the message or of one within it, and, where that is an array, of its elements: `header.stamp`, `poses.position.x`
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from pyarrow import types

from rosetta_jit.runtime.arrow.arrays import Form
from rosetta_jit.runtime.arrow.tables import record_batch
from rosetta_jit.runtime.holder.record import Node, Record
from rosetta_jit.runtime.lanes import Lanes

if TYPE_CHECKING:
    from numpy.typing import NDArray


def column_array(root: Record, lanes: Lanes, count: int, path: str) -> pa.Array:
    """The array of a column of so many messages, of the types of `Batch.to_arrow`; null where a message lacks the field."""
    node: Node = root
    names, depth = path.split("."), 0
    while isinstance(node, Record) and depth < len(names):
        node, depth = node.entries[names[depth]].node, depth + 1
    whole: Any = record_batch(root, lanes, count, [".".join(names[:depth])], Form())
    return _within(whole.column(0), names[depth:])[0]


def texts(values: list[Any], kind: str) -> pa.Array:
    """An array of texts, or of bytes."""
    return pa.array(values, pa.large_string() if kind == "text" else pa.large_binary())


def numbers(values: NDArray[Any]) -> pa.Array:
    """An array of numbers, one a row."""
    return pa.array(np.ascontiguousarray(values))


def lists(offsets: NDArray[np.int64], elements: pa.Array) -> pa.Array:
    """An array of lists, of which each begins at an offset."""
    return pa.LargeListArray.from_arrays(pa.array(offsets), elements)


def maps(offsets: NDArray[np.int64], pairs: pa.StructArray) -> pa.Array:
    """An array of maps."""
    return pa.MapArray.from_arrays(pa.array(offsets, pa.int32()), pairs.field("key"), pairs.field("value"))


def structs(fields: Mapping[str, pa.Array]) -> pa.StructArray:
    """An array of structs."""
    return pa.StructArray.from_arrays([*fields.values()], [*fields])


def table_of_structs(array: pa.Array) -> pa.Table:
    """The fields of structs as a table."""
    return pa.Table.from_arrays(array.flatten(), [array.type.field(index).name for index in range(array.type.num_fields)])


def _within(array: Any, names: Sequence[str]) -> tuple[pa.Array, bool]:
    """A field of structs, or of those in arrays and maps, in arrays and maps of as many; and whether it can be null."""
    if not names:
        return array, False
    if types.is_struct(array.type):
        number = array.type.get_field_index(names[0])
        found, can_be = _within(array.flatten()[number], names[1:])
        return found, can_be or array.type.field(number).nullable
    if types.is_map(array.type):
        values, can_be = _within(array.items, names)
        type_ = pa.map_(array.keys.type, pa.field("value", values.type, can_be))
        pairs = pa.StructArray.from_arrays([array.keys, values], fields=[type_.key_field, type_.item_field])
        return pa.Array.from_buffers(type_, len(array), array.buffers()[:2], children=[pairs]), False
    elements, can_be = _within(array.values, names)
    item = pa.field("item", elements.type, can_be)
    is_fixed = types.is_fixed_size_list(array.type)
    type_ = pa.list_(item, array.type.list_size) if is_fixed else pa.large_list(item)
    return pa.Array.from_buffers(type_, len(array), array.buffers()[: 1 if is_fixed else 2], children=[elements]), False
