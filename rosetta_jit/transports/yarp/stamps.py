"""Stamps: the envelopes in which YARP's programs say when a message was made, `sequence seconds`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rosetta_jit.transports.limits import MAX_STAMP_DIGITS


def stamp(sequence: int, time_ns: int) -> str:
    """The envelope of a message that was made at a moment; as YARP writes it, with 15 digits."""
    return f"{sequence & 0x7FFFFFFF} {time_ns / 1e9:.15g}"


def attributes_of(envelope: str, sender: str, carrier: str) -> tuple[int | None, Mapping[str, Any]]:
    """When a message with such an envelope was sent, in nanoseconds, where it is a stamp; and its attributes."""
    attributes: dict[str, Any] = {"sender": sender, "carrier": carrier}
    if not envelope:
        return None, attributes
    attributes["envelope"] = envelope
    sequence, _, seconds = envelope.partition(" ")
    if len(envelope) > MAX_STAMP_DIGITS + 12 or not sequence.isdecimal():
        return None, attributes
    whole, _, part = seconds.partition(".")
    if not (whole.isdecimal() and (part.isdecimal() or not part) and len(whole) < 12):
        return None, attributes
    attributes["sequence"] = int(sequence)
    return int(whole) * 10**9 + int(part[:9].ljust(9, "0")), attributes
