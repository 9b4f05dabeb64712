"""Repeated fields of numbers with protobuf's manners: numpy arrays that also append, extend and delete as lists do.

Where a list and an array disagree, the array wins (``==`` and ``+`` go element by element), but for truth (`if message.samples:` asks
whether there are any) and iteration (Python's own numbers). An array shows the elements that were there when it was read from its message:
read the attribute again after a change of length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from rosetta_jit.runtime.holder.message import Message, place, writable
from rosetta_jit.runtime.holder.record import Entry, Numbers
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import coerce, merge, values
else:
    coerce, merge, values = late("rosetta_jit.runtime.holder", "coerce", "merge", "values")

_Result = TypeVar("_Result")


class NumberArray(np.ndarray[Any, Any]):
    """A repeated field of numbers, or of enums: a view into its message's lane.

    Attributes
    ----------
    owner_ : tuple of message and field
        Whose elements these are. Slices and copies have none, and cannot change their length.
    """

    __slots__ = ("owner_",)

    def _is_field(self) -> bool:
        """Whether these are the elements of a field, not of a slice or a copy."""
        return getattr(self, "owner_", None) is not None

    def _field(self) -> tuple[Message, Numbers]:
        owner: tuple[Message, Entry] | None = getattr(self, "owner_", None)
        if owner is None:
            raise TypeError("a slice or copy of a repeated field cannot change its length; change the field itself")
        return owner[0], cast("Numbers", owner[1].node)

    def _change(self, change: Callable[[list[Any]], _Result]) -> _Result:
        """Change the field's elements as a list. InUse where they have become others meanwhile."""
        message, node = self._field()
        epoch = message.lanes_.epoch()
        elements = message.lanes_.consistent(_elements, (message, node)).tolist()
        result = change(elements)
        prepared = values.prepare(node, elements)
        with message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            values.put(node, *writable(message), prepared)
        return result

    def append(self, value: Any) -> None:
        self.extend([value])

    def extend(self, elements: Iterable[Any]) -> None:
        """Append all elements, or none if one is wrong."""
        merge.append_numbers(*self._field(), iterable(elements))

    MergeFrom = extend

    def insert(self, index: int, value: Any) -> None:
        self._change(lambda elements: elements.insert(index, value))

    def pop(self, index: int = -1) -> Any:
        return self._change(lambda elements: elements.pop(index))

    def remove(self, value: Any) -> None:
        self._change(lambda elements: elements.remove(value))

    def clear(self) -> None:
        """Remove all elements, whichever there are."""
        message, node = self._field()
        with message.lanes_:
            values.put(node, *writable(message), values.prepare(node, []))

    def reverse(self) -> None:
        self._change(lambda elements: elements.reverse())

    def sort(self, *, key: Callable[[Any], Any] | None = None, reverse: bool = False) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Sort in place, as a list does."""
        if self._is_field():
            self._change(lambda elements: elements.sort(key=cast("Any", key), reverse=reverse))
        else:
            self[...] = sorted(self.tolist(), key=cast("Any", key), reverse=reverse)

    def __delitem__(self, index: Any) -> None:
        self._change(lambda elements: elements.__delitem__(index))

    def __setitem__(self, index: Any, value: Any) -> None:
        """Set an element, or several as numpy does; a list in place of a slice may have another length, as in a list."""
        if self._is_field():
            if isinstance(index, slice) and isinstance(value, list | tuple):
                part, elements = cast("slice[Any, Any, Any]", index), cast("list[Any]", value)
                if len(elements) != len(range(self.size)[part]):
                    self._change(lambda whole: whole.__setitem__(part, elements))
                    return
            elif isinstance(index, int):
                super().__setitem__(index, coerce.scalar(self._field()[1].type, value))
                return
        super().__setitem__(cast("Any", index), cast("Any", value))

    def __iter__(self) -> Iterator[Any]:
        return iter(self.tolist())

    def __bool__(self) -> bool:
        return self.size > 0

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Results of arithmetic are arrays like any other."""
        return array[()] if return_scalar else np.asarray(array)


def _elements(field: tuple[Message, Numbers]) -> Any:
    message, node = field
    return values.read(node, *place(message), values.Form.RAW)


def iterable(elements: Any) -> Iterable[Any]:
    """Elements to be appended; TypeError if they are none."""
    if not isinstance(elements, Iterable):
        raise TypeError("must assign iterable")
    return cast("Iterable[Any]", elements)
