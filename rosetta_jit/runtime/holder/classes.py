"""What every holder can do, whatever its type and its framework's manners: plain values, copies, views without a copy, comparison."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar, cast

import numpy as np

from rosetta_jit.errors import InUse
from rosetta_jit.kernel.state import CLEAN, VALID, WASTED
from rosetta_jit.model.layout import Layout
from rosetta_jit.runtime.attributes.code import functions
from rosetta_jit.runtime.attributes.makers import call_as_any, class_of_holder_classes, let_call
from rosetta_jit.runtime.attributes.names import take_names
from rosetta_jit.runtime.holder.first_holders import begin_in_python
from rosetta_jit.runtime.holder.making import Making
from rosetta_jit.runtime.holder.message import Access, Family, Message, View, in_row, place
from rosetta_jit.runtime.holder.record import Blob, Entry, Items, Numbers, Record, Text
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.memory_plan import Plan
from rosetta_jit.startup.late import late

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rosetta_jit.runtime.holder import access, arena, grid, paths, values
    from rosetta_jit.runtime.holder.objects.foreign import Foreign, Wholes
else:
    access, arena, grid, paths, values = late("rosetta_jit.runtime.holder", "access", "arena", "grid", "paths", "values")

if TYPE_CHECKING:

    class _HolderClassBase: ...

else:
    _HolderClassBase = class_of_holder_classes()

_Holder = TypeVar("_Holder", bound="Holder")


class HolderClass(_HolderClassBase, type):  # noqa: D101 - its __doc__ is that of its objects
    # The class of holder classes: they list their fields and what is meant to be used, and not what they need for themselves.

    __doc__ = cast("str | None", type.__dict__["__doc__"])  # else `pydoc` takes a docstring of this class for that of a holder class

    def __dir__(cls) -> list[str]:
        return _listed(cast("type[Holder]", cls), super().__dir__())

    def __setattr__(cls, name: str, value: Any) -> None:
        if name in ("__init__", "__new__"):
            call_as_any(cls)
        take_names(cls, name)
        super().__setattr__(name, value)

    def __delattr__(cls, name: str) -> None:
        take_names(cls, name)
        super().__delattr__(name)


let_call(HolderClass)


class HolderFamily(Family, Protocol):
    """What the holders of one type share; `rosetta_jit.runtime.holder.Family` is it."""

    making: Making
    plan: Plan
    cell: list[Plan]
    text: str
    layout: Layout
    manners: Any
    programs: Any

    @property
    def holder(self) -> type[Holder]: ...
    @property
    def root(self) -> Access: ...
    @property
    def described(self) -> dict[str, Any]: ...
    @property
    def foreign(self) -> Foreign: ...
    @property
    def wholes(self) -> Wholes: ...
    @property
    def takers(self) -> Any: ...
    @property
    def givers(self) -> Any: ...
    def shown(self, record: Record) -> frozenset[str]: ...
    def plan_of(self, rows: int) -> Plan: ...
    def row(self, lanes: Lanes, row: int) -> View: ...
    @property
    def roomy(self) -> Plan: ...
    def pickled(self, contents: tuple[int, int, list[bytes]]) -> tuple[Any, ...]: ...


class Holder(Message, metaclass=HolderClass):
    """A message with lanes of its own. Subclasses are made by `holder_class`."""

    __slots__ = ()

    family_: HolderFamily
    begins_alike_: ClassVar[bool] = False
    """Whether a subclass with a constructor of its own makes the same message each time that it is called without arguments."""

    def __init__(self) -> None:
        """An empty message. A holder that is made again is emptied."""  # and not replaced: compiled entries know where its lanes are
        family = self.family_
        plan, recipe, equip = family.making.latest
        if plan is family.plan and equip is not None:
            if not equip(self, recipe):
                clear(self, None)
        elif not self.lay_out_(family.plan):
            clear(self, None)

    def lay_out_(self, plan: Plan) -> bool:
        """Give the holder lanes, unless it has some."""
        family, making = self.family_, self.family_.making
        if not making.is_worth_compiling():
            return begin_in_python(self, Lanes(plan, family.array_type), family.root)
        recipe = making.recipe(plan)
        if recipe is not None:
            equip = functions()["equip"]
            making.latest = plan, recipe, equip
            if plan is family.plan:
                making.offer()
            return equip(self, recipe)
        return in_row(self, Lanes(plan, family.array_type), family.root, 0)

    def new(self) -> Self:
        """An empty holder of the same type."""
        return cast("type[Self]", self.family_.holder)()

    def view(self, name: str) -> NDArray[Any]:
        """An array, string or bytes field as numpy array, without a copy.

        Returns
        -------
        ndarray
            Of uint8 for strings and bytes, of uint16 for strings of UTF-16. Read-only where it shows the message that the field was
            borrowed from.

        Raises
        ------
        KeyError
            If there is no such field.
        TypeError
            If its value is no array of numbers or bytes.
        """
        return self.lanes_.consistent(lambda entry: _shown(self, entry), paths.entry_of(self.access_.record, name))

    def column(self, name: str) -> Any:
        """An array of messages as columns: one numpy view a field, or that of one field alone, ``points.x``; as `Batch.column` has it.

        Raises
        ------
        KeyError
            If there is no such field.
        TypeError
            If messages contain each other without bound there.
        """
        from rosetta_jit.runtime.batches.columns import column_of

        return self.lanes_.consistent(lambda path: column_of(self, path), name)

    def has(self, name: str) -> bool:
        """Whether a field is present: KeyError where there is none of that name."""
        lanes, row = place(self)
        return arena.present(lanes, paths.entry_of(self.access_.record, name).presence, row)

    def clear(self, name: str | None = None) -> None:
        """Make a field absent or empty; without a name, all of them."""
        clear(self, name)

    def which(self, union: str) -> str | None:
        """The name of the case of a union that is present."""
        return self.lanes_.consistent(lambda cases: _present_case(self, cases), self.access_.record.unions[union])

    def to_dict(self) -> dict[str, Any]:
        """Plain Python values of what is present, named as in the IDL: enums by their names, arrays as lists."""
        return plain(self)

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> Self:
        """A holder of plain values; the inverse of `to_dict`.

        Raises
        ------
        ValuesError
            If a name or a value is not one of the type; its path says which.
        """
        family = cls.family_
        holder = family.making.fresh()
        family.takers.take_plain(holder, plain)
        return holder

    def materialise(self) -> None:
        """Make the holder fit to be encoded, which it is unless it borrows; give back what it does not use."""
        settle(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Holder):
            return NotImplemented
        mine, its = self.access_, other.access_
        if mine is not its and mine.record.struct != its.record.struct:
            return NotImplemented
        can = mine.bind is not None and (mine is its or mine.kin is its.kin)
        answer = functions()["same"](self, other, mine.sameness, its.sameness) if can else None
        return equal(access.raw(self), access.raw(other)) if answer is None else answer

    __hash__ = None  # pyright: ignore[reportAssignmentType]  as of every mutable object

    def __repr__(self) -> str:
        name = type(self).__name__
        if not self.lanes_.words[VALID]:
            return f"<{name}: {'in use' if isinstance(self.lanes_.invalid(), InUse) else 'the last decode failed'}>"
        from rosetta_jit.runtime.looks.brief import brief_message

        return self.lanes_.consistent(brief_message, self)

    def _repr_html_(self) -> str:
        """What a notebook shows: a table of the fields, and images drawn."""
        from rosetta_jit.runtime.looks.page import page

        return self.lanes_.consistent(page, self)

    def picture_(self) -> NDArray[np.uint8] | bytes | None:
        """Pixels, or a compressed image, for who looks at the message; None of what is no image."""
        return None

    def __dir__(self) -> list[str]:
        return _listed(type(self), super().__dir__())

    def __copy__(self) -> Self:
        return self.__deepcopy__({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        if isinstance(self, View) or self.lanes_.source[0] is not None:
            return filled(cast("type[Self]", self.family_.holder)(), access.raw(self))
        holder_type = cast("type[Self]", self.family_.holder)
        holder = holder_type.__new__(holder_type)
        in_row(holder, self.lanes_.consistent(_copied, self), self.family_.root, 0)
        return holder

    def __reduce__(self) -> tuple[Any, ...]:
        if isinstance(self, View) or self.lanes_.source[0] is not None:
            return self.__deepcopy__({}).__reduce__()
        return self.family_.pickled(self.lanes_.consistent(_contents, self))


def _listed(holder_type: type[Holder], names: Iterable[str]) -> list[str]:
    """The attributes of a holder, or its class, that people see."""
    from rosetta_jit.runtime.looks.described import is_public

    family = getattr(holder_type, "family_", None)
    fields = () if family is None else family.tree.root.entries
    return [name for name in names if is_public(name, fields)]


def clear(holder: Holder, name: str | None) -> None:
    """Make a field absent or empty, or all of them; a holder whose decode failed becomes valid so."""
    record = holder.access_.record
    entries = record.entries.values() if name is None else [paths.entry_of(record, name)]
    with holder.lanes_:
        if name is None and not isinstance(holder, View):
            holder.lanes_.reset()
            return
        lanes, row = place(holder)
        if lanes is holder.lanes_:
            for entry in entries:
                arena.clear(lanes, entry, row)
            if name is None and record.unknown is not None:
                arena.replace(lanes, record.unknown, row, b"")


def filled(holder: _Holder, plain: Any) -> _Holder:
    """A new holder, when it has got raw values."""
    with holder.lanes_:
        values.write_record(holder.access_.record, holder.lanes_, 0, plain)
    return holder


def settle(holder: Holder) -> None:
    """`Holder.materialise`, where a field has taken that name. A view is encoded through a copy, and needs none."""
    if not isinstance(holder, View):
        with holder.lanes_:
            settle_lanes(holder)


def settle_lanes(holder: Holder) -> None:
    """The same inside ``with holder.lanes_:``."""
    lanes, _ = place(holder)
    if lanes.words[VALID] != CLEAN or lanes.source[0] is not None:
        values.settle(holder.family_.tree.root, lanes)


def _contents(holder: Holder) -> tuple[int, int, list[bytes]]:
    """Two words of the state, and the bytes of each lane."""
    from rosetta_jit.runtime.pickled_lanes import contents_of  # only pickles need it

    lanes, _ = place(holder)
    return lanes.words[VALID], lanes.words[WASTED], contents_of(lanes)


def _copied(holder: Holder) -> Lanes:
    lanes, _ = place(holder)
    return lanes.copied()


def plain(message: Message) -> dict[str, Any]:
    """Plain values of what is present in a message: of a holder, or of a part of one."""
    return message.lanes_.consistent(_plain, message)


def _plain(message: Message) -> dict[str, Any]:
    lanes, row = place(message)
    return values.read_record(message.access_.record, lanes, row, values.Form.PLAIN)


def _present_case(holder: Holder, cases: tuple[str, ...]) -> str | None:
    lanes, row = place(holder)
    entries = holder.access_.record.entries
    return next((case for case in cases if arena.present(lanes, entries[case].presence, row)), None)


def _shown(holder: Holder, entry: Entry) -> NDArray[Any]:
    lanes, row = place(holder)
    match entry.node:
        case Numbers(span, lane):
            start, count = arena.span_of(lanes, span, row)
            return lanes.arrays[lane][start : start + count].view(np.ndarray)
        case Items() as node if node.shape:
            return grid.view(node, lanes, row)
        case Text(span, lane) | Blob(span, lane):
            return np.frombuffer(arena.content(lanes, span, lane, row), lanes.plan.dtypes[lane])
        case _:
            raise TypeError(f"`{entry.name}` is no array of numbers, and no bytes")


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
