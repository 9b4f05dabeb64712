"""Generated Python, imported and asked: it answers as the drivers in C and C++ do."""

from __future__ import annotations

import sys
import types
from functools import lru_cache
from typing import Any

from rosetta_jit.generate.build import NO_WISHES, generated
from tests.generate.driver import expected

BOTH = ("decode", "encode")


def protobuf(body: str) -> dict[str, Any]:
    """Options for types of a schema."""
    return {"encoding": "protobuf", "schema": {"t.proto": f'syntax = "proto3"; package t; {body}'}}


@lru_cache(maxsize=16)
def source_of(request, directions=BOTH, wishes=NO_WISHES) -> str:
    """The source of the module for a request, which some tests read as well as run."""
    return generated(request, "python", directions, "unit", wishes)["unit.py"]


def module(request, directions=BOTH, wishes=NO_WISHES) -> Any:
    """The module that is generated for a request."""
    made = types.ModuleType("generated_unit")
    sys.modules[made.__name__] = made  # dataclasses look there for the names of types
    exec(compile(source_of(request, directions, wishes), "unit.py", "exec"), made.__dict__)  # noqa: S102 - what is under test
    return made


def answer(unit, message: bytes) -> str:
    """As the drivers in C and C++ say it."""
    try:
        return f"ok {unit.encode(unit.decode(message)).hex()}"
    except unit.MessageError as error:
        line = f" ({error.line})" if error.line else ""
        offset = "" if error.offset is None else f" {error.offset}"
        return f"{error.kind}{offset} [{error.path}] {error.detail}{line}"


def same(found: str, wanted: str) -> bool:
    """A signalling NaN of 32 bits becomes a quiet one in Python's floats, and one that is computed may have another sign: that is all."""
    if "memory than its size allows" in found:
        return found.split("]", maxsplit=1)[0] == wanted.split("]", maxsplit=1)[0]
    if found == wanted or not (found.startswith("ok ") and wanted.startswith("ok ") and len(found) == len(wanted)):
        return found == wanted
    one, other = bytes.fromhex(found[3:]), bytes.fromhex(wanted[3:])
    changes = [at for at, (a, b) in enumerate(zip(one, other, strict=True)) if a != b]
    return all(is_quieted(one, other, at) or (one[at] ^ other[at] == 0x80 and ends_nan(one, at)) for at in changes)


def is_quieted(found: bytes, wanted: bytes, at: int) -> bool:
    """Whether a byte is the second of a NaN of 32 bits, in either byte order, that was signalling, and is the same but quiet."""
    if found[at] != wanted[at] | 0x40 or not found[at] & 0x80:
        return False
    places = ((range(at - 2, at), at + 1), (range(at + 1, at + 3), at - 1))
    return any(
        0 <= min(first, *rest) <= max(first, *rest) < len(found)
        and found[first] & 0x7F == 0x7F
        and (wanted[at] & 0x3F or any(wanted[each] for each in rest))
        for rest, first in places
    )


def ends_nan(message: bytes, at: int) -> bool:
    """Whether a byte can be the first of a NaN in either byte order: seven bits of its exponent are set, and the eighth beside them."""
    return message[at] & 0x7F == 0x7F and any(each >= 0x80 for each in (*message[max(0, at - 1) : at], *message[at + 1 : at + 2]))


def answers_as_the_library(unit, programs, messages) -> None:
    for message in messages:
        found, wanted = answer(unit, message), expected(*programs, message)
        assert same(found, wanted), (message.hex(), found, wanted)
