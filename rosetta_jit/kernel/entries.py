"""What a program's object code defines: its kernels, and the entries from CPython that stand around them (`backends/entry/*.ll`)."""

from __future__ import annotations

from typing import Literal

EntryName = Literal["decode", "borrow", "encode", "bridge"]

SYMBOLS: dict[EntryName, tuple[str, ...]] = {
    "decode": ("kernel", "call", "many"),
    "borrow": ("kernel", "call", "many"),
    "encode": ("kernel", "size", "call", "many", "sizes"),
    "bridge": ("kernel", "size", "write", "call", "many"),
}
"""By entry, what the object code defines for others; everything else in it is private."""

HOST, ON_DEMAND, REST, NEXT = "host", "on_demand", "rest", "next"
"""What it defines besides, where it has that: the table of the host's functions, and the places for a kernel that is made on demand, for
the rest of the calls, and for the next call."""

NEXT_KERNEL, NEXT_CALL = "kernel.next", "call_of_next"
"""Of a kernel whose first body is a part of the usual call, the bodies behind it, and what goes on with a call that is left to them."""

ANY_CALL = "any_call"
"""The first function of the rest, which may be code of its own (`backends.entry.texts`): what the usual call leaves to it."""

LATER = ("many", "sizes")
"""What the rest has besides."""
