"""Columns of texts and byte strings: `Texts`, which numpy and pandas compare and take as arrays of Python's own values."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import repeat
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rosetta_jit.model.types import String
from rosetta_jit.runtime.batches.nested import Ragged
from rosetta_jit.runtime.holder import coerce

if TYPE_CHECKING:
    from numpy.typing import NDArray


_OCTETS, _CODE_UNITS = String("octets"), String("utf-16")


class Texts(Ragged):
    """Texts, or byte strings: what `Ragged` is, and an array of `str` or `bytes` for numpy.

    ``column == "base"`` compares each of them, ``batch[column == "base"]`` chooses messages.
    """

    __slots__ = ()

    def __getitem__(self, index: Any) -> Any:
        found = super().__getitem__(index)
        if isinstance(found, Ragged):
            return found
        return self._text(memoryview(found).cast("B")) if self.kind == "text" else bytes(found)

    def _text(self, data: memoryview) -> str:
        return coerce.decoded(_OCTETS if self.values.dtype == np.uint8 else _CODE_UNITS, data)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Python's own values: numpy's own texts and byte strings lose zeros at their end."""
        if copy is False:
            raise ValueError("texts are made: there is nothing to show without a copy")
        found = np.empty(len(self), np.object_)
        found[:] = self.to_list()
        return found if dtype is None else found.astype(dtype)

    def to_numpy(self) -> NDArray[Any]:
        """An array of `str` or `bytes`, of the type ``object``."""
        return np.asarray(self)

    def _values_array(self) -> Any:
        from rosetta_jit.runtime.arrow.column import texts

        return texts(self.to_list(), self.kind)

    def __dlpack__(self, **options: Any) -> Any:
        """The bytes, or code units, where all are of one length."""
        return self._matrix().__dlpack__(**options)

    def __eq__(self, other: object) -> Any:
        """Which are equal to a text, or each to that of another column or list: bools, shape (n,)."""
        if other is None:
            return NotImplemented
        return np.fromiter((mine == each for mine, each in self._beside(other)), np.bool_, len(self))

    def __ne__(self, other: object) -> Any:
        """Which are not equal, as `==` has it."""
        if other is None:
            return NotImplemented
        return ~(self == other)

    __hash__ = None  # pyright: ignore[reportAssignmentType]

    def _beside(self, other: Any) -> Iterable[tuple[Any, Any]]:
        if isinstance(other, str | bytes) or not isinstance(other, Iterable):
            return zip(self, repeat(other))
        theirs = list(cast("Iterable[Any]", other))
        if len(theirs) != len(self):
            raise ValueError(f"{len(self)} texts are compared with one, or with as many, not with {len(theirs)}")
        return zip(self, theirs, strict=True)
