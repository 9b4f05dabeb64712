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

HOST, ON_DEMAND = "host", "on_demand"
"""What it defines besides, where it has that: the table of the host's functions, and the place for a kernel that is made on demand."""
