"""A table with the fields of another type: renamed, put in order, and some left out; values stay as they are."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

import pyarrow as pa

from rosetta_jit.errors import ValuesError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection


def renamed(table: pa.Table, schema: pa.Schema, origin: Callable[[str, Collection[str]], str | None], dropped: Collection[str]) -> pa.Table:
    """The same values under the names of another schema.

    Parameters
    ----------
    origin
        Which of the names that there are has a field of the schema; None for none.
    dropped
        Names that the schema need not have.

    Raises
    ------
    ValuesError
        A field has no successor, or none that it comes from; its path says which.
    """
    found, there = dict[str, Any](), list(table.schema.names)
    taken = _pairs([each.name for each in schema], there, origin, dropped, "")
    for field in schema:
        column: Any = table.column(taken[field.name]).combine_chunks()
        column = column.combine_chunks() if hasattr(column, "combine_chunks") else column
        found[field.name] = _array(column, field.type, origin, dropped, f".{field.name}")
    return cast("Any", pa).table(found)


def _pairs(
    wanted: list[str], there: list[str], origin: Callable[[str, Collection[str]], str | None], dropped: Collection[str], path: str
) -> dict[str, str]:
    """Which of the names that are there each wanted one comes from."""
    found = {name: origin(name, there) for name in wanted}
    for name, source in found.items():
        if source is None:
            raise ValuesError(f"{path}.{name}", "nothing of the message is called so")
    left = set(there) - set(found.values()) - set(dropped)
    if left:
        raise ValuesError(f"{path}.{min(left)}", "the other type has no such field")
    return cast("dict[str, str]", found)


def _array(array: Any, type_: Any, origin: Callable[[str, Collection[str]], str | None], dropped: Collection[str], path: str) -> Any:
    types = import_module("pyarrow.types")
    if types.is_struct(type_) and types.is_struct(array.type):
        there = [array.type.field(place).name for place in range(array.type.num_fields)]
        wanted = [type_.field(place).name for place in range(type_.num_fields)]
        taken = _pairs(wanted, there, origin, dropped, path)
        parts = dict(zip(there, array.flatten(), strict=True))
        inner = [_array(parts[taken[name]], type_.field(name).type, origin, dropped, f"{path}.{name}") for name in wanted]
        return cast("Any", pa.Array).from_buffers(
            pa.struct([pa.field(name, each.type, False) for name, each in zip(wanted, inner, strict=True)]),
            len(array),
            [None],
            children=inner,
        )
    if types.is_large_list(array.type) and types.is_large_list(type_):
        inner = _array(array.flatten(), type_.value_type, origin, dropped, f"{path}[]")
        begins = array.offsets
        offsets = begins if not len(begins) or begins[0].as_py() == 0 else import_module("pyarrow.compute").subtract(begins, begins[0])
        return cast("Any", pa).LargeListArray.from_arrays(offsets, inner)
    if types.is_fixed_size_list(array.type) and types.is_fixed_size_list(type_):
        inner = _array(array.flatten(), type_.value_type, origin, dropped, f"{path}[]")
        return cast("Any", pa).FixedSizeListArray.from_arrays(inner, array.type.list_size)
    return array
