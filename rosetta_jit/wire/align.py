"""Alignment, resolved as far as it is known before any message comes.

The `Phase` of a position is what is known of its distance from the origin. Where it tells how much padding an `Align` is, the padding is
written down; where it does not, the `Align` stays, and is computed for each message. So elements that keep their phase become elements of
one size, which are read in bulk.
"""

from __future__ import annotations

from typing import assert_never

from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.wire import codec as wire
from rosetta_jit.wire.size import count_width, fixed_size


@dataclass(frozen=True, slots=True)
class Phase:
    """A position is ``residue`` more than a multiple of ``modulus`` from the origin; both powers of two matter alone."""

    modulus: int
    residue: int

    def after(self, size: int | None) -> Phase:
        """The phase behind so many bytes, None for any number."""
        return ANYWHERE if size is None else Phase(self.modulus, (self.residue + size) % self.modulus)

    def join(self, other: Phase) -> Phase:
        """What is known where either may be."""
        modulus = min(self.modulus, other.modulus)
        while self.residue % modulus != other.residue % modulus:
            modulus //= 2
        return Phase(modulus, self.residue % modulus)

    def padding(self, size: int) -> int | None:
        """Bytes up to a multiple of ``size``, if they are known."""
        return -self.residue % size if self.modulus >= size else None


ANYWHERE = Phase(1, 0)
ORIGIN = Phase(8, 0)


def settle(codec: wire.Codec, phase: Phase) -> tuple[wire.Codec, Phase]:
    """The codec with all alignment resolved that a position of that phase tells, and the phase behind it."""
    match codec:
        case wire.Number() | wire.Unsent() | wire.Table() | wire.Constant() | wire.Computed() | wire.Padding():
            return codec, phase.after(fixed_size(codec))
        case wire.Align(size):
            known = phase.padding(size)
            return (codec, Phase(size, 0)) if known is None else (wire.Seq(_paddings(known)), phase.after(known))
        case wire.Blob(_, count):
            return codec, phase.after(fixed_size(codec)) if isinstance(count.value, int) else ANYWHERE
        case wire.Seq(items):
            return _settle_all(items, phase)
        case wire.Repeat():
            return _settle_repeat(codec, phase)
        case wire.Cases(_, discriminator, cases):
            discriminator, phase = settle(discriminator, phase)
            settled = [settle(each, phase) for _, each in cases]
            bodies = tuple((labels, each) for (labels, _), (each, _) in zip(cases, settled, strict=True))
            behind = phase if codec.default is None else settled[0][1]
            return replace(codec, discriminator=discriminator, cases=bodies), _joined([behind, *(each for _, each in settled)])
        case wire.Maybe(path, value):
            value, behind = settle(value, phase.after(1))
            return wire.Maybe(path, value), phase.after(1).join(behind)
        case wire.Delimited(_, value):
            value, behind = settle(value, phase.after(4))
            return replace(codec, value=value), behind
        case wire.Members():
            members = tuple(replace(each, value=settle(each.value, Phase(4, 0))[0]) for each in codec.members)
            return replace(codec, members=members), ANYWHERE
        case wire.Parameter(member):
            inside = Phase(4, 0) if codec.second else ORIGIN
            return replace(codec, member=replace(member, value=settle(member.value, inside)[0])), ANYWHERE
        case wire.Parameters():
            members = tuple(replace(each, value=settle(each.value, ORIGIN)[0]) for each in codec.members)
            return replace(codec, members=members), ANYWHERE
        case wire.Utf16() | wire.Recursion() | wire.Tagged() | wire.Varint() | wire.Choice():
            return codec, ANYWHERE
        case _:
            assert_never(codec)


def leading(codec: wire.Codec) -> int:
    """The alignment with which a codec begins."""
    match codec:
        case wire.Align(size):
            return size
        case wire.Seq(items) if items:
            return leading(items[0])
        case wire.Cases(_, discriminator):
            return leading(discriminator)
        case _:
            return 1


def _settle_all(items: tuple[wire.Codec, ...], phase: Phase) -> tuple[wire.Codec, Phase]:
    settled: list[wire.Codec] = []
    for item in items:
        each, phase = settle(item, phase)
        settled += each.items if isinstance(each, wire.Seq) else [each]
    return wire.Seq(tuple(settled)), phase


def _settle_repeat(repeat: wire.Repeat, phase: Phase) -> tuple[wire.Codec, Phase]:
    """Elements start where the one before them ends, so their phase is what is known of all of them."""
    head, phase = _settle_all(repeat.head, phase.after(_count_size(repeat.count)))
    assert isinstance(head, wire.Seq)
    align = 1 if phase.padding(repeat.align) == 0 else repeat.align
    start = phase if align == 1 else Phase(align, 0)
    item, behind = settle(repeat.item, start)
    while start.join(behind) != start:
        start = start.join(behind)
        item, behind = settle(repeat.item, start)
    return replace(repeat, item=item, head=head.items, align=align), phase.join(behind)


def _count_size(count: wire.Count) -> int | None:
    return None if count.scalar == "varint" else count_width(count)


def _joined(phases: list[Phase]) -> Phase:
    result = phases[0]
    for each in phases[1:]:
        result = result.join(each)
    return result


def _paddings(size: int) -> tuple[wire.Codec, ...]:
    """Zeros, as the fewest numbers."""
    widths = {"u32": 4, "u16": 2, "u8": 1}
    found: list[wire.Codec] = []
    for scalar, width in widths.items():
        found += [wire.Padding(scalar, 0)] * (size // width)
        size %= width
    return tuple(found)
