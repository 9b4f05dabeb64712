"""What fields are called in JSON where they choose no name."""

from __future__ import annotations


def camel_case(name: str) -> str:
    """The name that protoc gives: `frame_shift` is `frameShift`."""
    first, *rest = name.split("_")
    return first + "".join(part[:1].upper() + part[1:] for part in rest)
