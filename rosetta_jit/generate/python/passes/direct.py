"""What becomes lists and strings where a decoder finds it: what `search` has found, for those who print it."""

from __future__ import annotations

from rosetta_jit.generate.passes.descents import Visit
from rosetta_jit.generate.python.passes.late_fields import LateField
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.walk import expressions_of
from rosetta_jit.model.layout import Row, Slot, Span
from rosetta_jit.model.types import Struct
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class LateRow:
    """The type of the rows of a lane that has many lists, which an object of such a row gets when somebody asks for one."""

    struct: Struct
    slot: Row
    lists: tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class Marked:
    """The lists of rows of a type that contains itself, by their offsets; one of them starts at no 0 in rows that have any of them."""

    mark: int
    offsets: tuple[int, ...]


MOST_GROUPS = 10
"""Each set of groups that objects lack has a class, which is made when the first such object comes."""
OF_GROUP = 8
"""Lists of a group, at least: of larger ones more are made that nobody asked for, more groups take longer to look at."""


def groups_of(lists: tuple[Span, ...]) -> tuple[tuple[Span, ...], ...]:
    """Lists in groups, of which an object has all or none."""
    number = min(max(len(lists) // OF_GROUP, 1), MOST_GROUPS)
    size = -(-len(lists) // number)
    return tuple(lists[at : at + size] for at in range(0, len(lists), size or 1))


@dataclass(slots=True)
class Direct:
    """What becomes objects at once in a body.

    ``whole`` are lanes that are read by one call, ``appended`` those whose rows are appended to a list, ``loops`` the variables of the
    loops that do so; ``elements`` are the places of rows that are locals, by lane; ``texts`` are the spans of texts that are decoded where
    they are checked, by lane and offset, with the place and size of the check: ``late`` are those of them that may not come.
    ``pieces`` are spans of bytes, with their place and size: they are taken where a statement sets where they start.
    ``gathered`` are lanes of texts and of bytes, with the place and size of one in the message: it is appended where a statement sets where
    it starts. ``listed`` are the lanes of texts that are appended where they are checked.
    ``visits`` are the calls of `Descents` by name, whose rows become lists; of messages within others ``left`` has the lanes
    that all of them share, by number: a list says how many more rows each may have; ``checks`` is what is checked of the count of a visit
    where there are any. ``late_rows`` are the rows, by lane, that say whether they have any list; ``marked`` those of types that contain
    themselves (`rows_of_pieces`).
    """

    whole: set[int] = field(default_factory=set[int])
    appended: set[int] = field(default_factory=set[int])
    loops: dict[str, int] = field(default_factory=dict[str, int])
    elements: dict[int, list[nodes.Place]] = field(default_factory=dict[int, "list[nodes.Place]"])
    texts: dict[tuple[int, int], tuple[nodes.Expr, nodes.Expr]] = field(
        default_factory=dict[tuple[int, int], "tuple[nodes.Expr, nodes.Expr]"]
    )

    late: set[tuple[int, int]] = field(default_factory=set[tuple[int, int]])
    pieces: dict[tuple[int, int], tuple[nodes.Expr, nodes.Expr]] = field(
        default_factory=dict[tuple[int, int], "tuple[nodes.Expr, nodes.Expr]"]
    )
    gathered: dict[int, tuple[nodes.Expr, nodes.Expr]] = field(default_factory=dict[int, "tuple[nodes.Expr, nodes.Expr]"])
    listed: set[int] = field(default_factory=set[int])
    visits: dict[str, Visit] = field(default_factory=dict[str, Visit])
    left: dict[int, int] | None = None
    checks: dict[str, nodes.Block] = field(default_factory=dict[str, "nodes.Block"])
    rows: dict[int, dict[nodes.Place, tuple[nodes.Expr, nodes.Expr]]] = field(
        default_factory=dict[int, "dict[nodes.Place, tuple[nodes.Expr, nodes.Expr]]"]
    )
    placed: dict[tuple[int, int], tuple[nodes.Expr, nodes.Expr]] = field(
        default_factory=dict[tuple[int, int], "tuple[nodes.Expr, nodes.Expr]"]
    )
    fields: tuple[LateField, ...] = ()
    late_rows: dict[int, LateRow] = field(default_factory=dict[int, LateRow])
    marked: dict[int, Marked] = field(default_factory=dict[int, Marked])

    def read(self) -> set[str]:
        """The locals that say where texts and bytes are, which no statement may say any more, and those of checks."""
        rows = (place for each in self.rows.values() for place in each.values())
        spans = (*self.texts.values(), *self.placed.values(), *self.pieces.values(), *self.gathered.values(), *rows)
        checks = (expr for block in self.checks.values() for stmt in block for expr in expressions_of(stmt))
        return {name for expr in (*checks, *(expr for place in spans for expr in place)) for name in locals_in(expr)}

    def visit_at(self, lane: int, offset: int) -> Visit | None:
        """What fills the span of a row."""
        places = ((each, each.place) for each in self.visits.values())
        return next((each for each, place in places if place is not None and (place.lane, place.offset) == (lane, offset)), None)

    def late_at(self, slot: Slot) -> LateField | None:
        """The late field at a slot of the message's row."""
        return next((each for each in self.fields if each.slot is slot), None)

    def text_at(self, at: nodes.Expr, size: nodes.Expr) -> tuple[int, int] | None:
        """The span of the text that is checked there."""
        return next((span for span, place in (*self.texts.items(), *self.placed.items()) if place == (at, size)), None)
