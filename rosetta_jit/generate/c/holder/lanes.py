"""How the lanes of a holder are reached from C.

    message         the row of lane 0           position[i]     a row of another lane, through a pointer of the function's own
    position_used   how many rows are in use    scratch_2       bytes of a hidden lane

A `Lane` whose element is None has no fields that C knows: it is bytes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from rosetta_jit.generate.c.holder.rows import Element, SpanType, Struct, path_to
from rosetta_jit.generate.c.holder.within import Within
from rosetta_jit.generate.c.words import C_ROWS, RESERVED
from rosetta_jit.kernel.nodes import Expr, For
from rosetta_jit.startup.dataclass import dataclass, field

OWN_WORDS = frozenset(
    {
        "message",
        "now",
        "number",
        "state",
        "scratch",
        "holder",
        "bytes",
        "codec",
        "most",
        "end",
        "failure",
        "size",
        "error",
        "problem",
        "given_row",
        "given_object",
        "given_lengths",
        "given_longer",
        "given_place",
        "given_waits",
        "gathered",
        "kept",
    }
)
"""What the functions call their parameters, and the holder its other members."""

WORD = 8
"""Bytes of a row that is a 64-bit integer."""

Dialect = Literal["c", "c++"]
"""What compiles the functions."""


@dataclass(frozen=True, slots=True)
class Lane:
    """One lane: its member of the holder, the local pointer and the local count of rows in use."""

    identifier: str
    used: str
    stride: int
    element: Element | None


@dataclass(frozen=True, slots=True)
class Straight:
    """The statement that sets a field where an object has it.

    It stands for `$value`, a number; or of a ``text`` for `$start` and `$size`, which say where it is in the message; or for the `$count`
    of a list, whose elements are those of ``lane`` from then on. `$index` is the number of the element that the field is of. Numbers that
    are elements themselves may be ``copied`` at once, too. ``empty`` is the statement for a list of the message that has no elements,
    ``checked`` the condition of a text that is set if its bytes are one.
    """

    statement: str
    lane: int = 0
    text: bool = False
    copied: bool = False
    empty: str = ""
    checked: str = ""

    @property
    def is_span(self) -> bool:
        """Whether it stands for both fields of a span."""
        return self.text or self.lane != 0


@dataclass(frozen=True, slots=True)
class Packed:
    """A loop that sets the elements of a list, which lie in the message as ``lies``, a condition, says that they do in an object.

    ``at`` is where the first one is there, ``size`` how many bytes each has. ``copy`` is the function that copies elements.
    """

    lane: int
    at: Expr
    size: int
    lies: str
    copy: str


@dataclass(frozen=True, slots=True)
class Given:
    """An array of an object, whose elements are rows: what gives it a `$count` of them, and the first one until then, if any is used."""

    sized: str
    rows: str = "nullptr"


@dataclass(frozen=True, slots=True)
class Lanes:
    """Those of a kernel; ``prefix`` begins the names of the header, ``own`` are not hidden. Those of C++ make room for themselves.

    The rows of ``addressed`` lanes are bytes anywhere in memory, by their addresses; those of ``viewed`` lanes are made of an object's
    elements when they are read, and so are those of lists ``within`` others. ``row``: the functions are given the message's row, or that of
    another lane that is their ``subject``; the rows of ``moving`` lanes may be elsewhere when a function has been called for a message.
    ``straight`` are the fields, by lane and offset, that no row keeps, as an object has them; the rows of ``opened`` lanes are elements of
    the object, and so are those of ``given`` ones, of which each message has one array. ``packed`` are loops that may copy all elements at
    once. ``shared`` begins the names of functions of the support, where they are those of a header. ``forward``: a message is written from
    its begin to its end, so that bytes behind those that are written are not in use. ``renamed`` are fields of the message's row, by
    offset, whose paths have, as one word, that of another one: what they are called as locals. ``messages`` are the lists of an object that
    functions read message by message where they are, by the lane and the offset of their spans.
    """

    prefix: str
    all: tuple[Lane, ...]
    own: int
    dialect: Dialect = "c"
    addressed: frozenset[int] = frozenset()
    viewed: frozenset[int] = frozenset()
    within: Mapping[int, Within] = field(default_factory=dict[int, "Within"])
    row: bool = False
    subject: int = 0
    moving: frozenset[int] = frozenset()
    straight: Mapping[tuple[int, int], Straight] = field(default_factory=dict[tuple[int, int], Straight])
    opened: frozenset[int] = frozenset()
    given: Mapping[int, Given] = field(default_factory=dict[int, "Given"])
    packed: Mapping[For, Packed] = field(default_factory=dict["For", "Packed"])
    shown: Mapping[tuple[int, int], str] = field(default_factory=dict[tuple[int, int], str])
    shared: str = ""
    forward: bool = True
    renamed: Mapping[int, str] = field(default_factory=dict[int, str])
    messages: Mapping[tuple[int, int], str] = field(default_factory=dict[tuple[int, int], str])

    def stride(self, lane: int) -> int:
        """Bytes of a row."""
        return self.all[lane].stride

    def rows(self, lane: int) -> str:
        """The local pointer to the rows."""
        return self.all[lane].identifier

    def used(self, lane: int) -> str:
        """The local variable that counts the rows in use."""
        return self.all[lane].used

    def capacity(self, lane: int) -> str:
        """How many rows there is room for."""
        if lane >= self.own:
            scratch, stride = f"holder->scratch[{lane - self.own}]", self.stride(lane)
            if self.dialect == "c++" and stride == WORD:
                return f"{scratch}.words"
            return f"{scratch}.size" if stride == 1 else f"({scratch}.size / {stride})"
        return "1" if lane == 0 else f"holder->{self.rows(lane)}.capacity"

    def member(self, lane: int) -> str:
        """The expression for the rows in the holder."""
        if lane >= self.own:
            return f"holder->scratch[{lane - self.own}].bytes"
        if lane == self.subject:
            return "&given_row" if self.row else "&holder->message"
        if lane in self.given:
            return self.given[lane].rows
        return f"holder->{self.rows(lane)}" if lane in self.viewed else f"holder->{self.rows(lane)}.rows"

    def pointer(self, lane: int) -> str:
        """The type of the local for the rows."""
        return "auto" if lane in self.opened | self.viewed else f"{self.type(lane)} *restrict"

    def grown(self, lane: int, missing: str) -> str | None:
        """The call that makes room for rows, and says whether it could; None where the caller's memory is all there is."""
        if self.dialect == "c":
            return None
        room = f"holder->scratch[{lane - self.own}]" if lane >= self.own else f"holder->{self.rows(lane)}"
        return f"{room}.grow({missing}, holder->most)"

    def type(self, lane: int) -> str:
        """The C type of a row."""
        return row_type(self.prefix, self.all[lane].element)

    def value_type(self, lane: int) -> str:
        """The type of the struct that a row of messages within others begins with."""
        element = self.all[lane].element
        assert isinstance(element, Struct)
        return row_type(self.prefix, element.members[0].type)

    def path(self, lane: int, offset: int, scalar: str) -> str | None:
        """How a scalar of a row is written behind the row, None where no member of that type lies there."""
        element = self.all[lane].element
        return None if element is None else path_to(element, offset, scalar)

    def field(self, lane: int, row: str, offset: int, scalar: str) -> str | None:
        """A scalar of a row by its name, None where no member of that type lies there."""
        path = self.path(lane, offset, scalar)
        if path is None:
            return None
        return f"{self.rows(lane)}->{path[1:]}" if lane == self.subject else f"{self.rows(lane)}[{row}]{path}"

    def objects(self, lane: int) -> str:
        """What reaches the messages of a lane where an object has them."""
        return f"{self.prefix}_{self.rows(lane)}_objects"

    def words(self) -> frozenset[str]:
        """All that no local of a kernel may be called."""
        return RESERVED | OWN_WORDS | {word for lane in self.all for word in (lane.identifier, lane.used)}


def row_type(prefix: str, element: Element | None) -> str:
    """The C type of a lane's rows."""
    match element:
        case None:
            return "unsigned char"
        case str():
            return C_ROWS[element]
        case SpanType():
            return f"{prefix}_span"
        case Struct():
            return element.identifier
