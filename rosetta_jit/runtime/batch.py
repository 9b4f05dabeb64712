"""Batches: many messages of one type in the lanes of one holder, read as columns or one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_never

from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.columns import Ragged, column, presence_mask
from rosetta_jit.runtime.holder.access import raw
from rosetta_jit.runtime.holder.family import family_of
from rosetta_jit.runtime.holder.record import Blob, Child, Items, Numbers, Pairs, Record, Scalar, Text
from rosetta_jit.runtime.holder.values import write_record
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.plan import plan

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from rosetta_jit.runtime.holder import Family, Holder, Manners
    from rosetta_jit.runtime.holder.record import Entry, Node


class Batch:
    """``n`` messages.

    ``batch[i]`` is a view of one, with the manners of its holder; ``batch.angles`` is a column (``batch.column("angles")`` where the
    name is taken). Both show the lanes as they are: they do not outlive the next decode into the batch.

    Attributes
    ----------
    lanes : Lanes
        Message i is row i of lane 0.
    """

    __slots__ = ("family_", "lanes")

    def __init__(self, family: Family, lanes: Lanes) -> None:
        self.family_ = family
        self.lanes = lanes

    @classmethod
    def new(cls, holder_class: type[Holder], count: int) -> Batch:
        """So many empty messages of a type."""
        batch = cls.room(holder_class, count)
        with batch.lanes:
            batch.lanes.bear(batch.lanes.plan.births, 0, count)
        return batch

    @classmethod
    def room(cls, holder_class: type[Holder], count: int) -> Batch:
        """Room for so many messages of a type that are going to be decoded."""
        family = holder_class.family_
        return cls(family, Lanes(plan(family.layout, count, family.tree.births), family.array_type))

    def reset(self, count: int) -> None:
        """So many empty messages, in the memory that is there."""
        with self.lanes:
            self.lanes.reset(count)

    def __len__(self) -> int:
        return self.lanes.rows

    def __getitem__(self, index: int) -> Any:
        try:
            row = range(len(self))[index]
        except IndexError:
            raise IndexError(f"message {index} of {len(self)}") from None
        return self.family_.row(self.lanes, row)

    def __iter__(self) -> Iterator[Any]:
        return (self.family_.row(self.lanes, row) for row in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        return _revived, (self.family_.text, self.family_.manners, [raw(message) for message in self])

    def __getattr__(self, name: str) -> Any:
        if name in self.__slots__:
            raise AttributeError(f"this batch was never made: it has no {name!r}")
        if name in self.family_.tree.root.entries:
            return self.column(name)
        raise AttributeError(name)

    def __repr__(self) -> str:
        return f"<Batch of {len(self)} {self.family_.struct.name}>"

    def column(self, name: str) -> Any:
        """A field of all messages.

        Parameters
        ----------
        name
            As in the IDL; a field of a nested message with dots: ``image.width``.

        Returns
        -------
        ndarray
            Shape (n,), of a number; not copied. Zero where the field is absent (see `mask`).
        Ragged
            Of an array, string, bytes or map.
        dict
            Of a message: its columns by name.

        Raises
        ------
        KeyError
            If there is no such field.
        TypeError
            If messages contain each other without bound there.
        InvalidHolder
            If the last decode into the batch failed.
        """
        return self.lanes.consistent(self._column, name)

    def _column(self, name: str) -> Any:
        self._check()
        return column(self.family_.tree.root, self.lanes, len(self), name.split("."))

    def mask(self, name: str) -> NDArray[np.bool_]:
        """Which messages have a field, shape (n,): all, where it cannot be absent. A nested field needs those around it."""
        return self.lanes.consistent(self._mask, name)

    def _mask(self, name: str) -> NDArray[np.bool_]:
        self._check()
        record: Record = self.family_.tree.root
        present = presence_mask(None, self.lanes, len(self))
        for each in name.split("."):
            entry: Entry = record.entries[each]
            present &= presence_mask(entry.presence, self.lanes, len(self))
            if isinstance(entry.node, Record):
                record = entry.node
        return present

    def to_arrow(self) -> Any:
        """A `pyarrow.Table` of the columns; absent values are null, maps are lists of key and value.

        Raises
        ------
        ImportError
            If pyarrow is not installed.
        """
        import pyarrow as pa  # pyright: ignore[reportMissingImports]

        arrow: Any = pa
        messages = [message.to_dict() for message in self] if any(map(self._is_composed, self.family_.tree.root.entries)) else []
        return arrow.table({name: self._arrow(arrow, name, messages) for name in self.family_.tree.root.entries})

    def _is_composed(self, name: str) -> bool:
        return not isinstance(self.family_.tree.root.entries[name].node, Scalar | Numbers)

    def _arrow(self, arrow: Any, name: str, messages: list[dict[str, Any]]) -> Any:
        if self._is_composed(name):
            node = self.family_.tree.root.entries[name].node
            return arrow.array([for_arrow(node, message[name]) if name in message else None for message in messages])
        values = self.column(name)
        if isinstance(values, Ragged):
            return arrow.LargeListArray.from_arrays(values.offsets, arrow.array(values.flat()))
        return arrow.array(values, mask=~self.mask(name))

    def _check(self) -> None:
        if not self.lanes.words[VALID]:
            raise self.lanes.invalid()


def _revived(text: str, manners: Manners, messages: list[dict[str, Any]]) -> Batch:
    """Unpickle, or copy."""
    batch = Batch.new(family_of(text, manners).holder, len(messages))
    with batch.lanes as lanes:
        for row, message in enumerate(messages):
            write_record(batch.family_.tree.root, lanes, row, message)
    return batch


def for_arrow(node: Node, value: Any) -> Any:
    """A plain value with its maps as lists of pairs: Arrow's structs have one set of names, and only text for names."""
    match node:
        case Pairs(_, _, _, _, of_key):
            return [{"key": key, "value": for_arrow(of_key.node, each)} for key, each in value.items()]
        case Items(_, _, element, _):
            return [for_arrow(element, each) for each in value]
        case Record():
            return {name: for_arrow(node.entries[name].node, each) for name, each in value.items()}
        case Child():
            return for_arrow(node.record, value)
        case Scalar() | Text() | Blob() | Numbers():
            return value
        case _:
            assert_never(node)
