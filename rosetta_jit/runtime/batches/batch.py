"""Batches: many messages of one type in the lanes of one holder, read as columns or one by one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, cast, overload

import numpy as np

from rosetta_jit.errors import DecodeError, InUse
from rosetta_jit.kernel.state import EPOCH, VALID
from rosetta_jit.runtime.batches.columns import column, presence_mask
from rosetta_jit.runtime.batches.nested import Origin, of_batch
from rosetta_jit.runtime.batches.parts import contents, errors_of_part, errors_together, joined, revived
from rosetta_jit.runtime.batches.tables import WithTables
from rosetta_jit.runtime.holder import Holder, Manners
from rosetta_jit.runtime.holder.classes import HolderFamily
from rosetta_jit.runtime.holder.family import family_of
from rosetta_jit.runtime.holder.paths import entries_to
from rosetta_jit.runtime.lanes import Lanes, in_use
from rosetta_jit.runtime.memory_for_arrow import Handed

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_INTERNAL = frozenset({"lanes", "room", "reset"})
"""What batches have for other modules."""


class Batch(WithTables):
    """``n`` messages.

    ``batch[i]`` is a view of one, with the manners of its holder; ``batch.angles`` is a column (``batch.column("angles")`` where the
    name is taken). Both show the lanes as they are: they do not outlive the next decode into the batch. ``batch[5:10]``,
    ``batch[mask]`` and ``batch[[7, 3]]`` are batches of their own.

    Attributes
    ----------
    lanes : Lanes
        Message i is row i of lane 0.
    errors : dict of DecodeError
        Those of the last ``many(…, on_error="skip")`` or ``"mask"`` into the batch, by the number of the message among all that were
        given: of a part of a batch with ``"skip"`` those of the whole, with ``"mask"`` those of its rows, by their new numbers.
    kept : ndarray of int64, shape (n,)
        Which of the messages that were given each row is.
    """

    __slots__ = ("_family", "_handed", "_kept", "errors", "lanes")
    if TYPE_CHECKING:  # `help` shows what stands here otherwise
        _family: HolderFamily
        _handed: Handed | None
        _kept: NDArray[np.int64] | None
        errors: dict[int, DecodeError]
        lanes: Lanes

    def __init__(self, family: HolderFamily, lanes: Lanes) -> None:
        self._family, self._handed, self._kept, self.errors, self.lanes = family, None, None, {}, lanes

    @classmethod
    def new(cls, holder_class: type[Holder], count: int) -> Batch:
        """So many empty messages of a type."""
        batch = cls.room(holder_class, count)
        with batch.lanes:
            batch.lanes.initialise(batch.lanes.plan.initial, 0, count)
        return batch

    @classmethod
    def room(cls, holder_class: type[Holder], count: int) -> Batch:
        """Room for so many messages of a type that are going to be decoded."""
        family = holder_class.family_
        return cls(family, Lanes(family.plan_of(count), family.array_type).prepared())

    @classmethod
    def from_arrow(cls, holder_class: type[Holder], source: Any) -> Batch:
        """The rows of a table as messages of a type; the inverse of `to_arrow`.

        Parameters
        ----------
        source
            A table, or whatever has Arrow's stream or array interface: frames of pandas and polars, relations of DuckDB. A field
            without a column is as in a new message; columns named with dots are fields of nested messages.

        Raises
        ------
        ImportError
            If pyarrow is not installed.
        ValuesError
            If a column is of no field, or a field cannot take exactly its values. Its path says which, its detail which value.
        TypeError
            If the source is no table, or messages contain each other: leave that column out.
        """
        from rosetta_jit.runtime.arrow import back, sources

        root = holder_class.family_.tree.root
        columns = sources.columns_of(source, root, cls.room(holder_class, 0).lanes)
        batch = cls.room(holder_class, columns.rows)
        with batch.lanes as lanes:
            back.write_columns(root, lanes, columns)
        return batch

    def reset(self, count: int) -> None:
        """So many empty messages, in the memory that is there."""
        with self.lanes:
            begin_anew(self)
            self.lanes.reset(count)

    @property
    def kept(self) -> NDArray[np.int64]:
        """Which of the messages that were given each row is: ``timestamps[batch.kept]`` are those of the rows."""
        return np.arange(len(self)) if self._kept is None else self._kept

    def __len__(self) -> int:
        return self.lanes.rows

    @overload
    def __getitem__(self, index: int | np.integer[Any]) -> Any: ...
    @overload
    def __getitem__(self, index: slice | ArrayLike) -> Batch: ...
    def __getitem__(self, index: int | np.integer[Any] | slice | ArrayLike) -> Any:
        """A view of one message; or a new batch with copies of those that a slice, a mask or an array of numbers chooses."""
        if isinstance(index, int | np.integer) and not isinstance(index, bool):
            return self._row(int(cast("int", index)))
        part = Batch(self._family, joined([(self.lanes, index)]))
        part.errors, part._kept = errors_of_part(self.errors, self._kept, index, len(self))
        return part

    def _row(self, index: int) -> Any:
        epoch = self.lanes.words[EPOCH]
        try:
            row = range(len(self))[index]
        except IndexError:
            if epoch < 0 or self.lanes.words[EPOCH] != epoch:
                raise in_use() from None
            raise IndexError(f"message {index} of {len(self)}") from None
        return self._family.row(self.lanes, row)

    @classmethod
    def concatenate(cls, batches: Iterable[Batch]) -> Batch:
        """The messages of some batches of one type, one batch behind the other.

        Raises
        ------
        ValueError
            If there is no batch.
        TypeError
            If they are of different types.
        """
        parts = list(batches)
        if strange := [each for each in parts if not isinstance(each, Batch)]:  # pyright: ignore[reportUnnecessaryIsInstance]
            raise TypeError(f"batches are needed, not {type(strange[0]).__name__}")
        if not parts:
            raise ValueError("there is no batch, whose type would be that of the whole")
        family = family_in(parts[0])
        if any(family_in(each) is not family for each in parts):
            names = ", ".join(sorted({family_in(each).struct.name for each in parts}))
            raise TypeError(f"batches of one type are needed, not of {names}")
        whole = cls(family, joined([(each.lanes, slice(None)) for each in parts]))
        whole.errors, whole._kept = errors_together((each.errors, each._kept, len(each)) for each in parts)  # noqa: SLF001
        return whole

    def __iter__(self) -> Iterator[Any]:
        return (self._family.row(self.lanes, row) for row in range(len(self)))

    def __reduce__(self) -> tuple[Any, ...]:
        """By lanes: their bytes, which protocol 5 of pickle hands on without a copy."""
        return _revived, (self._family.text, self._family.manners, contents(self[:].lanes), self.errors, self._kept)

    def __getattr__(self, name: str) -> Any:
        if name in self.__slots__:
            raise AttributeError(f"this batch was never made: it has no {name!r}")
        if name in self._family.tree.root.entries:
            return self.column(name)
        raise AttributeError(f"{self!r} has no field {name!r}", name=name, obj=self)

    def __dir__(self) -> list[str]:
        """The fields, and what users call."""
        own = [name for name in super().__dir__() if name not in _INTERNAL and (name.startswith("__") or not name.startswith("_"))]
        return [*own, *self._family.tree.root.entries]

    def __repr__(self) -> str:
        if not self.lanes.words[VALID]:
            why = "in use" if isinstance(self.lanes.invalid(), InUse) else "the last decode failed"
            return f"<Batch of {self._family.struct.name}: {why}>"
        return f"<Batch of {len(self)} {self._family.struct.name}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the first messages."""
        from rosetta_jit.runtime.looks.page import batch_page, failed_page

        if not self.lanes.words[VALID]:
            return failed_page(self)
        names = list(self._family.tree.root.entries)
        return self.lanes.consistent(lambda batch: batch_page(batch, names), self)

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
        Columns
            Of a message: its columns by name, a dict that has them as attributes, too.

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
        entries_to(self._family.tree.root, name)
        return of_batch(
            column(self._family.tree.root, self.lanes, len(self), name.split(".")), Origin(self._column_to_arrow, self.to_arrow, name)
        )

    def mask(self, name: str | None = None) -> NDArray[np.bool_]:
        """Which messages have a field, shape (n,): all, where it cannot be absent. A nested field needs those around it.

        Without a name, which messages could be decoded: all, unless ``many(…, on_error="mask")`` has left some empty.

        Raises
        ------
        KeyError
            If there is no such field, or it is one of the elements of an array.
        InvalidHolder
            If the last decode into the batch failed.
        """
        return self.lanes.consistent(self._mask, name)

    def _mask(self, name: str | None) -> NDArray[np.bool_]:
        self._check()
        if name is None:
            return ~np.isin(self.kept, list(self.errors))
        present = presence_mask(None, self.lanes, len(self))
        for entry in entries_to(self._family.tree.root, name, through_arrays=False):
            present &= presence_mask(entry.presence, self.lanes, len(self))
        return present


