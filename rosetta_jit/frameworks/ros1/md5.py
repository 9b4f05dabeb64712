"""The sum by which ROS 1 tells versions of a message or a service apart.

https://wiki.ros.org/ROS/Technical%20Overview, and genmsg's ``compute_md5``. It is of the declarations without comments and blanks,
constants first, with the sum of a message in place of its name.
"""

from __future__ import annotations

from hashlib import md5
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rosetta_jit.frameworks.ros import Definition, Field


def md5_sums(definitions: Iterable[Definition]) -> dict[str, str]:
    """The sums of messages, of which each comes after those that it contains, by name."""
    sums: dict[str, str] = {}
    for definition in definitions:
        sums[definition.name] = md5(hashed_text(definition, sums).encode(), usedforsecurity=False).hexdigest()
    return sums


def service_sums(definitions: Iterable[Definition], sums: Mapping[str, str]) -> dict[str, str]:
    """The sum of the service in a file, under the names of its request and its response; theirs are of their own texts alone."""
    halves = sorted((each for each in definitions if each.source.name.endswith(".srv")), key=lambda each: each.name)  # the request first
    text = "".join(hashed_text(each, sums) for each in halves)
    return dict.fromkeys((each.name for each in halves), md5(text.encode(), usedforsecurity=False).hexdigest())


def hashed_text(definition: Definition, sums: Mapping[str, str]) -> str:
    """What is hashed of a message; an array of messages counts as one of them."""
    constants = (f"{each.type.written} {each.name.text}={each.text.text}" for each in definition.constants)
    return "\n".join([*constants, *(_declaration(each, sums) for each in definition.fields)])


def _declaration(field: Field, sums: Mapping[str, str]) -> str:
    return f"{field.type.written if field.type.builtin else sums[field.type.base]} {field.name.text}"
