"""A unit as C: `NAME.h` and `NAME.c`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.header import header
from rosetta_jit.generate.c.holder.lanes import Dialect, Lanes
from rosetta_jit.generate.c.holder.rows import Struct
from rosetta_jit.generate.c.holder.unit_lanes import hidden_lanes, own_lanes
from rosetta_jit.generate.c.printing.functions import Printed, print_kernel
from rosetta_jit.generate.c.source import source
from rosetta_jit.generate.passes.cleared import without_clearing
from rosetta_jit.generate.unit import Role, Unit
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    Print = Callable[[Kernel, Lanes, Role], Printed]


@dataclass(frozen=True, slots=True)
class Parts:
    """What all files of a unit are made of; ``hidden`` is how many hidden lanes the kernels use."""

    lanes: Lanes
    structs: tuple[Struct, ...]
    printed: Mapping[Role, Printed]
    hidden: int


def files(unit: Unit) -> dict[str, str]:
    """The texts of the files by their names."""
    unit = without_clearing(unit)
    return as_c(unit, lambda kernel, lanes, role: print_kernel(kernel, lanes, role, unit.origins.get(role, ())))


def as_c(unit: Unit, print_function: Print) -> dict[str, str]:
    """Header and source around functions that a printer makes for each kernel."""
    parts = parts_of(unit, print_function)
    return {
        f"{unit.name}.h": header(unit, parts.lanes, parts.structs, parts.hidden),
        f"{unit.name}.c": source(unit, parts.lanes, parts.structs, parts.printed),
    }


def parts_of(unit: Unit, print_function: Print, dialect: Dialect = "c") -> Parts:
    """The structs, the lanes and the printed kernels of a unit."""
    structs, own = own_lanes(unit)
    lanes = Lanes(unit.name, tuple(own), len(own), dialect)
    printed: dict[Role, Printed] = {
        role: print_function(kernel, replace(lanes, all=(*own, *hidden_lanes(kernel.strides[len(own) :]))), role)
        for role, kernel in unit.kernels.items()
    }
    hidden = 1 + max((number for each in printed.values() for number in each.hidden), default=-1)
    lanes = replace(lanes, all=(*own, *hidden_lanes([1] * hidden)))
    return Parts(lanes, tuple(structs.made.values()), printed, hidden)
