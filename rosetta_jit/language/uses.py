"""What the rules of a mapping use that stands elsewhere: functions of its user, and other mappings."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rosetta_jit.language.typed import Place
from rosetta_jit.model import mapping as model
from rosetta_jit.model.expr import Side
from rosetta_jit.model.mapping import Via
from rosetta_jit.model.types import Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace


@dataclass(frozen=True, slots=True)
class Signature:
    """The types of a declared function."""

    name: str
    parameters: tuple[Type, ...]
    result: Type
    span: Span | None


class EnoughError(Exception):
    """What is wrong is so large that nothing more is looked at; never leaves `language.resolve.rules`."""


@dataclass(frozen=True, slots=True)
class Use:
    """That a rule is made by a mapping whose ``side`` is what the rule sets: at ``place``, from ``origin``."""

    mapping: model.Mapping
    side: Side
    place: Place
    origin: Place
    span: Span | None


@dataclass(frozen=True, slots=True)
class UsableMappings:
    """The mappings that can be used, by the file that names them and the name there; and what is being used at the moment.

    ``using`` are the files of the mappings around, from the outermost on; ``uses`` are all that were made.
    """

    found: Mapping[tuple[str, str], model.Mapping]
    imported: Mapping[str, tuple[str, ...]]
    using: tuple[str, ...]
    uses: list[Use] = field(default_factory=list["Use"])

    def named(self, via: Via) -> model.Mapping | None:
        """The mapping of a ``via``; None where it could not be read, which is reported."""
        return self.found.get((self.using[-1], via.mapping))

    def changed(self, change: Callable[[model.Mapping], model.Mapping]) -> UsableMappings:
        """The same with each mapping changed, once."""
        made = {each.source.name: change(each) for each in self.mappings()}
        return replace(self, found={key: made[each.source.name] for key, each in self.found.items()})

    def copied(self) -> int:
        """How many rules the uses so far have."""
        blocks = [use.mapping.unpack_rules if use.side == "holder" else use.mapping.pack_rules for use in self.uses]
        return sum(len(block or ()) for block in blocks)

    def mappings(self) -> list[model.Mapping]:
        """Each mapping once."""
        return list({each.source.name: each for each in self.found.values()}.values())

    def by_type(self) -> list[model.Mapping]:
        """The mappings that the file of the innermost one imports."""
        here = self.using[-1]
        return [self.found[here, name] for name in self.imported.get(here, ()) if (here, name) in self.found]
