"""What can be wrong with a recording."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic


def cut(name: str, index: int) -> Diagnostic:
    """The file ends within a message."""
    return Diagnostic("error", "recording-cut", f"{name}: message {index} is cut short", help="the messages before it are whole")


def too_long(name: str, index: int, size_bytes: int, limit_bytes: int) -> Diagnostic:
    """A length that no message of a robot has."""
    return Diagnostic(
        "error",
        "recording-length",
        f"{name}: message {index} promises {size_bytes} bytes, more than the limit of {limit_bytes}",
        help="is it a recording? It is a sequence of: float64 time, uint32 length, that many bytes",
    )


def damaged(name: str, reason: str) -> Diagnostic:
    """Not what xz wrote."""
    return Diagnostic("error", "recording-damaged", f"{name}: {reason}", help="the messages before the damage were read")
