"""A mapping file whose name says another type than the mapping: most likely a copy that was not changed everywhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import PurePath

from rosetta_jit.catalogue import mapping as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.limits import MAX_NAME
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.model.types import Schema, Struct, name_parts

QUALIFIED = r"[A-Za-z][A-Za-z0-9_]*(?:\.[A-Za-z][A-Za-z0-9_]*)+"
LETTERS = frozenset("abcdefghijklmnopqrstuvwxyz0123456789")


def misnamed(mapping: Mapping, schema: Schema) -> Iterator[Diagnostic]:
    """A warning where the name of the file is, or has in it, the name of a type that is neither side's."""
    stem = PurePath(mapping.source.name).name.removesuffix(".mapping")[:MAX_NAME]
    mine = [name_parts(each) for each in (mapping.holder_type, mapping.wire_type, *(wire.type for wire in mapping.wires))]
    for qualified in re.findall(QUALIFIED, stem) if "." in stem else ():
        parts = name_parts(qualified)
        if not any(_plain(parts) == _plain(own[-len(parts) :]) for own in mine):
            yield words.misnamed(mapping.holder_span, qualified, mapping.holder_type, mapping.wire_type)
            return
    declared = {_plain(name_parts(name)[-1:]): name for name, type_ in schema.types.items() if isinstance(type_, Struct) and name}
    other = declared.get(_plain((stem,)))
    if other is not None and _plain((stem,)) not in {_plain(own[-1:]) for own in mine}:
        yield words.misnamed(mapping.holder_span, other, mapping.holder_type, mapping.wire_type)


def _plain(parts: tuple[str, ...]) -> str:
    """A name without what files write differently: `joint_angles` and `JointAngles` are one."""
    return ".".join("".join(filter(LETTERS.__contains__, part.lower())) for part in parts)
