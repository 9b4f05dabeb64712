"""What every holder and every view into one is: lanes, a way to its row there, and the record that says what lies in the row.

A `Holder` has lanes of its own. A `View` shows a message in the lanes of a holder or a batch. It keeps the lanes alive, not the holder, so
that a holder may keep its views. Its row is looked for when it is read: by number, or as an element of the field ``entry_`` of another
view. A view of a message that is absent reads from empty lanes; writing to it brings the message into being.

The attributes that a class needs for itself end with an underscore, so that they do not stand in the way of fields.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from rosetta_jit.errors import EncodeError, InvalidHolder
from rosetta_jit.kernel.state import ADDRESS, VALID, lane_word
from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.runtime.attributes.code import functions, library
from rosetta_jit.runtime.attributes.field_table import PLACE_BYTES, FieldTable, KeptFields, OfSequences
from rosetta_jit.runtime.callable import ALWAYS, NEVER, bind_state, message_base
from rosetta_jit.runtime.holder.record import Child, Entry, Items, Pairs, Record
from rosetta_jit.runtime.holder.tree import Tree
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_DEPTH, MAX_ENDED, MAX_ENDED_BYTES
from rosetta_jit.runtime.memory import ALIGNMENT
from rosetta_jit.runtime.memory_plan import Plan
from rosetta_jit.runtime.type_specs import slot_offset
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    import numpy as np

    from rosetta_jit.runtime.attributes.sameness import Sameness
    from rosetta_jit.runtime.holder import arena

    Base = object
else:
    arena = Late("rosetta_jit.runtime.holder.arena")
    Base = message_base()

_Message = TypeVar("_Message", bound="Message")
FIRST_LANE = 8 * lane_word(0, ADDRESS)


Getter = Callable[[Any], Any]
Setter = Callable[[Any, Any], None]


class Message(Base):
    """A message in lanes.

    Attributes
    ----------
    lanes_ : Lanes
        Those of the holder or batch. It is read from others while it is absent.
    access_ : Access
        How its fields are read and written.
    parent_ : View or None
        The view of which it is an element, or in an element; None in row ``index_`` of lane 0.
    entry_ : Entry
        The field of the parent through which its row is found.
    index_ : int
        Which element of that field it is, or is in.
    """

    __slots__ = ("__weakref__", "access_", "entry_", "lanes_", "parent_")

    if TYPE_CHECKING:
        lanes_: Lanes
        access_: Access
        parent_: View | None
        entry_: Entry
        index_: int


OWN_NAMES = (*(name for name in Message.__slots__ if name != "__weakref__"), "index_")
_LANES_SLOT: Any = vars(Message)["lanes_"]


class View(Message):
    """A message in the lanes of another, or a row of a batch."""

    __slots__ = ()


class Family(Protocol):
    """What the accessors of one holder class share; `rosetta_jit.runtime.holder.Family` is it."""

    @property
    def struct(self) -> Struct: ...
    @property
    def schema(self) -> Schema: ...
    @property
    def tree(self) -> Tree: ...
    @property
    def array_type(self) -> type[np.ndarray[Any, Any]]: ...
    @property
    def sequence(self) -> Callable[[View, Entry], Any]: ...
    @property
    def mapping(self) -> Callable[[View, Entry], Any]: ...
    @property
    def assigns_whole(self) -> bool: ...
    def access(self, record: Record) -> Access: ...
    @property
    def sameness(self) -> Sameness: ...
    def view_class(self, struct: str) -> type[View]: ...
    def of_struct(self, struct: str) -> Any: ...
    def empty_lanes(self) -> Lanes: ...
    @property
    def sequences(self) -> OfSequences: ...
    def kept_of(self, struct: str) -> KeptFields | None:
        """Where messages of a struct keep what shows their fields; None where no compiled code reads them."""
        ...


class Ways(Protocol):
    """What makes accessors; `rosetta_jit.runtime.holder.access` is it."""

    def getter(self, entry: Entry, family: Family) -> Getter: ...
    def setter(self, entry: Entry, family: Family) -> Setter: ...


class Access:
    """How the fields of one record are read and written; each accessor is made when first used."""

    __slots__ = ("_kin", "_numbers", "_places", "_sameness", "bind", "family", "getters", "is_readable", "record", "setters", "table")

    def __init__(self, record: Record, family: Family, ways: Ways) -> None:
        self.record = record
        self.family = family
        self.getters = _Made(lambda name: ways.getter(record.entries[name], family))
        self.setters = _Made(lambda name: ways.setter(record.entries[name], family))
        kept = family.kept_of(record.struct)
        self._places = None if kept is None else FieldTable(record, self._read, write_field, kept, lambda: family.sequences)
        self._numbers = {name: number for number, name in enumerate(record.entries)}
        for name in kept.members if kept is not None else ():
            self._show(name)
        self.table = 0 if self._places is None else self._places.address
        """Address of what compiled accessors know of the record's fields; 0 where there are none."""
        compiled = None if library() is None else functions()
        self.bind = None if compiled is None else compiled["bind"]
        """What tells them where a message lies."""
        self.is_readable = None if compiled is None else compiled["is_readable"]
        """What asks them whether there is something that a message shows."""
        self._sameness = 0
        self._kin: Any = None

    @property
    def sameness(self) -> int:
        """Address of the program that compares messages of the record."""
        if not self._sameness:
            self._sameness = self.family.sameness.program(self.record)
        return self._sameness

    @property
    def kin(self) -> Any:
        """The family of the record's own holders: messages of one type have the same, whatever they are parts of."""
        if self._kin is None:
            self._kin = self.family.of_struct(self.record.struct).family_
        return self._kin

    def place_of(self, name: str) -> int:
        """The address of the words about one field."""
        return self.table and self.table + PLACE_BYTES * self._numbers[name]

    def _read(self, name: str) -> Getter:
        """What compiled accessors ask for a field. From then on they know what its value is shown as."""
        return read_field(name) if _shown(self.record.entries[name]) is None else lambda message: message.access_.read_first(message, name)

    def read_first(self, message: Message, name: str) -> Any:
        """Read a field whose value, or elements, are shown by views; compiled accessors make them from now on."""
        self._show(name)
        return self.getters[name](message)

    def _show(self, name: str) -> None:
        shown = _shown(self.record.entries[name])
        if shown is not None and self._places is not None:
            inner = self.family.access(shown)
            self._places.show(self._numbers[name], self.family.view_class(shown.struct), inner, inner.table)

    def empty_lanes(self) -> Lanes:
        """Lanes of the same layout in which everything is absent."""
        return self.family.empty_lanes()


