"""What every holder and every view into one is: lanes, a row, and the record that says what lies there.

A `Holder` is row 0 of its own lanes. A `View` is a nested message: it knows its parent, and finds its row through it again when rows
have moved. A view of a message that is absent reads from empty lanes; writing to it brings the message into being. Views do not outlive
the next decode into their holder.

The attributes that a class needs for itself end with an underscore, so that they do not stand in the way of fields.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import EncodeError, InvalidHolder
from rosetta_jit.kernel.state import VALID
from rosetta_jit.runtime.holder import arena
from rosetta_jit.runtime.holder.record import Child, Items, Pairs
from rosetta_jit.runtime.holder.values import MAX_DEPTH

if TYPE_CHECKING:
    from rosetta_jit.runtime.holder.access import Access
    from rosetta_jit.runtime.holder.record import Entry
    from rosetta_jit.runtime.lanes import Lanes

OWN_SLOTS = ("lanes_", "row_", "home_", "__weakref__")
VIEW_SLOTS = ("access_", "parent_", "entry_", "index_", "seen_")


class Message:
    """A message in lanes.

    Attributes
    ----------
    lanes_ : Lanes
        Where it is read.
    row_ : int
        Its row.
    home_ : Lanes
        Where it is written; not where it is read while it is absent.
    access_ : Access
        How its fields are read and written.
    """

    __slots__ = ()

    if TYPE_CHECKING:
        lanes_: Lanes
        row_: int
        home_: Lanes
        access_: Access


class View(Message):
    """A message inside another, or one row of a batch (without a parent).

    Attributes
    ----------
    entry_ : Entry or None
        The field of the parent through which its row is found; None where it lies in the parent's own row.
    index_ : int
        Which element of that field it is.
    seen_ : int
        `Lanes.moves` when it was found.
    """

    __slots__ = ()

    if TYPE_CHECKING:
        parent_: Message | None
        entry_: Entry | None
        index_: int
        seen_: int


def bind(view: View, parent: Message, access: Access, entry: Entry | None = None, index: int = 0) -> View:
    """Make a new view show a message inside another."""
    view.parent_, view.home_, view.access_, view.entry_, view.index_ = parent, parent.home_, access, entry, index
    _find(view, parent)
    return view


def bind_row(view: View, lanes: Lanes, access: Access, row: int) -> View:
    """Make a new view show a row of lane 0."""
    view.parent_, view.access_, view.entry_, view.index_ = None, access, None, row
    view.lanes_ = view.home_ = lanes
    view.row_, view.seen_ = row, lanes.moves
    return view


def place(message: Message) -> tuple[Lanes, int]:
    """Where a message is to be read.

    Raises
    ------
    InvalidHolder
        If the last decode into its holder failed, or the message is an element that is gone.
    """
    if isinstance(message, View) and message.seen_ != message.home_.moves:
        locate(message)
    lanes = message.lanes_
    if not lanes.words[VALID]:
        raise lanes.invalid()
    return lanes, message.row_


def locate(view: View) -> None:
    """Find the row of a view again, and those of the views above it."""
    for each in _chain(view):
        if each.parent_ is not None and each.seen_ != each.home_.moves:
            _find(each, each.parent_)
        each.seen_ = each.home_.moves


def make_present(message: Message) -> None:
    """Let a message and all around it be present, as by an assignment to one of its fields."""
    with message.home_:
        writable(message)


def writable(message: Message) -> tuple[Lanes, int]:
    """Where a message is to be written, inside ``with message.home_:``; it and all around it are present from now on.

    Raises
    ------
    InvalidHolder
        As `place` does.
    EncodeError
        If messages would contain each other too deep.
    """
    if isinstance(message, View):
        chain = _chain(message)
        if len(chain) > MAX_DEPTH:
            raise EncodeError("nesting", "", f"messages contain each other more than {MAX_DEPTH} deep")
        for each in chain:
            _make_present(each)
    return place(message)


def _chain(view: View) -> list[View]:
    """The view and those above it, the outermost first."""
    chain = [view]
    while isinstance(parent := chain[-1].parent_, View):
        chain.append(parent)
    return chain[::-1]


def _make_present(view: View) -> None:
    parent, home = view.parent_, view.home_
    if parent is not None:
        _find(view, parent)
        if view.lanes_ is not home and view.entry_ is not None:
            node = view.entry_.node
            assert isinstance(node, Child)
            arena.mark(home, view.entry_.presence, parent.row_)
            arena.resize(home, node, parent.row_, 1)
            home.moves += 1
            _find(view, parent)
    for presence in view.access_.record.touch:
        arena.mark(home, presence, view.row_)


def _find(view: View, parent: Message) -> None:
    """The row of a view, from its parent's."""
    view.seen_ = view.home_.moves
    view.lanes_, view.row_ = parent.lanes_, parent.row_
    if view.entry_ is None:
        return
    node = view.entry_.node
    assert isinstance(node, Child | Items | Pairs)
    start, count = arena.span_of(parent.lanes_, node.span, parent.row_)
    if view.index_ < count:
        view.row_ = start + view.index_
    elif isinstance(node, Child):
        view.lanes_, view.row_ = view.access_.empty_lanes(), 0
    else:
        raise InvalidHolder("the element that was here is gone")


def stale_getter(name: str) -> Any:
    """The getter of a view's property: that of its record, when it has found its row."""

    def get(view: View) -> Any:
        if view.seen_ != view.home_.moves:
            locate(view)
        return view.access_.getters[name](view)

    return get


def view_setter(name: str) -> Any:
    """The setter of a view's property: that of its record."""

    def set_(view: View, value: Any) -> None:
        view.access_.setters[name](view, value)

    return set_
