"""Types of a framework and of the one that followed it: messages of one, in holders of the other. No mapping is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.catalogue import pipeline as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.lowering.writer import References
from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.pipeline.build import Build, Types
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.wire.codec import Encoding
from rosetta_jit.wire.differences import differences
from rosetta_jit.wire.other_type import Pairs, Partners, UnlikeError, for_other_type

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Successors


class SuccessorBuild(Build):
    """A program of a type whose holder is of another one."""

    def __init__(self, build: Build, other: Build, pairs: Pairs, references: References | None = None) -> None:
        super().__init__(build.request, references)
        self._own, self._other, self._pairs = build, other, pairs

    def referring(self, references: References) -> Build:
        return SuccessorBuild(self._own, self._other, self._pairs, references)

    @cached_property
    def types(self) -> Types:
        own, other = self._own.types, self._other.types
        schema = Schema({**own.schema.types, **other.schema.types}, constants={**own.schema.constants, **other.schema.constants})
        return Types(other.holder, own.wire, schema, None)

    @cached_property
    def encoding(self) -> Encoding:
        types = self.types
        return for_other_type(self._own.encoding, types.wire, types.holder, types.schema, self._pairs)

    def files(self) -> dict[str, str | None]:
        return self._own.files()

    def differences(self, *, is_read: bool) -> tuple[str, ...]:
        """What becomes of fields, where messages come from this type (``is_read``) or go there."""
        types = self.types
        return differences(types.wire, types.holder, types.schema, self._pairs, is_read=is_read)


def joined(first: Build, second: Build) -> tuple[Build, Build]:
    """Two halves of a bridge that meet at one type, if theirs are of a framework and of the one that followed it; else as they are.

    Raises
    ------
    SchemaError
        They are, and do not have the same fields.
    """
    one, other = first.holder_framework, second.holder_framework
    follow = other.successors(one.name)
    is_first_older = follow is not None
    follow = follow or one.successors(other.name)
    if follow is None:
        return first, second

    try:
        if first.request.mapping is None and (is_first_older or second.request.mapping is not None):
            return _with_other_holder(first, second, follow, is_older=is_first_older), second
        if second.request.mapping is None:
            return first, _with_other_holder(second, first, follow, is_older=not is_first_older)
    except UnlikeError as error:
        names = first.types.holder.name, second.types.holder.name
        raise SchemaError((words.unlike(*names, error.path, error.why),)) from error
    return first, second


def _with_other_holder(build: Build, other: Build, follow: Successors, *, is_older: bool) -> Build:
    """A half whose holder is of the type of the other one."""

    def of_newer(wire: Struct, holder: Struct, shown: str) -> Partners:
        became = follow(holder, wire, shown)
        if became.added:
            raise UnlikeError(f"{shown}.{min(became.added)}", "the data-holder has no such field")
        older = {name: old for old, name in became.fields.items() if name is not None}
        return Partners({each.name: older.get(each.name) for each in wire.fields})

    made = SuccessorBuild(build, other, follow if is_older else of_newer)
    made.encoding  # noqa: B018 - here it is found out that fields have no partner
    return made