# What other modules have of batches: none of it is for users.
# pyright: reportPrivateUsage=false


def family_in(batch: Batch) -> HolderFamily:
    """The family of a batch's messages."""
    return batch._family  # noqa: SLF001


def begin_anew(batch: Batch) -> None:
    """Inside ``with batch.lanes:``, before other messages: forget errors, and take other memory where tables have taken it."""
    object.__setattr__(batch, "errors", {})  # each call of `many` comes here
    object.__setattr__(batch, "_kept", None)
    if batch._handed is not None:  # noqa: SLF001
        batch._handed.renew(batch.lanes)  # noqa: SLF001


def is_handed_over(batch: Batch) -> bool:
    """Whether tables may take memory of a batch (`hand_over`)."""
    return batch._handed is not None  # noqa: SLF001


def keep_only(batch: Batch, kept: NDArray[np.int64]) -> None:
    """Note which of the messages that were given a batch has kept."""
    batch._kept = kept  # noqa: SLF001


def hand_over(batch: Batch) -> None:
    """Let tables of a batch take its memory: only where nobody else changes the batch."""
    batch._handed = batch._handed or Handed()  # noqa: SLF001


def _revived(text: str, manners: Manners, found: list[NDArray[np.uint8]], errors: Any, kept: NDArray[np.int64] | None) -> Batch:
    family = cast("HolderFamily", family_of(text, manners))
    batch = Batch(family, revived(family.layout, family.tree.initial, family.array_type, found))
    batch.errors, batch._kept = errors, kept  # noqa: SLF001
    return batch
