"""Decoders of C++: kernels that set fields where the object has them, as far as they can."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.holder.lanes import Lanes, Straight
from rosetta_jit.generate.cpp.decoding.arrays_in_place import arrays_in_place, uncounted
from rosetta_jit.generate.cpp.decoding.lists_in_place import Opened, opened_lists
from rosetta_jit.generate.cpp.decoding.packed import packed_lists
from rosetta_jit.generate.cpp.decoding.set_in_place import straight_numbers
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.cpp.passes.numbers_apart import with_numbers_apart
from rosetta_jit.generate.cpp.passes.opened import in_place
from rosetta_jit.generate.unit import Unit
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.decoding.messages_in_place import MessagesInPlace
    from rosetta_jit.generate.cpp.objects.manners import Manners


OBJECT = "given_object"


def decoder_of(unit: Unit, manners: Manners, kernel: Kernel, lanes: Lanes, inner: MessagesInPlace | None = None) -> tuple[Kernel, Lanes]:
    """The kernel of such a decoder, and how it reaches the fields; its last bodies are for ``inner`` messages that it reads in place."""
    walk = Walk(unit, lanes, manners, "decode")
    lists = opened_lists(walk, OBJECT)
    kernel = with_numbers_apart(kernel, unit.layout, {lane for each in lists for lane in each.within})
    found, reached = _in_place(walk, kernel, lists)
    if inner is not None:
        found, lists = inner.whole(found), [*lists, *inner.rows]
        straight, opened = {**reached.straight, **inner.straight}, reached.opened | inner.opened
        reached = replace(reached, straight=straight, opened=opened, messages=inner.lists)
    return found, replace(reached, packed=packed_lists(walk, found, lists))


def open_decoder_of(unit: Unit, manners: Manners, lanes: Lanes) -> tuple[Kernel, Lanes]:
    """The same of a decoder that opens lists, too, whose elements lie in memory as rows do: it sets their numbers one by one."""
    kernel = with_numbers_apart(unit.kernels["borrow"], unit.layout)
    walk = Walk(replace(unit, kernels={**unit.kernels, "borrow": kernel}), lanes, manners, "decode")
    return _in_place(walk, kernel, opened_lists(walk, OBJECT, with_taken=True))


def _in_place(walk: Walk, kernel: Kernel, lists: list[Opened]) -> tuple[Kernel, Lanes]:
    straight = {(0, offset): Straight(statement) for offset, (_, statement) in straight_numbers(walk).items()}
    for each in lists:
        kernel, straight = in_place(kernel, each.fields) or kernel, straight | each.fields
    opened = frozenset(lane for each in lists for lane in each.containers)
    arrays = arrays_in_place(walk, OBJECT)
    for each in arrays:
        kernel = uncounted(kernel, each) or kernel
    return kernel, replace(walk.lanes, straight=straight, opened=opened, given={each.lane: each.given for each in arrays})
