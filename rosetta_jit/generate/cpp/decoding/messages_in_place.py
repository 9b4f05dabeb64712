"""Messages of types that contain themselves, which a decoder reads where the object has them: no row keeps anything of them.

Functions that call each other read them (`generate.c.visited`). That is so where each of their fields is a number, a text, or a list that
can be read in place (`lists_in_place`), and where they stand in lists that are always there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rosetta_jit.generate.c.holder.lanes import Lanes, Straight
from rosetta_jit.generate.c.holder.unit_lanes import own_lanes
from rosetta_jit.generate.cpp.decoding.lists_in_place import Opened, messages_of, row_in_place
from rosetta_jit.generate.cpp.objects.walk import Walk
from rosetta_jit.generate.cpp.passes.numbers_apart import with_numbers_apart
from rosetta_jit.generate.cpp.passes.numbers_kept import with_numbers_kept
from rosetta_jit.generate.cpp.passes.opened import in_place, without_asking
from rosetta_jit.generate.passes.descents import Descents, NotNested, Visit, descended
from rosetta_jit.generate.passes.undamaged import undamaged_kernel
from rosetta_jit.generate.unit import Unit, wires_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Advance, Block, Call, Const, Let, Local, Reserve, SetField, Stmt, Used
from rosetta_jit.kernel.rewrite import with_bodies
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.generate.cpp.objects.manners import Manners

OBJECT = "given_object"


@dataclass(frozen=True, slots=True)
class MessagesInPlace:
    """How such messages are read: for each body of the kernel what is done for the message, and for each row within it.

    ``rows`` say what sets the fields of a row, ``lists`` where the messages are by the place of their span.
    """

    descents: tuple[Descents, ...]
    rows: tuple[Opened, ...]
    lists: Mapping[tuple[int, int], str]

    @property
    def lanes(self) -> frozenset[int]:
        """The lanes of the messages."""
        return frozenset(each.lane for each in self.rows)

    @property
    def unused(self) -> frozenset[int]:
        """The offsets in the message's row of spans that nothing sets."""
        return frozenset(at for lane, offset in self.lists if lane == 0 for at in (offset, offset + 8))

    @property
    def straight(self) -> dict[tuple[int, int], Straight]:
        return {at: each for opened in self.rows for at, each in opened.fields.items()}

    @property
    def opened(self) -> frozenset[int]:
        """The lanes of lists within rows whose elements have rows of their own in other messages."""
        return frozenset(lane for each in self.rows for lane in each.containers)

    def of_message(self, unit: Unit) -> Unit:
        """A unit whose decoder does what is done for the message alone."""
        kernel = with_bodies(unit.kernels["borrow"], tuple(each.body for each in self.descents))
        return replace(unit, kernels={**unit.kernels, "borrow": kernel})

    def without(self, kernel: Kernel, lanes: Lanes) -> tuple[Kernel, Lanes]:
        """The decoder of messages that have none within them: it opens the lists for these, and reads no element."""
        visits, opened = self.descents[0].visits, dict[tuple[int, int], Straight]()
        body = tuple(each for stmt in kernel.bodies[0] for each in _opening(stmt, visits))
        for at in (at for at in self.lists if at[0] == 0):
            lane = next(each.lane for each in visits.values() if each.place is not None and (each.place.lane, each.place.offset) == at)
            opened[at] = Straight("", lane, empty=f"rosetta_jit::detail::resize_to({self.lists[at]}, 0);")
        return replace(kernel, bodies=(body,)), replace(lanes, straight={**lanes.straight, **opened})

    def whole(self, kernel: Kernel) -> Kernel:
        """A decoder of the message with the blocks for rows as further bodies."""
        return replace(kernel, bodies=(*kernel.bodies, *(block for each in self.descents for block in each.rows.values())))

    def parted(self, kernel: Kernel) -> tuple[Descents, ...]:
        """The bodies of such a decoder, parted again."""
        blocks = iter(kernel.bodies[len(self.descents) :])
        bodies = zip(self.descents, kernel.bodies[: len(self.descents)], strict=True)
        return tuple(replace(each, body=body, rows={lane: next(blocks) for lane in each.rows}) for each, body in bodies)


def messages_in_place(unit: Unit, manners: Manners) -> MessagesInPlace | None:
    """How the decoder of a unit reads them; None where it makes rows of them, or there are none."""
    if "borrow" not in unit.kernels or wires_of(unit) or not unit.layout.recursive:
        return None
    kernel = undamaged_kernel(unit.kernels["borrow"])
    try:
        descents = [descended(body, unit.layout) for body in kernel.bodies]
    except NotNested:
        return None
    own = own_lanes(unit)[1]
    visited, structs = frozenset(descents[0].rows), dict(unit.layout.recursive)
    walk = Walk(unit, Lanes(unit.name, tuple(own), len(own), "c++"), manners, "decode", visited=visited)
    found = [messages_of(walk, lane, structs.get(lane, unit.type), OBJECT) for lane in (0, *visited)]
    lists = {(lane, span.offset): spot.at for each in found for lane, span, spot in each}
    visits = [visit for each in descents for visit in each.visits.values()]
    if not all(each.place is not None and (each.place.lane, each.place.offset) in lists for each in visits):
        return None
    rows, blocks = list[Opened](), dict[int, tuple[Block, ...]]()
    for lane in sorted(visited):
        opened = row_in_place(walk, lane, structs[lane], OBJECT, f"std::declval<{walk.lanes.objects(lane)}::type &>()")
        of_row = None if opened is None else _rows(unit, kernel, [each.rows[lane] for each in descents], opened)
        if opened is None or of_row is None:
            return None
        rows.append(opened)
        blocks[lane] = of_row
    rewritten = (
        replace(each, body=with_numbers_kept(each.body, 0), rows={lane: of_row[number] for lane, of_row in blocks.items()})
        for number, each in enumerate(descents)
    )
    return MessagesInPlace(tuple(rewritten), tuple(rows), lists)


def _opening(stmt: Stmt, visits: Mapping[str, Visit]) -> Block:
    """What opens a list, in place of a call that reads its messages."""
    match stmt:
        case Call(name, (begin, count), (behind,)) if name in visits:
            visit = visits[name]
            assert visit.place is not None
            assert isinstance(visit.start, Local)
            size = replace(visit.place, offset=visit.place.offset + 8)
            taken = Reserve(visit.lane, count), Let(visit.start.name, Used(visit.lane)), Advance(visit.lane, count)
            return *taken, SetField(visit.place, visit.start), SetField(size, count), Let(behind.name, begin)
        case _:
            return (stmt,)


def _rows(unit: Unit, kernel: Kernel, blocks: list[Block], opened: Opened) -> tuple[Block, ...] | None:
    """The blocks for a row, which set fields in place and ask for no room: lists have no more elements than the message has bytes."""
    kernel = with_bodies(kernel, tuple(with_numbers_kept(each, opened.lane) for each in blocks))
    found = in_place(with_numbers_apart(kernel, unit.layout, opened.structs), opened.fields, opened.lane)
    if found is None:
        return None
    found = without_asking(found, opened.lanes)
    asks = [stmt for block in found.bodies for stmt, _ in statements(block) if isinstance(stmt, Reserve)]
    return found.bodies if all(isinstance(each.count, Const) for each in asks) else None
