"""Holders: a class for each type, whose objects own lanes and show them as attributes.

`holder_class` makes the class; decoders and encoders of one type share it. What its objects can do beyond that, and how arrays behave, is a
`Manners`: that of the framework whose type it is, or `PLAIN`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, Self, cast

import numpy as np

from rosetta_jit.kernel.state import VALID
from rosetta_jit.model.layout import layout
from rosetta_jit.model.serial import from_plain, to_plain
from rosetta_jit.model.types import Ref, Struct
from rosetta_jit.runtime.holder import arena, values
from rosetta_jit.runtime.holder.access import Access, raw
from rosetta_jit.runtime.lanes import CLEAN, Lanes, plan
from rosetta_jit.runtime.holder.message import OWN_SLOTS, VIEW_SLOTS, Message, View, bind_row, place, stale_getter, view_setter
from rosetta_jit.runtime.holder.record import Blob, Numbers, Text, Tree
from rosetta_jit.runtime.holder.sequence import Dictionary, Sequence

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from rosetta_jit.model.types import Schema, Type
    from rosetta_jit.runtime.holder.record import Entry, Record


class Holder(Message):
    """A message with lanes of its own. Subclasses are made by `holder_class`."""

    __slots__ = OWN_SLOTS

    family_: Family

    def __init__(self) -> None:
        family = self.family_
        self.lanes_ = self.home_ = Lanes(family.plan, family.array_type)
        self.row_ = 0

    def new(self) -> Self:
        """An empty holder of the same type."""
        return cast("type[Self]", self.family_.holder)()

    def view(self, name: str) -> NDArray[Any]:
        """An array, string or bytes field as numpy array, without a copy.

        Returns
        -------
        ndarray
            Of uint8 for strings and bytes. Read-only where it shows the message that the field was borrowed from.

        Raises
        ------
        KeyError
            If there is no such field.
        TypeError
            If its value is no array of numbers or bytes.
        """
        lanes, row = place(self)
        node = self.access_.record.entries[name].node
        match node:
            case Numbers(span, lane, _, _):
                start, count = arena.span_of(lanes, span, row)
                return lanes.arrays[lane][start : start + count].view(np.ndarray)
            case Text(span, lane, _) | Blob(span, lane):
                return np.frombuffer(arena.content(lanes, span, lane, row), np.uint8)
            case _:
                raise TypeError(f"`{name}` is no array of numbers, and no bytes")

    def has(self, name: str) -> bool:
        """Whether a field is present: KeyError where there is none of that name."""
        lanes, row = place(self)
        return arena.present(lanes, self.access_.record.entries[name].presence, row)

    def clear(self, name: str | None = None) -> None:
        """Make a field absent or empty; without a name, all of them."""
        clear(self, name)

    def which(self, union: str) -> str | None:
        """The name of the case of a union that is present."""
        lanes, row = place(self)
        record = self.access_.record
        return next((case for case in record.unions[union] if arena.present(lanes, record.entries[case].presence, row)), None)

    def to_dict(self) -> dict[str, Any]:
        """Plain Python values of what is present, named as in the IDL: enums by their names, arrays as lists."""
        lanes, row = place(self)
        return values.read_record(self.access_.record, lanes, row, values.Form.PLAIN)

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> Self:
        """A holder of plain values; the inverse of `to_dict`.

        Raises
        ------
        ValuesError
            If a name or a value is not one of the type; its path says which.
        """
        holder = cast("type[Self]", cls.family_.holder)()
        values.write_record(cls.access_.record, holder.lanes_, 0, raw(plain))
        return holder

    def materialise(self) -> None:
        """Make the holder fit to be encoded, which it is unless it borrows, or has been written to in certain orders."""
        settle(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Holder) or other.access_.record.struct != self.access_.record.struct:
            return NotImplemented
        return equal(raw(self), raw(other))

    __hash__ = None  # pyright: ignore[reportAssignmentType]  as of every mutable object

    def __repr__(self) -> str:
        name = type(self).__name__
        if not self.lanes_.words[VALID]:
            return f"<{name}: the last decode failed>"
        return f"{name}({', '.join(f'{key}={value!r}' for key, value in self.to_dict().items())})"

    def __copy__(self) -> Self:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        copied = self.new()
        values.write_record(copied.access_.record, copied.lanes_, 0, raw(self))
        return copied

    def __reduce__(self) -> tuple[Any, ...]:
        return _revived, (self.family_.text, self.family_.manners, raw(self))


def clear(holder: Holder, name: str | None) -> None:
    """Make a field absent or empty, or all of them; a holder whose decode failed becomes valid so."""
    if name is not None:
        lanes, row = place(holder)
        arena.clear(lanes, holder.access_.record.entries[name], row)
    elif isinstance(holder, View):
        arena.clear_record(*_swap(place(holder), holder.access_.record))
    else:
        holder.lanes_.reset()


def _swap(where: tuple[Lanes, int], record: Record) -> tuple[Lanes, Record, int]:
    return where[0], record, where[1]


def settle(holder: Holder) -> None:
    """`Holder.materialise`, where a field has taken that name."""
    lanes, _ = place(holder)
    if lanes.words[VALID] != CLEAN:
        values.settle(holder.family_.tree.root, lanes)


def equal(left: Any, right: Any) -> bool:
    """Whether raw values are the same; NaN is not."""
    if isinstance(left, np.ndarray):
        return isinstance(right, np.ndarray) and np.array_equal(cast("Any", left), cast("Any", right))
    if isinstance(left, dict):
        mine, its = cast("dict[Any, Any]", left), cast("dict[Any, Any]", right)
        return mine.keys() == its.keys() and all(equal(value, its[key]) for key, value in mine.items())
    if isinstance(left, list):
        some, others = cast("list[Any]", left), cast("list[Any]", right)
        return len(some) == len(others) and all(map(equal, some, others))
    return bool(left == right)


@dataclass(frozen=True, slots=True)
class Manners:
    """How holders of a framework behave.

    Attributes
    ----------
    base : type
        What holder classes inherit from: a subclass of `Holder` without slots of its own.
    array_type : type
        What arrays of numbers are shown as: numpy's class, or a subclass with a slot ``owner_`` for message and field.
    sequence, mapping : callable
        What shows arrays of anything else, and maps.
    assigns_whole : bool
        Whether arrays, maps and messages can be assigned to.
    members : callable
        What else the class of a struct has, by name, given its family: constants, nested classes.
    """

    base: type[Holder]
    array_type: type[np.ndarray[Any, Any]]
    sequence: Callable[[Message, Entry], Any]
    mapping: Callable[[Message, Entry], Any]
    assigns_whole: bool
    members: Callable[[Family], dict[str, Any]]


def no_members(family: Family) -> dict[str, Any]:  # noqa: ARG001  a plain class has nothing but its fields
    """Nothing."""
    return {}


PLAIN = Manners(Holder, np.ndarray, Sequence, Dictionary, assigns_whole=True, members=no_members)


class Family:
    """What the objects and views of one holder class share."""

    def __init__(self, text: str, manners: Manners) -> None:
        self.text = text
        self.manners = manners
        self.type, self.schema = from_plain(json.loads(text))
        self.layout = layout(self.type, self.schema)
        self.tree = Tree(self.type, self.schema, self.layout)
        self.plan = plan(self.layout)
        self.array_type, self.sequence, self.mapping = manners.array_type, manners.sequence, manners.mapping
        self.assigns_whole = manners.assigns_whole
        self._accesses: dict[int, Access] = {}
        self._views: dict[str, type[View]] = {}
        self.struct = cast("Struct", self.schema.resolve(self.type))

    @cached_property
    def holder(self) -> type[Holder]:
        """The holder class."""
        access = self.access(self.tree.root)
        properties = {name: property(access.getters[name], access.setters[name]) for name in _shown(self.tree.root, self.manners.base)}
        members = {"family_": self, "access_": access, "__slots__": (), "__doc__": f"A holder of `{self.struct.name}`."}
        return _class(self.struct.name, (self.manners.base,), {**self.manners.members(self), **properties, **members})

    def of_struct(self, struct: str) -> type[Holder]:
        """The holder class of another struct of the schema, with the same manners."""
        return self.holder if struct == self.struct.name else holder_class(Ref(struct), self.schema, self.manners)

    def view_class(self, struct: str) -> type[View]:
        """The class of views of a struct: a subclass of its holder class."""
        view = self._views.get(struct)
        if view is None:
            base = self.of_struct(struct)
            record = base.family_.tree.root
            properties = {name: property(stale_getter(name), view_setter(name)) for name in _shown(record, self.manners.base)}
            view = _class(struct, (View, base), {**properties, "__slots__": VIEW_SLOTS, "__doc__": base.__doc__})
            self._views[struct] = view
        return view

    def access(self, record: Record) -> Access:
        """How the fields of a record are read and written."""
        access = self._accesses.get(id(record))
        if access is None:
            access = self._accesses[id(record)] = Access(record, self)
        return access

    @cached_property
    def _empty(self) -> Lanes:
        return Lanes(self.plan, self.array_type)

    def empty_lanes(self) -> Lanes:
        """Lanes in which everything is absent; they are never written."""
        return self._empty

    def row(self, lanes: Lanes, row: int) -> View:
        """A view of one message of a batch."""
        cls = self.view_class(self.struct.name)
        return bind_row(cls.__new__(cls), lanes, self.access(self.tree.root), row)


def _shown(record: Record, base: type) -> list[str]:
    """Fields that become properties: all but those whose names Python or the holder need for themselves."""
    own = {*OWN_SLOTS, *VIEW_SLOTS, "family_"}
    return [name for name in record.entries if name not in own and not (name.startswith("__") and hasattr(base, name))]


def _class(qualified: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> Any:
    module, _, name = qualified.rpartition(".")
    return type(name or "Message", bases, {"__module__": module, **namespace})


def holder_class(type_: Type, schema: Schema, manners: Manners = PLAIN) -> type[Holder]:
    """The holder class of a struct. Equal types give the same class.

    Raises
    ------
    ValueError
        If the type is not a struct, or its rows would be too large.
    """
    return holder_class_of(to_plain(type_, schema), manners)


def holder_class_of(plain: Mapping[str, Any], manners: Manners = PLAIN) -> type[Holder]:
    """The holder class of a type as `rosetta_jit.model.serial` writes it."""
    return _family(json.dumps(plain, sort_keys=True), manners).holder


@cache
def _family(text: str, manners: Manners) -> Family:
    return Family(text, manners)


def _revived(text: str, manners: Manners, plain: dict[str, Any]) -> Holder:
    """Unpickle."""
    holder = _family(text, manners).holder()
    values.write_record(holder.access_.record, holder.lanes_, 0, plain)
    return holder
