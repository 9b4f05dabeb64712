"""What every holder and every view into one is: lanes, a way to its row there, and the record that says what lies in the row.

A `Holder` has lanes of its own. A `View` shows a message in the lanes of a holder or a batch. It keeps the lanes alive, not the holder, so
that a holder may keep its views. Its row is looked for when it is read: by number, or as an element of the field ``entry_`` of another
view. A view of a message that is absent reads from empty lanes; writing to it brings the message into being.

The attributes that a class needs for itself end with an underscore, so that they do not stand in the way of fields.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, TypeVar

from rosetta_jit.errors import EncodeError, InvalidHolder
from rosetta_jit.kernel.state import ADDRESS, VALID, lane_word
from rosetta_jit.runtime.callable import ALWAYS, NEVER, bind_state, message_base
from rosetta_jit.runtime.holder import arena
from rosetta_jit.runtime.holder.record import Child, Items, Pairs
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.limits import MAX_DEPTH, MAX_ENDED, MAX_ENDED_BYTES
from rosetta_jit.runtime.memory import ALIGNMENT
from rosetta_jit.runtime.specs import slot_offset

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.access import Access
    from rosetta_jit.runtime.holder.record import Entry
    from rosetta_jit.runtime.plan import Plan

    Base = object
else:
    Base = message_base()

_Message = TypeVar("_Message", bound="Message")
_FIRST_LANE = 8 * lane_word(0, ADDRESS)


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


class View(Message):
    """A message in the lanes of another, or a row of a batch."""

    __slots__ = ()


def in_row(message: Message, lanes: Lanes, access: Access, row: int) -> bool:
    """Make a new message show a row of lane 0; False if it shows something already."""
    if access.bind is not None:
        return access.bind(message, lanes, access, None, None, lanes.address, row, ALWAYS, _FIRST_LANE, access.table, row, 0)
    if hasattr(message, "lanes_"):
        return False
    message.lanes_, message.access_, message.parent_, message.index_ = lanes, access, None, row
    bind_state(message, lanes.address)
    return True


def recipe(plan: Plan, array_type: type, access: Access, first: Plan | None = None) -> tuple[Any, ...]:
    """What a holder of a plan is made of in compiled code (`attributes/making.ll`), which does what `Lanes` and `in_row` do.

    Its memory begins as another plan says, if there is one.
    """
    begins = first or plan
    slots = (slot_offset(vars(Lanes)[name]) for name in ("arena", "plan", "array_type", "address", "is_filled", "rows", "spares"))
    words = struct.pack("=11q", plan.size_bytes + ALIGNMENT, plan.rows, _FIRST_LANE, access.table, *slots)
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
    """Where a message is to be read.

    Raises
    ------
    InvalidHolder
        If the last decode into its holder failed, or the message is an element that is gone.
    """
    lanes = message.lanes_
    if not lanes.words[VALID]:
        raise lanes.invalid()
    return (lanes, message.index_) if message.parent_ is None else _found(_chain(message))


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
