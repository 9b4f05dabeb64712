"""Which type a fingerprint is of: LCM's logs tell no types, but each message begins with the fingerprint of its own."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm.fingerprint import fingerprint
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.frameworks.lcm.limits import MAX_FILES
from rosetta_jit.model.types import Struct

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from rosetta_jit.parsing.idl import Load


def type_of(wanted: int, folders: Iterable[Path], load: Load) -> tuple[str, str] | None:
    """The type with a fingerprint, and the file that declares it, of all `.lcm` files in some folders; None if there is none."""
    seen = 0
    for folder in folders:
        for path in sorted(folder.rglob("*.lcm")):
            seen += 1
            if seen > MAX_FILES:
                return None
            name = path.relative_to(folder).as_posix()
            source = load(name)
            if source is None:
                continue
            with suppress(SchemaError):  # what is wrong with a file is said when somebody wants it
                schema = parse(source, load)
                structs = [each for each in schema.types.values() if isinstance(each, Struct)]
                found = next((each.name for each in structs if fingerprint(each, schema) == wanted), None)
                if found is not None:
                    return found, name
    return None
