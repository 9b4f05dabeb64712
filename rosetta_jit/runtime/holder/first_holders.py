"""The first holders of a type, made in Python: to compile what makes them takes as long as to make some hundred so."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.runtime.callable import ALWAYS, STATE
from rosetta_jit.runtime.holder.message import FIRST_LANE, Access, Message, shows_something
from rosetta_jit.runtime.holder.record import Record
from rosetta_jit.runtime.lanes import Lanes
from rosetta_jit.runtime.type_specs import put_reference, write_words

SLOTS = ("lanes_", "access_", "parent_", "entry_")


def begin_in_python(message: Message, lanes: Lanes, access: Access) -> bool:
    """Make a new message show the first row of lane 0, as `in_row` does; False if it shows something already.

    All is put where it belongs without the attributes of the message, which are compiled code of its class.
    """
    if shows_something(message):
        return False
    for name, value in zip(SLOTS, (lanes, access, None, None), strict=True):
        vars(Message)[name].__set__(message, value)
    write_words(id(message) + STATE, lanes.address, 0, ALWAYS, FIRST_LANE, access.table, 0, 0)
    for record, offset in _members(access):
        view_class = access.family.view_class(record.struct)
        view = view_class.__new__(view_class)
        begin_in_python(view, lanes, access.family.access(record))
        put_reference(message, offset, view)
    return True


def _members(access: Access) -> Iterator[tuple[Record, int]]:
    """The records that a message shows from the start, and where in it the views of these are kept."""
    kept = access.family.kept_of(access.record.struct)
    assert kept is not None, "there are accessors"
    for name in kept.members:
        node = access.record.entries[name].node
        assert isinstance(node, Record), "members are messages"
        yield node, kept.offsets[name]
