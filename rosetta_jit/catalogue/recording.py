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


def too_large(name: str, limit_bytes: int) -> Diagnostic:
    """A file that is larger than any message, or has no end."""
    return Diagnostic("error", "file-too-large", f"{name} is larger than {limit_bytes >> 20} MiB", help="several messages are a recording")


def no_recording(name: str) -> Diagnostic:
    """A folder, a device or a pipe."""
    return Diagnostic("error", "file-unreadable", f"{name} is no file", help="recordings are files that end")


def unreadable(name: str, why: str) -> Diagnostic:
    """A file that the system does not let us read."""
    return Diagnostic("error", "file-unreadable", f"{name} cannot be read: {why}")


def damaged(name: str, reason: str) -> Diagnostic:
    """Not what xz wrote."""
    return Diagnostic("error", "recording-damaged", f"{name}: {reason}", help="the messages before the damage were read")
