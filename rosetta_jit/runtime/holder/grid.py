"""Arrays of several dimensions, all of fixed length, of numbers: one numpy array over the lane of the innermost ones.

Its rows lie together wherever they were initialised or decoded. Where they do not, it is shown as a copy that cannot be written.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, cast

import numpy as np

from rosetta_jit.model.layout import scalar_of
from rosetta_jit.runtime.cells import dtype_of
from rosetta_jit.runtime.holder import arena, coerce
from rosetta_jit.runtime.holder.record import Items, Numbers, ScalarType
from rosetta_jit.runtime.lanes import Lanes

Array = np.ndarray[Any, Any]


def zeros(type_: ScalarType, shape: tuple[int, ...]) -> Array:
    """An array of zeros that takes no memory and cannot be written: what an array shows that is not there."""
    return np.broadcast_to(np.zeros((), dtype_of(scalar_of(type_))), shape)


def view(node: Items, lanes: Lanes, row: int) -> Array:
    """The array in a row; writable if its rows lie together."""
    numbers = innermost(node)
    first = _first(node, lanes, row)
    if first is not None:
        size = int(np.prod(node.shape))
        return lanes.arrays[numbers.lane][first : first + size].reshape(node.shape)
    if arena.span_of(lanes, node.span, row)[1] != node.length or 0 in node.shape:
        return zeros(numbers.type, node.shape)
    copied = _copied(node, lanes, row)
    copied.flags.writeable = False
    return copied


def prepare(node: Items, value: Any) -> Array:
    """The elements of an array of the right shape, or of nested sequences of the right lengths, in one dimension.

    Raises
    ------
    TypeError, ValueError
        If the shape or an element is wrong.
    """
    type_ = innermost(node).type
    if isinstance(value, np.ndarray):
        array = cast("Array", value)
        if array.shape != node.shape:
            raise ValueError(f"an array of shape {array.shape} where the type has {node.shape}")
        return coerce.numbers(type_, array.reshape(-1))
    return coerce.numbers(type_, _flat(value, node.shape))


def put(node: Items, lanes: Lanes, row: int, prepared: Array) -> None:
    """Write what `prepare` made."""
    if not prepared.size:
        return
    first = _first(node, lanes, row)
    if first is None:
        arena.resize(lanes, node, row, 0)
        arena.resize(lanes, node, row, node.shape[0])
        first = _first(node, lanes, row)
        assert first is not None, "initial rows lie together"
    lanes.arrays[innermost(node).lane][first : first + prepared.size] = prepared


def innermost(node: Items) -> Numbers:
    """The node of the last dimension."""
    element = node.element
    while not isinstance(element, Numbers):
        element = cast("Items", element).element
    return element


def _first(node: Items, lanes: Lanes, row: int) -> int | None:
    """Where the numbers begin, if they all lie together and in order."""
    start, count = arena.span_of(lanes, node.span, row)
    if count != node.length or 0 in node.shape:
        return None
    element = node.element
    while True:
        assert isinstance(element, Numbers) or cast("Items", element).shape
        inner = cast("Numbers | Items", element)
        words = lanes.row_words(inner.span.lane, start, count)
        starts, counts = words[:, inner.span.index], words[:, inner.span.index + 1]
        length = cast("int", inner.length)
        if (counts != length).any() or (starts != starts[0] + np.arange(0, count * length, length)).any():
            return None
        start, count = int(starts[0]), count * length
        if isinstance(inner, Numbers):
            return start
        element = inner.element


def _copied(node: Items | Numbers, lanes: Lanes, row: int) -> Array:
    start, count = arena.span_of(lanes, node.span, row)
    if isinstance(node, Numbers):
        return lanes.arrays[node.lane][start : start + count] if count == node.length else zeros(node.type, (node.length or 0,))
    if count != node.length:
        return zeros(innermost(node).type, node.shape)
    element = cast("Items | Numbers", node.element)
    return np.stack([_copied(element, lanes, each) for each in range(start, start + count)])


def _flat(value: Any, shape: tuple[int, ...]) -> list[Any]:
    """The elements of nested sequences."""
    if not isinstance(value, Iterable) or isinstance(value, str | bytes | Mapping):
        raise TypeError(f"expected a sequence, {type(cast('object', value)).__name__} found")
    elements: list[Any] = list(cast("Iterable[Any]", value))
    coerce.counted(len(elements), shape[0], None)
    return elements if len(shape) == 1 else [leaf for each in elements for leaf in _flat(each, shape[1:])]
