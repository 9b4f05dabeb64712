"""Codecs that reach recursive structs, and the sizes around those."""

from __future__ import annotations

from rosetta_jit.wire.codec import Cases, Codec, Delimited, Maybe, Members, Parameter, Parameters, Recursion, Repeat, Seq

MAX_OPEN_SIZES = 3
"""So many sizes can be around a recursive struct within another; the message itself may have more."""


def recurses(codec: Codec) -> bool:
    """Whether a codec that is not tagged reaches a recursive struct."""
    match codec:
        case Recursion():
            return True
        case Seq(items):
            return any(recurses(each) for each in items)
        case Repeat(_, _, item):
            return recurses(item)
        case Cases(_, _, cases):
            return any(recurses(each) for _, each in cases)
        case Maybe(_, value) | Delimited(_, value):
            return recurses(value)
        case Parameter(member):
            return recurses(member.value)
        case Members(_, members) | Parameters(_, members):
            return any(recurses(each.value) for each in members)
        case _:
            return False


def open_sizes(codec: Codec) -> int:
    """How many sizes there are at most around a recursive struct, within a codec that reaches one."""
    match codec:
        case _ if not recurses(codec):
            return 0
        case Seq(items):
            return max(map(open_sizes, items))
        case Repeat(_, _, item):
            return open_sizes(item)
        case Cases(_, _, cases):
            return max(open_sizes(each) for _, each in cases)
        case Maybe(_, value):
            return open_sizes(value)
        case Delimited(_, value):
            return 1 + open_sizes(value)
        case _:
            return 0
