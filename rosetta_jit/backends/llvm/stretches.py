"""How statements that are alike are found: stretches of a block that repeat themselves, and cases of a switch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any

from rosetta_jit.backends.llvm import alike_names
from rosetta_jit.backends.llvm.alike import Cases, Found, Number, Series
from rosetta_jit.backends.llvm.alike_names import Carried
from rosetta_jit.backends.llvm.outline import Outline, Slot, is_number
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Assign, Block, Call, Const, Copy, Expr, Fill, For, If, Local, Reserve, Scalar, Stmt, Switch, While
from rosetta_jit.kernel.rewrite import with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.traits import is_large
from rosetta_jit.kernel.walk import blocks_of, flat, parts_of

ROUNDS = 16
"""Stretches from which on they are worth a loop."""

LONGEST = 64
"""Statements of a stretch."""

WORTH = (Copy, Fill, Reserve, Call, For, While)
"""Statements of which a stretch has one: a round of fields that are only compared and set would cost more than they do."""

MAY_BE_WORTH = (*WORTH, If, Switch)
"""The same, and the statements that may have one inside. In large kernels these are worth a loop by themselves: for twice as many branches
LLVM takes more than twice as long, and calls are no slower, as all that they run stays in the processor's caches."""

SKIPPED = 3
"""Stretches among which the first one of a series is looked for: the first ones may be told more than those behind them."""


def found(kernel: Kernel, body: Block) -> Found:
    """The series of a body of a kernel."""
    every, look = flat(body), _Look(kernel)
    inside = [block for each in every for block in _blocks(each)]
    blocks = {id(block): parts for block in (body, *inside) if _may_repeat(block) and (parts := look.parts(block)) is not None}
    switches = {id(each): cases for each in every if isinstance(each, Switch) and (cases := look.cases(each))}
    return Found(blocks, switches)


def _may_repeat(block: Block) -> bool:
    """Whether a block has many statements that are worth a loop or may hold such; a look at all inside would cost more with each level."""
    return len(block) >= ROUNDS and sum(isinstance(each, MAY_BE_WORTH) for each in block) >= ROUNDS


def _blocks(stmt: Stmt) -> tuple[Block, ...]:
    match stmt:
        case For(_, _, body) | While(_, body, _, _):
            return (body,)
        case If(_, then, otherwise):
            return (then, otherwise)
        case _:
            return ()


class _Look:
    """A look at the statements of a kernel."""

    def __init__(self, kernel: Kernel) -> None:
        self.strides, self.own_lanes = kernel.strides, kernel.lanes
        self.is_large = is_large(kernel)

    def outline(self, stmt: Stmt) -> Outline:
        return Outline(stmt, self.strides, self.own_lanes)

    def parts(self, block: Block) -> tuple[Stmt | Series, ...] | None:
        """The statements of a block, with series in their places; None if there are none."""
        outlines = self._outlines(block)
        known = dict["Hashable", int]()
        numbers = [known.setdefault(object() if each is None else each.shape, len(known)) for each in outlines]
        slots = [[] if each is None else each.slots for each in outlines]
        parts, at, behind, following = list["Stmt | Series"](), 0, 0, _following(numbers)
        uses: Counter[str] | None = None
        while at < len(block):
            period = following[at] - at
            end = _end(numbers, at, period) if 0 < period <= LONGEST else at
            if not period or end - at < ROUNDS * period:
                at += 1
                continue
            if uses is None:
                uses = Counter(_used_names(block))
            made = _best(block, slots, range(at, end), period, uses) if self._is_worth(block[at : at + period]) else None
            if made is None:
                at = end - period + 1
                continue
            series, begin, at = made
            parts += [*block[behind:begin], series]
            behind = at
        return (*parts, *block[behind:]) if parts else None

    def _is_worth(self, stretch: Block) -> bool:
        return any(isinstance(each, MAY_BE_WORTH if self.is_large else WORTH) for each in flat(stretch))

    def _outlines(self, block: Block) -> list[Outline | None]:
        """The outlines of a block's statements, but for those of a kind of which there are too few for a series."""
        kinds = [(type(stmt), *(tuple(map(type, inner)) for inner in blocks_of(stmt))) for stmt in block]
        times = Counter(kinds)
        return [self.outline(stmt) if times[kind] >= ROUNDS else None for stmt, kind in zip(block, kinds, strict=True)]

    def cases(self, switch: Switch) -> tuple[Cases, ...]:
        """The cases of a switch that are alike, where they are many. Two or three large ones are a function (`twins`).

        Where they use other names of what is around them, as optional fields do that are noted in other words, each is printed, which takes
        half of the time to run: but for large kernels, which LLVM would take seconds for.
        """
        alike = dict["Hashable", list[tuple[int, "Block", list["Slot"]]]]()
        kinds = [tuple(map(type, body)) for _, body in switch.cases]
        times = Counter(kinds)
        for (number, body), kind in zip(switch.cases, kinds, strict=True):
            if times[kind] < ROUNDS:
                continue
            outlines = list(map(self.outline, body))
            slots = joined(each.slots for each in outlines)
            around = _names_around(slots) if self.is_large else ()
            alike.setdefault((around, *[each.shape for each in outlines]), []).append((number, body, slots))
        made = [_case(group) for group in alike.values() if len(group) >= ROUNDS and len(group[0][1]) > 1]
        return tuple(each for each in made if each is not None)


