"""What the printers of a decoder or an encoder share: which locals, views of lanes and functions it has, and what these are called.

header_seq              a field of the message's row            position_d[start + i]     one of another lane, through a view of its bytes
position_used           how many rows are in use                position_room             for how many there is room
"""

from __future__ import annotations

import re
from collections.abc import Callable, Set
from itertools import groupby
from typing import TYPE_CHECKING

from rosetta_jit.backends.printing import joined
from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.python.passes.direct import Direct
from rosetta_jit.generate.python.passes.local_names import Locals
from rosetta_jit.generate.python.printing.classes import NUMPY
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.model.layout import Span
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.generate.c.holder.lanes import Lanes

CODES = {
    "bool": "B",
    "i8": "b",
    "u8": "B",
    "i16": "h",
    "u16": "H",
    "i32": "i",
    "u32": "I",
    "i64": "q",
    "u64": "Q",
    "f32": "f",
    "f64": "d",
}
"""Of the struct module, and of views."""
TRUTH = "T"
"""The struct module's "?" in names of its functions."""


@dataclass(slots=True)
class Scope:
    """What the printers of a function share.

    ``flat``: the fields of the message's row are locals, ``rows``, some of known ``offsets``, of which ``floats`` are floats, ``bools``
    bools. ``views`` are the lanes that it reaches, with the code of the view, empty for the bytes themselves; ``paths`` are the fields
    that lanes belong to; ``counted`` and ``rooms`` are lanes, ``loads`` functions that it needs, ``from_call`` what each call brings:
    its time and number, registers, object. ``small`` are the locals of 64 bits, without a sign, that are known to be below 2**63,
    ``sums`` those that are sums, ``allowed`` the numbers of rows that the message is known to be allowed.
    ``unpacked`` are rows, by lane and index, whose numbers are locals of a comprehension: it gets their types by offset.
    ``attributes`` are the fields of the message's row that are the object's at once, by offset, if it is made first; ``lists`` are
    the groups of lists that it may lack then. ``has_rows_apart``: the message's own rows of types that contain themselves are objects,
    in a list for each lane, which a function of their own has made.
    """

    locals: Locals
    lanes: Lanes
    flat: bool
    loads: set[str]
    name: str
    paths: tuple[str, ...]
    views: set[tuple[int, str]] = field(default_factory=set[tuple[int, str]])
    rows: set[str] = field(default_factory=set[str])
    offsets: dict[str, int] = field(default_factory=dict[str, int])
    floats: set[str] = field(default_factory=set[str])
    bools: set[str] = field(default_factory=set[str])
    counted: set[int] = field(default_factory=set[int])
    rooms: set[int] = field(default_factory=set[int])
    from_call: set[str] = field(default_factory=set[str])
    direct: Direct = field(default_factory=Direct)
    attributes: dict[int, str] | None = None
    lists: tuple[tuple[Span, ...], ...] = ()
    has_rows_apart: bool = False
    numpy: bool = False
    small: set[str] = field(default_factory=set[str])
    sums: dict[nodes.Expr, str] = field(default_factory=dict[nodes.Expr, str])
    allowed: frozenset[nodes.Expr] = frozenset()
    unpacked: dict[tuple[int, str], dict[int, str]] = field(default_factory=dict[tuple[int, str], dict[int, str]])

    def note(self, name: str, *, is_small: bool) -> None:
        """Know of a local whether it is below 2**63."""
        (self.small.add if is_small else self.small.discard)(name)

    def forget(self, names: Set[str]) -> None:
        """Know no more of locals that change."""
        self.allowed = frozenset(each for each in self.allowed if not locals_in(each) & names)
        self.sums = {each: name for each, name in self.sums.items() if not locals_in(each) & names}

    def view(self, lane: int, code: str) -> str:
        """The view of a lane's rows as numbers of one type."""
        self.views.add((lane, code))
        return view_name(self.lanes, lane, code)

    def used(self, lane: int) -> str:
        self.counted.add(lane)
        return "1" if lane == 0 else f"{self.lanes.rows(lane)}_used"

    def room(self, lane: int) -> str:
        self.rooms.add(lane)
        return "1" if lane == 0 else f"{self.lanes.rows(lane)}_room"

    def struct(self, order: str, code: str, verb: str) -> str:
        """A function of the struct module: ``load_I`` with the low byte first, ``load_I_be`` with the high one."""
        code = "".join(f"{count}{each}" if (count := len([*same])) > 1 else each for each, same in groupby(code))
        name = f"_{verb}_{code.replace('?', TRUTH)}{'' if order == '<' else '_be'}"
        self.loads.add(name)
        return name

    def by_count(self, order: str, code: str, verb: str) -> str:
        """The functions that read (``verb`` is ``reads``) or write (``writes``) as many numbers as a message says, by their count."""
        name = f"_{verb}_{code.replace('?', TRUTH)}{'_be' if order == '>' and code not in 'bB?' else ''}"
        self.loads.add(name)
        return name

    def dtype(self, scalar: str, order: str = "<") -> str:
        """Numpy's type of a scalar in the message."""
        code = NUMPY[scalar][1]
        name = f"_dtype_{code}{'_be' if order == '>' and code[1:] != '1' else ''}"
        self.loads.add(name)
        return name

    def bool_dtype(self) -> str:
        """Numpy's type of bools, which are known to be 0 or 1 in the message."""
        self.loads.add("_dtype_b1")
        return "_dtype_b1"

    def numbers_in_message(self, dtype: str, count: str, begin: str) -> str:
        """An array of numpy that lies in the message as in memory: a copy, or a view."""
        self.from_call.add("copy")
        return f"call_copy(_numbers_in(data, {dtype}, {count}, {begin}))"

    def no_numbers(self, scalar: str) -> str:
        """An array of numpy without elements."""
        name = f"_none_{'b1' if scalar == 'bool' else NUMPY[scalar][1]}"
        self.loads.add(name)
        return f"{name}()"

    def place(self, place: nodes.Place, scalar: str, row: Callable[[], str]) -> str:
        """A scalar at a place of a kernel; ``row`` is the text of its row."""
        if place.lane in self.direct.elements:
            return self.element(place.lane, self.direct.elements[place.lane].index(place))
        return self.field(place.lane, row(), place.offset, scalar)

    def truth_of(self, place: nodes.Place) -> str | None:  # noqa: ARG002 - of objects
        """What stands for a bool of an object."""
        return None

    def element(self, lane: int, number: int) -> str:
        """The local for an element of an array that has few."""
        return self.locals.identifier(f"{self.lanes.rows(lane)}\0{number}")

    def own(self, lane: int, offset: int, scalar: str) -> str:
        """The local for a field of the row that a loop fills."""
        path = self.lanes.field(lane, "", offset, scalar)
        return self.locals.identifier(f"{self.lanes.rows(lane)}\0{offset}" if path is None else re.sub(r"\W+", ".", path).strip("."))

    def text(self, lane: int, offset: int) -> str:
        """The local for a text that is decoded where it is checked, or the attribute."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        start = flat_name(self.lanes, offset, "i64") if lane == 0 else self.own(lane, offset, "i64")
        return self.locals.identifier(f"{start.removesuffix('_start')}\0text")

    def placed(self, lane: int, offset: int) -> str:
        """The texts of a field of the rows of a lane, by their places in the message."""
        return self.locals.identifier(f"{self.own(lane, offset, 'i64').removesuffix('_start')}\0texts")

    def visited(self, visit: Visit) -> str:
        """The list of the messages, of a type that contains itself, that fill a span."""
        return self.locals.identifier(f"{self.lanes.rows(visit.lane)}\0list")

    def reader(self, lane: int) -> str:
        """The function that reads such a message of a lane."""
        return f"_read_{self.lanes.rows(lane)}"

    def piece(self, lane: int, offset: int) -> str:
        """The local for bytes that are taken where a statement says where they are, or the attribute."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        return self.locals.identifier(f"{self.text(lane, offset).removesuffix('_text')}\0bytes")

    def has_field(self, name: str) -> str:
        """The local that says whether the message has a late field."""
        return self.locals.identifier(f"has\0{name}")

    def any_lists(self, group: int) -> str:
        """The local that says whether the message has any list of a group."""
        return self.locals.identifier(f"any\0lists\0{group}")

    def field(self, lane: int, row: str, offset: int, scalar: str) -> str:
        """A scalar of a row."""
        if lane == 0 and self.attributes and offset in self.attributes:
            return self.attributes[offset]
        if lane in self.direct.elements:
            offsets = sorted({each.offset for each in self.direct.elements[lane]})
            return self.element(lane, int(row) * len(offsets) + offsets.index(offset))
        if lane == 0 and self.flat:
            name = flat_name(self.lanes, offset, scalar)
            self.rows.add(name)
            self.offsets[name] = offset
            if scalar in FLOATS or scalar == "bool":
                (self.bools if scalar == "bool" else self.floats).add(name)
            return name
        if (unpacked := self.unpacked.get((lane, row))) is not None:
            unpacked[offset] = scalar
            self.bools |= {self.own(lane, offset, scalar)} if scalar == "bool" else set()
        if lane in self.direct.appended or lane in self.direct.whole or unpacked is not None:
            return self.own(lane, offset, scalar)
        width, stride = nodes.WIDTH[scalar], self.lanes.stride(lane)
        return f"{self.view(lane, CODES[scalar])}[{scaled(row, stride // width, offset // width)}]"


def view_name(lanes: Lanes, lane: int, code: str) -> str:
    """What views of lanes are called."""
    name = lanes.rows(lane)
    return f"{name}_{code}" if code else name


def flat_name(lanes: Lanes, offset: int, scalar: str) -> str:
    """The local for a field of the message's row."""
    path = lanes.field(0, "0", offset, scalar)
    return f"m_{offset}" if path is None else f"m_{lanes.renamed.get(offset) or joined(path.partition('->')[2])}"


def scaled(row: str, times: int, offset: int) -> str:
    """The number of what lies at an offset of a row, of so many each."""
    text = row if times == 1 else "0" if row == "0" else f"{row} * {times}"
    if text == "0":
        return str(offset)
    return f"{text} + {offset}" if offset else text