def _shown(entry: Entry) -> Record | None:
    """The record that the views show which a field, or its elements, are read as."""
    match entry.node:
        case Record() as record:
            return record
        case Items(element=Record() as record):
            return record
        case _:
            return None


class _Made(dict[str, Any]):
    """A dict that makes what it lacks."""

    __slots__ = ("make",)

    def __init__(self, make: Callable[[str], Any]) -> None:
        self.make = make

    def __missing__(self, name: str) -> Any:
        self[name] = made = self.make(name)
        return made


def read_field(name: str) -> Getter:
    """Read a field of a message, by the getter of the message's own record; properties call it."""
    return lambda message: message.access_.getters[name](message)


def write_field(name: str) -> Setter:
    """Assign to a field of a message, by the setter of its record."""
    return lambda message, value: message.access_.setters[name](message, value)


def in_row(message: Message, lanes: Lanes, access: Access, row: int) -> bool:
    """Make a new message show a row of lane 0; False if it shows something already."""
    if access.bind is not None:
        return access.bind(message, lanes, access, None, None, lanes.address, row, ALWAYS, FIRST_LANE, access.table, row, 0)
    if shows_something(message):
        return False
    message.lanes_, message.access_, message.parent_, message.index_ = lanes, access, None, row
    bind_state(message, lanes.address)
    return True


def shows_something(message: Message) -> bool:
    """Whether a message has lanes. A user's class may give any attribute that is missing (`__getattr__`), so the slot itself is read."""
    try:
        _LANES_SLOT.__get__(message)
    except AttributeError:
        return False
    return True


def recipe(plan: Plan, array_type: type, access: Access, first: Plan | None = None) -> tuple[Any, ...]:
    """What a holder of a plan is made of in compiled code (`attributes/holders/making.ll`), which does what `Lanes` and `in_row` do.

    Its memory begins as another plan says, if there is one.
    """
    begins = first or plan
    slots = (slot_offset(vars(Lanes)[name]) for name in ("arena", "plan", "array_type", "address", "is_filled", "rows", "spares"))
    words = struct.pack("=11q", plan.size_bytes + ALIGNMENT, plan.rows, FIRST_LANE, access.table, *slots)
    spares = [None] * MAX_ENDED if plan.fresh and plan.size_bytes <= MAX_ENDED_BYTES else None
    return Lanes, plan, array_type, access, begins.begin, plan.places, words, begins.fresh, spares


