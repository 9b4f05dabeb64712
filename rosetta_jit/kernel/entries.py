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

HOST, ON_DEMAND, REST = "host", "on_demand", "rest"
"""What it defines besides, where it has that: the table of the host's functions, and the places for a kernel that is made on demand, and
for the rest of the calls."""

ANY_CALL = "any_call"
"""The first function of the rest, which may be code of its own (`backends.entry.texts`): what the usual call leaves to it."""

LATER = ("many", "sizes")
"""What the rest has besides."""
