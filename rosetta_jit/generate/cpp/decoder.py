"""Decoders of C++: kernels that set fields where the object has them, as far as they can."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.lanes import Lanes, Straight
from rosetta_jit.generate.cpp.arrays_in_place import arrays_in_place, uncounted
from rosetta_jit.generate.cpp.lists_in_place import opened_lists
from rosetta_jit.generate.cpp.opened import in_place
from rosetta_jit.generate.cpp.packed import packed_lists
from rosetta_jit.generate.cpp.set_in_place import straight_numbers
from rosetta_jit.generate.cpp.walk import Walk
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.manners import Manners


def decoder_of(unit: Unit, manners: Manners, kernel: Kernel, lanes: Lanes) -> tuple[Kernel, Lanes]:
    """The kernel of such a decoder, and how it reaches the fields."""
    walk = Walk(unit, lanes, manners, "decode")
    straight = {(0, offset): Straight(statement) for offset, (_, statement) in straight_numbers(walk).items()}
    lists = opened_lists(walk, "given_object")
    for each in lists:
        kernel, straight = in_place(kernel, each.fields) or kernel, straight | each.fields
    opened = frozenset(lane for each in lists for lane in each.containers.keys() - each.texts)
    arrays = arrays_in_place(walk, "given_object")
    for each in arrays:
        kernel = uncounted(kernel, each) or kernel
    packed, given = packed_lists(walk, kernel, lists), {each.lane: each.given for each in arrays}
    return kernel, replace(lanes, straight=straight, opened=opened, given=given, packed=packed)
