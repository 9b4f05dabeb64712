"""Loops over bools of which each is written behind its tag: every round appends one of two constants."""

from __future__ import annotations

import struct

from rosetta_jit.generate.python.printing.scope import CODES
from rosetta_jit.kernel.nodes import WIDTH, Assign, Call, Const, Convert, For, Get, Let, Place, Store
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Flags:
    """The bool of a round, and what is written where it is true and where it is not."""

    place: Place
    true: bytes
    false: bytes


def flags_of(loop: For) -> Flags | None:
    """What a loop writes, if each round is a tag and a bool as an integer of a byte."""
    tag, place = b"", None
    for stmt in loop.body:
        match stmt:
            case Store(_, Const(type_, value), order) if place is None and type_[0] == "u":
                tag += struct.pack(f"{'<' if WIDTH[type_] == 1 else order}{CODES[type_]}", int(value))
            case Call("write_varint", (_, Convert("u64", Get("bool", found)))) if place is None:
                place = found
            case Let() | Assign():
                pass
            case _:
                return None
    return None if place is None else Flags(place, tag + b"\1", tag + b"\0")
