"""The types of a program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.model.types import Schema, Struct
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.language.check.wire_shares import Share
    from rosetta_jit.language.parameters.state import Declared
    from rosetta_jit.language.typed import Rule
    from rosetta_jit.language.uses import Signature


@dataclass(frozen=True, slots=True)
class Types:
    """The types of a program, and the rules between them, if they are two, with the state that they keep.

    Where the mapping has several wires, one of them is this one's, and its messages fill a ``share`` of the holder.
    """

    holder: Struct
    wire: Struct
    schema: Schema
    rules: tuple[Rule, ...] | None
    functions: Mapping[str, Signature] = field(default_factory=dict[str, "Signature"])
    state: Declared | None = None
    share: Share | None = None

    @property
    def registers(self) -> int:
        """How many registers the state takes."""
        return 0 if self.state is None else len(self.state.initial)
