"""Unions whose case a discriminator tells: objects have the discriminator and the value as two attributes, of whichever case it is."""

from __future__ import annotations

from typing import Any

from rosetta_jit.errors import ValuesError
from rosetta_jit.runtime.holder.record import Case, Choice, Entry, Record, Scalar

ATTRIBUTES = (("discriminator", "value"), ("_d", "_v"))
"""What they are called: by Cyclone DDS, and in CORBA's mapping to Python."""


def discriminator_of(record: Record) -> tuple[Entry, Choice] | None:
    """The field that tells the case of a record that is such a union; None of any other."""
    for entry in record.entries.values():
        node = entry.node
        if (
            isinstance(node, Scalar)
            and node.choice is not None
            and all(_is_case(each) for each in record.entries.values() if each is not entry)
        ):
            return entry, node.choice
    return None


def _is_case(entry: Entry) -> bool:
    return isinstance(entry.presence, Case)


def case_of(record: Record, choice: Choice, discriminator: Any) -> Entry | None:
    """The case that a discriminator selects, if it selects one."""
    number = choice.selected(int(discriminator))
    return next((each for each in record.entries.values() if isinstance(each.presence, Case) and each.presence.number == number), None)


def parts_of(value: object, path: str) -> tuple[Any, Any]:
    """Discriminator and value of an object; raises ValuesError if it has no such attributes."""
    for discriminator, case in ATTRIBUTES:
        if hasattr(value, discriminator) and hasattr(value, case):
            return getattr(value, discriminator), getattr(value, case)
    raise ValuesError(path, f"{type(value).__name__} has no attributes 'discriminator' and 'value'")


def made(object_type: Any, discriminator: Any, value: Any) -> Any:
    """A new object of a union's class: of Cyclone DDS's by names, of another by the order in which CORBA's mapping has them."""
    names, _ = ATTRIBUTES
    if all(hasattr(object_type, name) for name in names):
        return object_type(**dict(zip(names, (discriminator, value), strict=True)))
    return object_type(discriminator, value)
