"""What a person writes in Python for a message that is one array of doubles: struct, or a view by numpy. Neither checks anything."""

from __future__ import annotations

import struct
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from bench.peers.base import Peer

if TYPE_CHECKING:
    from bench.subjects import Subject

_BEGINS = {"lcm": (20, ">"), "cdr-giop": (16, "<"), "rtt-mqueue": (8, "<")}
"""Encoding → where the doubles begin in the messages that are measured, and their byte order."""


def peers(subject: Subject) -> tuple[Peer, ...]:
    begin, order = _BEGINS.get(subject.encoding, (3, "<"))
    if subject.encoding not in _BEGINS and subject.type != "rj.PackedJointAngles":
        return ()
    unpack_from = struct.Struct(f"{order}{(len(subject.message) - begin) // 8}d").unpack_from
    type_ = np.dtype(f"{order}f8")
    return (
        Peer("struct by hand, unchecked", "a tuple, anew", partial(unpack_from, offset=begin)),
        Peer("numpy.frombuffer, unchecked", "a view of the message", partial(np.frombuffer, dtype=type_, offset=begin)),
        Peer(
            "numpy.frombuffer and astype, unchecked",
            "an array, anew",
            lambda message: np.frombuffer(message, type_, offset=begin).astype(np.float64),
        ),
    )
