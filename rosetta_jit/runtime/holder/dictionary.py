"""Maps of a message as Python's own mappings; they hold no values, only where to look."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, Mapping, MutableMapping, ValuesView
from typing import TYPE_CHECKING, Any, cast

from rosetta_jit.runtime.holder.message import View, check_readable, element, place, writable
from rosetta_jit.runtime.holder.record import Blob, Entry, Numbers, Pairs, Scalar, Text
from rosetta_jit.runtime.holder.sequence import detached, store_row
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder import access, arena, coerce, values
else:
    access, arena, coerce, values = late("rosetta_jit.runtime.holder", "access", "arena", "coerce", "values")


class Pair(View):
    """The view of one key and value, through which the view of a value that is a message finds its row."""

    __slots__ = ()


class Dictionary(MutableMapping[Any, Any]):
    """A map. Values that are messages are views.

    Finding a key reads the map once for each object of this class: keep one at hand while looking up many keys.
    """

    __slots__ = ("entry", "index", "message", "node", "seen")

    def __init__(self, message: View, entry: Entry) -> None:
        self.message = message
        self.entry = entry
        self.node = cast("Pairs", entry.node)
        self.index: dict[Any, int] = {}
        self.seen = -1
        check_readable(message)

    def _keys(self) -> dict[Any, int]:
        """Which pair is the last of each key."""
        lanes, row = place(self.message)
        epoch = self.message.lanes_.epoch()
        if self.seen != epoch or epoch < 0:
            start, count = arena.span_of(lanes, self.node.span, row)
            rows = range(start, start + count)
            self.index = {values.read(self.node.key, lanes, each, values.Form.RAW): index for index, each in enumerate(rows)}
            self.seen = epoch
        return self.index

    def _known(self) -> dict[Any, int]:
        """The number of the last pair of each key, where another thread may change the map meanwhile."""
        return self.message.lanes_.consistent(lambda dictionary: dictionary._keys(), self)  # noqa: SLF001 - it is this one

    def __len__(self) -> int:
        return len(self._known())

    def __iter__(self) -> Iterator[Any]:
        return iter(list(self._known()))

    def __contains__(self, key: object) -> bool:
        return self.checked(key) in self._known()

    def __getitem__(self, key: Any) -> Any:
        return self.found(key)

    def items(self) -> ItemsView[Any, Any]:
        return _PairsView(self)

    def values(self) -> ValuesView[Any]:
        return _PairValues(self)

    def found(self, key: Any) -> Any:
        """The value of a key that the map has; reading never puts one there. KeyError where there is none."""
        return self.message.lanes_.consistent(self._at, self.checked(key))

    def _at(self, key: Any) -> Any:
        index = self._keys()[key]
        family = self.message.access_.family
        pair = element(Pair(), self.message, family.access(self.node.record), self.entry, index)
        return pair.access_.getters["value"](pair)

    def checked(self, key: object) -> Any:
        """The key as the map holds it.

        Raises
        ------
        TypeError, ValueError
            If the map can have no such key.
        """
        node = self.node.key
        prepared = values.prepare(node, key)
        return coerce.decoded(node.type, memoryview(prepared)) if isinstance(node, Text) else prepared

    def pop(self, key: Any, *default: Any) -> Any:
        """Remove a key and return its value, a message as one of its own; or what is to be returned where the key is not there."""
        epoch = self.message.lanes_.epoch()
        try:
            popped = detached(self.found(key))
        except KeyError:
            if default:
                return default[0]
            raise
        with self.message.lanes_ as lanes:
            lanes.check_unchanged(epoch)
            self._remove(key)
        return popped

    def popitem(self) -> tuple[Any, Any]:
        """Remove the first pair and return it. KeyError where there is none."""
        for key in self:
            return key, self.pop(key)
        raise KeyError("the map is empty")

    def __setitem__(self, key: Any, value: Any) -> None:
        plain = access.raw(value)
        with self.message.lanes_:
            self._store(key, plain)

    def setdefault(self, key: Any, default: Any = None) -> Any:
        """The value of a key; where it is not there, it is put there with a value."""
        if self.checked(key) not in self._known():
            self._add(key, default)
        return self.found(key)

    def _add(self, key: Any, value: Any) -> None:
        """Put a key there, unless another thread has done so meanwhile."""
        plain = access.raw(value)
        with self.message.lanes_:
            if self.checked(key) not in self._keys():
                self._store(key, plain)

    def _store(self, key: Any, plain: Any) -> None:
        node, index = self.node, self._keys().get(self.checked(key))
        lanes, row = writable(self.message)
        if index is not None:
            start, _ = arena.span_of(lanes, node.span, row)
            if not isinstance(node.value.node, Scalar | Text | Blob | Numbers):
                arena.clear(lanes, node.value, start + index)
            store_row(node.value.node, lanes, start + index, plain)
            return
        _, count = arena.span_of(lanes, node.span, row)
        start = arena.resize(lanes, node, row, count + 1)
        try:
            values.store(node.key, lanes, start + count, key)
            store_row(node.value.node, lanes, start + count, plain)
        except BaseException:
            arena.resize(lanes, node, row, count)
            raise

    def __delitem__(self, key: Any) -> None:
        with self.message.lanes_:
            self._remove(key)

    def _remove(self, key: Any) -> None:
        """Inside ``with home_:``, remove a key."""
        wanted = self.checked(key)
        if wanted not in self._keys():
            raise KeyError(key)
        lanes, row = writable(self.message)
        start, count = arena.span_of(lanes, self.node.span, row)
        keys = [values.read(self.node.key, lanes, start + each, values.Form.RAW) for each in range(count)]
        arena.rearrange(lanes, self.node, row, [each for each in range(count) if keys[each] != wanted])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mapping):
            return NotImplemented
        return dict(self.items()) == dict(cast("Mapping[Any, Any]", other).items())

    __hash__ = None  # pyright: ignore[reportAssignmentType]  as of every mutable mapping

    def __repr__(self) -> str:
        return repr(dict(self.items()))


class _PairsView(ItemsView[Any, Any]):
    """The pairs of a map. Reading them adds no keys, even where `[]` does and another thread has removed the key meanwhile."""

    __slots__ = ()
    _mapping: Dictionary

    def __iter__(self) -> Iterator[tuple[Any, Any]]:
        for key in self._mapping:
            yield key, self._mapping.found(key)

    def __contains__(self, item: object) -> bool:
        key, value = cast("tuple[object, object]", item)
        return key in self._mapping and self._mapping.found(key) == value


class _PairValues(ValuesView[Any]):
    """The values of a map, which are read likewise."""

    __slots__ = ()
    _mapping: Dictionary

    def __iter__(self) -> Iterator[Any]:
        for key in self._mapping:
            yield self._mapping.found(key)

    def __contains__(self, value: object) -> bool:
        return any(each is value or each == value for each in self)