def _used_names(block: Block) -> list[str]:
    """The names that a block reads or sets, at any depth, each as often as it does."""
    every = flat(block)
    return [part.name for part in parts_of(every) if type(part) is Local] + [stmt.name for stmt in every if type(stmt) is Assign]


def _following(numbers: Sequence[int]) -> list[int]:
    """For each statement, where the next one that is alike stands; itself if there is none."""
    last, following = dict[int, int](), [0] * len(numbers)
    for at in range(len(numbers) - 1, -1, -1):
        following[at] = last.get(numbers[at], at)
        last[numbers[at]] = at
    return following


def _end(numbers: Sequence[int], at: int, period: int) -> int:
    """The end of what repeats itself from a place on."""
    end = at
    while end + period < len(numbers) and numbers[end] == numbers[end + period]:
        end += 1
    return end + period


def _best(block: Block, slots: Sequence[Sequence[Slot]], where: range, period: int, uses: Counter[str]) -> tuple[Series, int, int] | None:
    """A series among statements that repeat themselves, with its begin and end: of all ways to cut them, one that carries least."""
    middle = (len(where) // 2 // period) * period
    begins = sorted(range(where.start, where.start + period), key=lambda begin: _carries(slots, middle + begin, period))
    for begin in begins[:2]:
        for start in range(begin, begin + SKIPPED * period, period):
            cut = range(start, where.stop - period + 1, period)
            if len(cut) < ROUNDS:
                continue
            series = _series(block[cut[-1] : cut[-1] + period], [joined(slots[at : at + period]) for at in cut], uses)
            if series is not None:
                return series, start, cut[-1] + period
    return None


def _carries(slots: Sequence[Sequence[Slot]], begin: int, period: int) -> int:
    """How many names a stretch takes over from the one before it, if one begins there."""
    before = {slot.name for slot in joined(slots[begin - period : begin]) if slot.kind == "bound"}
    return len({slot.name for slot in joined(slots[begin : begin + period]) if slot.is_use and slot.name in before})


def joined(slots: Iterable[Sequence[Slot]]) -> list[Slot]:
    """All slots, those of one statement behind those of another."""
    return [slot for each in slots for slot in each]


def _names_around(slots: Sequence[Slot]) -> tuple[str, ...]:
    """What a case uses that is bound around it: cases of one series use the same."""
    bound = {slot.name for slot in slots if slot.kind == "bound"}
    return tuple([slot.name for slot in slots if slot.is_use and slot.name not in bound])


def _case(group: Sequence[tuple[int, Block, list[Slot]]]) -> Cases | None:
    """The series of some cases. A lane of the last one may stand for two where that of the first one does not: it is printed then."""
    for cases in (group, group[::-1]):
        series = _series(cases[-1][1], [slots for *_, slots in cases], None)
        if series is not None and not series.carried:
            return Cases(tuple(number for number, *_ in cases), series)
    return None


# --- the table -----------------------------------------------------------------------------------------------------------


def _series(last: Block, rows: Sequence[Sequence[Slot]], uses: Counter[str] | None) -> Series | None:
    """The series of some stretches, of which ``last`` is the last one, by what stands in the slots of each; None if it is none."""
    carried = alike_names.carried_names(rows)
    if carried is None or (uses is not None and not alike_names.stay_inside(rows, uses)):
        return None
    return tabled(last, rows, carried)


def tabled(last: Block, rows: Sequence[Sequence[Slot]], carried: tuple[Carried, ...]) -> Series | None:
    """The series of some stretches whose names correspond to one another; None where one number of the last stretch stands for two."""
    columns = _Columns()
    found: dict[tuple[Any, ...], Number | None] = {}
    for at, stacked in enumerate(zip(*rows, strict=True)):
        slot = stacked[-1]
        key = _key(at, slot)
        if key is None:
            continue
        number = columns.number([each.number for each in stacked])
        for further in slot.distances:
            same = None if number is None else Number(number.column, number.further + further)
            if found.setdefault((*key, slot.number + further), same) != same:
                return None
    return _stated(last, rows[-1], columns.rows(), {key: each for key, each in found.items() if each is not None}, carried)


def _key(at: int, slot: Slot) -> tuple[Any, ...] | None:
    """By what, and by itself, a number is found again in the last stretch: constants by where they stand."""
    match slot.kind:
        case "number":
            return "number", at
        case "lane" | "site":
            return (slot.kind,)
        case "offset":
            return "offset", slot.lane
        case _:
            return None


class _Columns:
    """The columns of a table. Numbers that grow alike from row to row share one."""

    def __init__(self) -> None:
        self.columns: dict[tuple[int, ...], tuple[int, list[int]]] = {}

    def number(self, values: list[int]) -> Number | None:
        """Where to find a number; None if it is the same in all rows."""
        first = values[0]
        steps = tuple([each - first for each in values])
        if not any(steps):
            return None
        column, known = self.columns.setdefault(steps, (len(self.columns), values))
        return Number(column, first - known[0])

    def rows(self) -> tuple[tuple[int, ...], ...]:
        return tuple(zip(*(values for _, values in self.columns.values()), strict=True))


def _stated(
    last: Block,
    slots: Sequence[Slot],
    rows: tuple[tuple[int, ...], ...],
    found: Mapping[tuple[Any, ...], Number],
    carried: tuple[Carried, ...],
) -> Series:
    constants = dict[str, tuple["Scalar", Number]]()
    numbers = iter([at for at, slot in enumerate(slots) if slot.kind == "number"])

    def changed(expr: Expr) -> Expr:
        if not (isinstance(expr, Const) and is_number(expr)):
            return with_operands(expr, changed)
        number = found.get(("number", at := next(numbers), int(expr.value)))
        if number is None:
            return expr
        name = f"number {at}"
        constants[name] = expr.type, number
        return Local(expr.type, name)

    def restated(stmt: Stmt) -> Stmt:
        return with_blocks(with_expressions(stmt, changed), lambda inner: tuple(map(restated, inner)))

    body = tuple(map(restated, last))
    lanes = {key[1]: each for key, each in found.items() if key[0] == "lane"}
    offsets = {key[1:]: each for key, each in found.items() if key[0] == "offset"}
    sites = {key[1]: each for key, each in found.items() if key[0] == "site"}
    return Series(body, rows, constants, lanes, offsets, sites, carried)
