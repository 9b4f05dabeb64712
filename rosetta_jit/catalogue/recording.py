"""What can be wrong with a recording."""

from __future__ import annotations

from rosetta_jit.diagnostics import Diagnostic, error


def cut(name: str, index: int) -> Diagnostic:
    return error("recording-cut", f"{name}: message {index} is cut short", help_="the messages before it are whole")


def too_long(name: str, index: int, size_bytes: int, limit_bytes: int) -> Diagnostic:
    return error(
        "recording-length",
        f"{name}: message {index} promises {size_bytes} bytes, more than the limit of {limit_bytes}",
        help_="is it a recording? It is a sequence of: float64 time, uint32 length, that many bytes",
    )


def too_large(name: str, limit_bytes: int) -> Diagnostic:
    return error("file-too-large", f"{name} is larger than {limit_bytes >> 20} MiB", help_="several messages are a recording")


def no_recording(name: str) -> Diagnostic:
    return error("file-unreadable", f"{name} is no file", help_="recordings are files that end")


def unreadable(name: str, why: str) -> Diagnostic:
    return error("file-unreadable", f"{name} cannot be read: {why}")


def damaged(name: str, reason: str) -> Diagnostic:
    return error("recording-damaged", f"{name}: {reason}", help_="the messages before the damage were read")
