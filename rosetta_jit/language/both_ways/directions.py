"""Rules for both directions as rules for each: `language.both_ways.derive`, where a mapping has any.

To turn rules around takes a tenth of the compiler. Mappings that write down both directions do not import it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.model.mapping import Mapping
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.bits import ConstantOf
    from rosetta_jit.language.both_ways.inverse import TypeOf


def in_each_direction(mapping: Mapping, type_of: TypeOf, constant_of: ConstantOf, problems: list[Diagnostic]) -> Mapping:
    """The mapping with all rules of each direction in the block of that direction."""
    if mapping.rules is None:
        return mapping
    from rosetta_jit.language.both_ways.derive import derive
    from rosetta_jit.language.both_ways.state import without_state

    rules = without_state(mapping.rules, frozenset(each.name for each in mapping.state), problems)
    return derive(replace(mapping, rules=rules), type_of, constant_of, problems)
