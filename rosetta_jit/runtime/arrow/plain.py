"""Arrow arrays of every form as the few forms that `back` reads: encodings are decoded, views become offsets, extensions their storage.

    dictionary        decoded, unless it is of texts            string_view, binary_view         large_string, large_binary
    run_end_encoded   decoded                                   list_view, large_list_view       large_list
    extension         its storage (uuid, json, tensors)     map                              list of structs, where it holds any of these

Arrays of other types, in which no such array lies, are given back as they are.
"""

from __future__ import annotations

import pyarrow as pa
from pyarrow import compute, types


def plain(array: pa.Array) -> pa.Array:
    """The array in a form that `back` reads, with the same elements."""
    if _is_plain(array.type):
        return array
    if isinstance(array, pa.ExtensionArray):
        return plain(array.storage)
    if types.is_run_end_encoded(array.type):
        return plain(compute.run_end_decode(array))
    if isinstance(array, pa.DictionaryArray):
        return _dictionary(array)
    if isinstance(array, pa.StructArray):
        fields = [array.type.field(number) for number in range(array.type.num_fields)]
        children = [plain(array.field(number)) for number in range(len(fields))]
        named = [pa.field(each.name, child.type) for each, child in zip(fields, children, strict=True)]
        return pa.StructArray.from_arrays(children, fields=named, mask=_nulls(array))
    return _listed(pairs(array) if types.is_map(array.type) else array)


def pairs(array: pa.Array) -> pa.Array:
    """Maps as lists of structs of a key and a value."""
    key, item = array.type.key_field, array.type.item_field
    return array.cast(pa.list_(pa.struct([key.with_name("key"), item.with_name("value")])))


def is_text(type_: pa.DataType) -> bool:
    """Whether values of a type are texts."""
    return types.is_string(type_) or types.is_large_string(type_) or types.is_string_view(type_)


def _is_plain(type_: pa.DataType) -> bool:
    if types.is_dictionary(type_):
        return is_text(type_.value_type) and not types.is_string_view(type_.value_type)
    if any(is_of(type_) for is_of in _OTHERS) or isinstance(type_, pa.BaseExtensionType):
        return False
    return all(_is_plain(type_.field(number).type) for number in range(type_.num_fields))


_OTHERS = types.is_run_end_encoded, types.is_string_view, types.is_binary_view, types.is_list_view, types.is_large_list_view


def _nulls(array: pa.Array) -> pa.Array | None:
    return array.is_null() if array.null_count else None


def _dictionary(array: pa.DictionaryArray) -> pa.Array:
    values = plain(array.dictionary)
    return pa.DictionaryArray.from_arrays(array.indices, values) if is_text(values.type) else values.take(array.indices)


def _listed(array: pa.Array) -> pa.Array:
    """Arrays of views, and lists of whatever is not plain."""
    type_ = array.type
    if types.is_string_view(type_):
        return array.cast(pa.large_string())
    if types.is_binary_view(type_):
        return array.cast(pa.large_binary())
    if isinstance(array, pa.FixedSizeListArray):
        begin, size = array.offset * type_.list_size, len(array) * type_.list_size
        return pa.FixedSizeListArray.from_arrays(plain(array.values.slice(begin, size)), type_.list_size, mask=_nulls(array))
    counts = compute.fill_null(array.value_lengths().cast(pa.int64()), 0)
    ends = pa.concat_arrays([pa.array([0], pa.int64()), compute.cumulative_sum(counts)])
    return pa.LargeListArray.from_arrays(ends, plain(array.flatten()), mask=_nulls(array))
