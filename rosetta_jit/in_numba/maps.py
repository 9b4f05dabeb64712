"""Maps in compiled code: ``table[key]``, ``key in table``, ``len(table)``, and iteration over keys, values or both.

A map lies in its lane as it came, pair by pair, and where a key came twice, the last pair counts. So a key is searched from the end; who
iterates, or asks for the length, gets each key once, where it first came, as in Python. Keys that came twice are found by sorting, so that
no message makes it slower than in proportion to ``n log n``.

Texts are arrays of their bytes here. The key to look for is a number, a text that is written down in the function, ``bytes``, or such an
array.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast, get_args

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.core.imputils import RefType, impl_ret_borrowed, impl_ret_new_ref, iternext_impl
from numba.extending import intrinsic, lower_builtin, overload, overload_method, register_jitable

from rosetta_jit.backends.llvm.values import I64, constant
from rosetta_jit.in_numba.reading import Reader
from rosetta_jit.in_numba.types import ROWS, MapIteratorType, MapType, Shown
from rosetta_jit.runtime.holder.coerce import UTF_16

if TYPE_CHECKING:
    from llvmlite import ir
    from numba.core.base import BaseContext
    from numba.core.imputils import IternextResult
    from numba.core.typing.templates import Signature
    from numba.extending import Codegen, Implementation


@intrinsic
def _count(typing: object, table: types.Type) -> Implementation:  # noqa: ARG001 - numba passes it
    """How many pairs there are."""

    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        return cgutils.create_struct_proxy(signature.args[0])(context, builder, value=arguments[0]).count

    return types.int64(table), codegen


@intrinsic
def _key(typing: object, table: types.Type, at: types.Type) -> Implementation:  # noqa: ARG001 - as above
    """The key of a pair."""
    return cast("MapType", table).part("keys")(table, types.int64), _reads("keys")


@intrinsic
def _value(typing: object, table: types.Type, at: types.Type) -> Implementation:  # noqa: ARG001 - as above
    """The value of a pair."""
    return cast("MapType", table).part("values")(table, types.int64), _reads("values")


def _reads(shown: Shown) -> Codegen:
    def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
        return _part(Reader(context, builder, cast("MapType", signature.args[0]), arguments[0]), arguments[1], shown)

    return codegen


def _part(reader: Reader, at: ir.Value, shown: Shown) -> ir.Value:
    """The key of a pair, its value, or both."""
    assert isinstance(reader.type, MapType)
    reader.check_valid()
    node, row = reader.type.node, reader.builder.add(reader.value.start, at)
    match shown:
        case "keys":
            return reader.node(node.key, row)
        case "values":
            return reader.entry(node.value, row)
        case "items":
            return reader.context.make_tuple(
                reader.builder, reader.type.part(shown), [reader.node(node.key, row), reader.entry(node.value, row)]
            )


def _order(one: Any, other: Any) -> int:
    """Negative, zero or positive: how two keys are ordered; `_order_of` has the code."""
    raise NotImplementedError


@overload(_order)
def _order_of(one: Any, other: Any) -> Callable[..., int]:  # noqa: ARG001  numba compares parameters
    def texts(one: Any, other: Any) -> int:
        for index in range(min(len(one), len(other))):
            if one[index] != other[index]:
                return -1 if one[index] < other[index] else 1
        return len(one) - len(other)

    def numbers(one: Any, other: Any) -> int:
        return -1 if one < other else int(one > other)

    return texts if isinstance(one, types.Array) else numbers


@register_jitable
def _sorted(table: Any) -> Any:
    """All pairs in the order of their keys, and those of one key in the order in which they came: merged from runs, without recursion."""
    count = _count(table)
    order, merged, width = np.arange(count), np.empty(count, np.int64), 1
    while width < count:
        for begin in range(0, count, 2 * width):
            middle, end = min(begin + width, count), min(begin + 2 * width, count)
            left, right = begin, middle
            for at in range(begin, end):
                if left < middle and (right == end or _order(_key(table, order[left]), _key(table, order[right])) <= 0):
                    merged[at] = order[left]
                    left += 1
                else:
                    merged[at] = order[right]
                    right += 1
        order, merged, width = merged, order, 2 * width
    return order


@register_jitable
def _pairs(table: Any) -> Any:
    """Of each key, in the order in which they first came, the pair that counts."""
    order, count = _sorted(table), _count(table)
    found, first = np.full(count, -1), 0
    for at in range(1, count + 1):
        if at == count or _order(_key(table, order[at - 1]), _key(table, order[at])) != 0:
            found[order[first]] = order[at - 1]
            first = at
    return found[found >= 0]


@register_jitable
def _find(table: Any, key: Any) -> int:
    """The pair of a key, -1 if there is none."""
    at = _count(table) - 1
    while at >= 0 and _order(_key(table, at), key) != 0:
        at -= 1
    return at


def _written_down(table: MapType, key: types.Type) -> Any:
    """A key that a function has as a literal, as the map has it; None where a value has to be looked at when the function runs.

    Raises
    ------
    TypingError
        No key of the map is of such a type.
    """
    own = table.part("keys")
    if isinstance(own, types.Array):
        if isinstance(key, types.StringLiteral):
            is_utf8 = own.dtype == types.uint8
            return np.frombuffer(key.literal_value.encode("utf-8" if is_utf8 else UTF_16), np.uint8 if is_utf8 else np.uint16)
        if isinstance(key, types.Buffer) and key.dtype == own.dtype and key.ndim == 1:
            return None
        raise TypingError(f"a key of this map is a text: written down here, bytes, or an array of {own.dtype}, and not {key}")
    if not isinstance(key, types.Boolean if own == types.boolean else types.Integer):
        raise TypingError(f"a key of this map is {own}, and not {key}")
    return None


# Numba compares the parameters of what says a type and of what it returns, annotations included.


@overload(len)
def _len(table: types.Type) -> Callable[..., object] | None:
    def length(table: types.Type) -> object:
        return len(_pairs(table))

    return length if isinstance(table, MapType) else None


@overload(operator.contains)
def _contains(table: types.Type, key: types.Type) -> Callable[..., object] | None:
    if not isinstance(table, MapType):
        return None
    known = _written_down(table, key)

    def contains_known(table: types.Type, key: types.Type) -> object:  # noqa: ARG001  as above
        return _find(table, known) >= 0

    def contains(table: types.Type, key: types.Type) -> object:
        return _find(table, key) >= 0

    return contains if known is None else contains_known


@overload(operator.getitem)
def _getitem(table: types.Type, key: types.Type) -> Callable[..., object] | None:
    if not (isinstance(table, MapType) and table.shown == "keys"):
        return None
    known = _written_down(table, key)

    def value_of_known(table: types.Type, key: types.Type) -> object:  # noqa: ARG001  as above
        at = _find(table, known)
        if at < 0:
            raise KeyError("the map has no such key")
        return _value(table, at)

    def value_of(table: types.Type, key: types.Type) -> object:
        at = _find(table, key)
        if at < 0:
            raise KeyError("the map has no such key")
        return _value(table, at)

    return value_of if known is None else value_of_known


def _as_shown(shown: Shown) -> Callable[[types.Type], object]:
    """The same map, of which iteration gives something else."""

    @intrinsic
    def again(typing: object, table: types.Type) -> Implementation:  # noqa: ARG001 - numba passes it
        type_ = cast("MapType", table)

        def codegen(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
            return impl_ret_borrowed(context, builder, signature.return_type, arguments[0])

        return MapType(type_.family, type_.node, shown)(table), codegen

    def method(table: types.Type) -> object:  # noqa: ARG001  as above
        def view(table: types.Type) -> object:
            return again(table)

        return view

    return method


for each in get_args(Shown):
    overload_method(MapType, each)(_as_shown(each))


@lower_builtin("getiter", MapType)
def _iterate(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value]) -> ir.Value:
    type_ = signature.args[0]
    made = cgutils.create_struct_proxy(signature.return_type)(context, builder)
    made.rows = context.compile_internal(builder, _pairs, ROWS(type_), arguments)
    made.index = cgutils.alloca_once_value(builder, constant(0))
    made.table = arguments[0]
    context.nrt.incref(builder, type_, arguments[0])
    return impl_ret_new_ref(context, builder, signature.return_type, made._getvalue())  # noqa: SLF001 - numba's way to its value


@lower_builtin("iternext", MapIteratorType)
@iternext_impl(RefType.NEW)
def _next(context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: list[ir.Value], result: IternextResult) -> None:
    type_ = cast("MapIteratorType", signature.args[0])
    iterator = cgutils.create_struct_proxy(type_)(context, builder, value=arguments[0])
    rows = context.make_array(ROWS)(context, builder, iterator.rows)
    index = builder.load(iterator.index)
    is_more = builder.icmp_signed("<", index, rows.nitems)
    result.set_valid(is_more)
    with builder.if_then(is_more):
        at = builder.load(builder.gep(rows.data, [index]), typ=I64)
        result.yield_(_part(Reader(context, builder, type_.table, iterator.table), at, type_.table.shown))
        builder.store(builder.add(index, constant(1)), iterator.index)
