"""The front end of LCM: a `.lcm` file and those that it leads to, to a schema."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm import diagnostics as say
from rosetta_jit.frameworks.lcm.files import gather
from rosetta_jit.frameworks.lcm.fingerprint import fingerprint
from rosetta_jit.frameworks.lcm.limits import MAX_FILES, MAX_PROBLEMS
from rosetta_jit.frameworks.lcm.schema import schema_of
from rosetta_jit.model.types import Array, Field, Ref, Schema, Struct, Type
from rosetta_jit.parsing.idl import Load, refuse
from rosetta_jit.source import Source


def parse(source: Source, load: Load) -> Schema:
    """All declarations of a `.lcm` file and of the files in which the types that it uses are found.

    Structs and enums are keyed by their qualified names (``exlcm.example_t``). A type ``pkg.type_t`` that the file does not declare is
    looked for in ``pkg/type_t.lcm``, ``lcm/pkg/type_t.lcm``, and ``type_t.lcm`` beside the file that uses it.

    Parameters
    ----------
    source
        The text, and the name by which it was found.
    load
        Finds other files.

    Raises
    ------
    SchemaError
        With everything that is wrong in any of the files.
    """
    problems: list[Diagnostic] = []
    gathered = gather(source, load, problems)
    schema = schema_of(gathered, problems)
    check_endless(schema, problems)
    refuse(problems, MAX_PROBLEMS)
    return schema


def check_endless(schema: Schema, problems: list[Diagnostic]) -> None:
    """Report structs that contain themselves in every value, so that none ends: no array on the way back could be empty."""
    done: set[str] = set()
    for name in schema.types:
        if name not in done:
            _visit(name, schema, done, problems)


def _visit(start: str, schema: Schema, done: set[str], problems: list[Diagnostic]) -> None:
    """Depth first; a field that leads to a struct which is still open closes a circle."""
    open_ = {start: _always(schema, start)}
    while open_:
        name, fields = next(reversed(open_.items()))
        each = next(fields, None)
        if each is None:
            done.add(name)
            del open_[name]
            continue
        field, target = each
        if target in open_:
            problems.append(say.endless(field.name, field.span, target))
        elif target not in done:
            open_[target] = _always(schema, target)


def _always(schema: Schema, name: str) -> Iterator[tuple[Field, str]]:
    """The structs that are in every value of a struct, and the fields which they are in."""
    declared = schema.types.get(name)
    fields = declared.fields if isinstance(declared, Struct) else ()
    return ((field, target) for field in fields if (target := _inside(field.type)) is not None)


def _inside(type_: Type) -> str | None:
    while isinstance(type_, Array) and isinstance(type_.length, int) and type_.length:
        type_ = type_.element
    return type_.name if isinstance(type_, Ref) else None


def type_of(wanted: int, source: Source, load: Load) -> str | None:
    """The type with a fingerprint that a file declares, or one that it leads to; None if there is none.

    LCM's logs tell no types, but each message begins with the fingerprint of its own.
    """
    with suppress(SchemaError):  # what is wrong with a file is said when somebody wants it
        schema = parse(source, load)
        structs = (each for each in schema.types.values() if isinstance(each, Struct))
        return next((each.name for each in structs if fingerprint(each, schema) == wanted), None)
    return None


def files_in(folders: Iterable[Path]) -> Iterator[str]:
    """The `.lcm` files in some folders, `MAX_FILES` of them at most, by their names there."""
    every = (path.relative_to(folder).as_posix() for folder in folders for path in sorted(folder.rglob("*.lcm")))
    return islice(every, MAX_FILES)