def beside(view: _Message, message: Message, access: Access) -> _Message:
    """Make a new view show another record in the row of a message, or the message's own."""
    if message.parent_ is None:
        in_row(view, message.lanes_, access, message.index_)
        return view
    return element(view, message.parent_, access, message.entry_, message.index_)


def element(view: _Message, parent: View, access: Access, entry: Entry, index: int) -> _Message:
    """Make a new view show an element of a field of another view."""
    lanes, node, bound = parent.lanes_, entry.node, access.bind
    assert isinstance(node, Child | Items | Pairs)
    if bound is None:
        view.lanes_, view.access_, view.parent_, view.entry_, view.index_ = lanes, access, parent, entry, index
    else:
        lane = 8 * lane_word(node.lane, ADDRESS)
        bound(view, lanes, access, parent, entry, lanes.address, 0, NEVER, lane, access.table, index, 8 * node.span.index)
    return view


def place(message: Message) -> tuple[Lanes, int]:
    """The lanes and the row at which a message is read.

    Raises
    ------
    InvalidHolder
        If the last decode into its holder failed, or the message is an element that is gone.
    """
    lanes = message.lanes_
    if not lanes.words[VALID]:
        raise lanes.invalid()
    return (lanes, message.index_) if message.parent_ is None else _found(_chain(message))


def check_readable(message: Message) -> None:
    """See that a message can be read, without making what `place` needs of new lanes; raise what `place` does where it cannot."""
    is_readable = message.access_.is_readable
    if is_readable is None or not is_readable(message):
        place(message)


def make_present(message: Message) -> None:
    """Let a message and all around it be present, as by an assignment to one of its fields."""
    with message.lanes_:
        writable(message)


def writable(message: Message) -> tuple[Lanes, int]:
    """Where a message is to be written, inside ``with message.lanes_:``; it and all around it are present from now on.

    Raises
    ------
    InvalidHolder
        As `place` does.
    EncodeError
        If messages would contain each other too deep.
    """
    lanes = message.lanes_
    if not lanes.words[VALID]:
        raise lanes.invalid()
    chain = _chain(message)
    if len(chain) > MAX_DEPTH:
        raise EncodeError("nesting", "", f"messages contain each other more than {MAX_DEPTH} deep")
    row = -1
    for each in chain:
        row = _row(each, lanes, row, make=True)
        for presence in each.access_.record.touch:
            arena.mark(lanes, presence, row)
    return lanes, row


def known_rows(message: Message) -> list[tuple[int, int]]:
    """Lanes and rows of a message and of those around it, as far as they are there; inside ``with message.lanes_:``.

    Raises
    ------
    InvalidHolder
        As `place` does.
    """
    lanes = message.lanes_
    if not lanes.words[VALID]:
        raise lanes.invalid()
    found: list[tuple[int, int]] = []
    row = -1
    for each in _chain(message):
        row = _row(each, lanes, row, make=False)
        if row < 0:
            break
        found.append((each.access_.record.lane, row))
    return found


def _chain(message: Message) -> list[Message]:
    """The message and those through which its row is found, the outermost first."""
    chain = [message]
    while (parent := chain[-1].parent_) is not None:
        chain.append(parent)
    return chain[::-1]


def _found(chain: list[Message]) -> tuple[Lanes, int]:
    lanes, row = chain[0].lanes_, -1
    for each in chain:
        row = _row(each, lanes, row, make=False)
        if row < 0:
            lanes, row = each.access_.empty_lanes(), 0
    return lanes, row


def _row(message: Message, lanes: Lanes, row: int, *, make: bool) -> int:
    """The row of a message, from its parent's; -1 of a message that is absent and is not to be made."""
    if message.parent_ is None:
        return message.index_
    entry = message.entry_
    node = entry.node
    assert isinstance(node, Child | Items | Pairs)
    start, count = arena.span_of(lanes, node.span, row)
    if message.index_ < count:
        return start + message.index_
    if not isinstance(node, Child):
        raise InvalidHolder("the element that was here is gone")
    if not make:
        return -1
    arena.mark(lanes, entry.presence, row)
    return arena.resize(lanes, node, row, 1)
