"""The kernel that is being written: its current block, the position in the message, fresh names, and sites of failure."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager

from rosetta_jit.kernel import ir, nodes, state
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, type_of
from rosetta_jit.kernel.walk import subexpressions
from rosetta_jit.lowering.limits import MAX_SIZE, MAX_STATEMENTS
from rosetta_jit.startup.dataclass import dataclass, field, replace


class TooManyStatementsError(Exception):
    """A program beyond `MAX_STATEMENTS`, which it says; never leaves the pipeline."""


@dataclass(frozen=True, slots=True)
class References:
    """Lanes that are to be the message itself: spans of bytes then say where in the message they are, and nothing is copied.

    Attributes
    ----------
    found
        Lanes whose spans refer to the message.
    copied
        Lanes that bytes are copied to as usual, because rules write to them, too.
    """

    found: set[int] = field(default_factory=set[int])
    copied: frozenset[int] = frozenset()


@dataclass(slots=True)
class Tally:
    """How many statements a program has so far, its routines included."""

    statements: int = 0

    def add(self, count: int) -> None:
        """So many more, or TooManyStatementsError."""
        self.statements += count
        if self.statements > MAX_STATEMENTS:
            raise TooManyStatementsError(f"{MAX_STATEMENTS:,}")


@dataclass(frozen=True, slots=True)
class Where:
    """The field that is being read or written: its path with a ``{}`` for each index, and the indices."""

    path: str = ""
    indices: tuple[nodes.Expr, ...] = ()

    def member(self, name: str) -> Where:
        """A field of it."""
        return replace(self, path=f"{self.path}.{_escape(name)}") if name else self

    def members(self, names: tuple[str, ...]) -> Where:
        """A field of a field of it."""
        where = self
        for name in names:
            where = where.member(name)
        return where

    def element(self, at: nodes.Expr) -> Where:
        """An element of it. Only so many indices are reported; deeper ones show as ``[]``."""
        if len(self.indices) == state.INDEX_WORDS:
            return replace(self, path=f"{self.path}[]")
        return Where(f"{self.path}[{{}}]", (*self.indices, at))


MESSAGE = Where()
"""The message as a whole."""


@dataclass(frozen=True, slots=True)
class Contract:
    """What a routine is given and gives, and what holds of it: see `kernel.ir.Routine`."""

    parameters: tuple[nodes.Local, ...]
    results: tuple[nodes.Local, ...]
    requires: tuple[nodes.Expr, ...]
    ensures: tuple[nodes.Expr, ...]


@dataclass(slots=True)
class Writer:
    """Collects statements. ``position`` is always a local plus a constant; alignment counts from ``origin``.

    ``strides`` are those of the holder's lanes, and then of the ``hidden`` ones, which are known by a name. ``registers`` are
    variables with what registers hold from the next message on. ``certain`` are conditions that hold since the bounds of a loop say so,
    which are not asked, and checks that cannot fail for the same reason. ``texts_stay``: a decoder that borrows leaves the texts of tagged
    messages where they are, too, as it does with all others. ``rows_in_order``: see `rosetta_jit.lowering.lower`.
    """

    direction: nodes.Direction
    strides: list[int] = field(default_factory=list[int])
    hidden: dict[str, int] = field(default_factory=dict[str, int])
    block: list[nodes.Stmt] = field(default_factory=list[nodes.Stmt])
    around: list[list[nodes.Stmt]] = field(default_factory=list["list[nodes.Stmt]"])
    position: nodes.Expr = BEGIN
    origin: nodes.Expr = BEGIN
    sites: dict[ir.Site, int] = field(default_factory=lambda: {ir.Site("grow", "", "a lane is too small"): 0})
    names: set[str] = field(default_factory=lambda: {BEGIN.name, END.name, ROW.name})
    stems: dict[str, int] = field(default_factory=dict[str, int])
    deferred: list[Callable[[], None]] = field(default_factory=list["Callable[[], None]"])
    routines: dict[str, ir.Routine] = field(default_factory=dict[str, ir.Routine])
    tally: Tally = field(default_factory=Tally)
    references: References | None = None
    texts_stay: bool = False
    rows_in_order: bool = False
    registers: dict[int, nodes.Local] = field(default_factory=dict[int, nodes.Local])
    certain: set[nodes.Expr | nodes.Stmt] = field(default_factory=set["nodes.Expr | nodes.Stmt"])

    def left_in_message(self, lane: int, size: nodes.Expr) -> nodes.Expr | None:
        """The count of a span whose bytes stay in the message; None if they are to be copied. Its sign says whose bytes they are, unless
        the whole lane becomes the message.
        """
        if self.references is None:
            return nodes.Binary("sub", index(-1), size)
        if lane in self.references.copied:
            return None
        self.references.found.add(lane)
        return size

    def lane(self, name: str, stride: int) -> int:
        """The hidden lane of a name: for whatever a kernel must keep that the holder has no field for."""
        if name not in self.hidden:
            self.hidden[name] = len(self.strides)
            self.strides.append(stride)
        return self.hidden[name]

    @contextmanager
    def whole(self) -> Generator[None]:
        """Around a message or an element: what must be checked when all its fields are known is checked at the end."""
        outer, self.deferred = self.deferred, []
        yield
        for check in self.deferred:
            check()
        self.deferred = outer

    @contextmanager
    def origin_here(self) -> Generator[None]:
        """Around what counts its alignment from its own begin."""
        outer, self.origin = self.origin, self.let("origin", self.position)
        yield
        self.origin = outer

    def emit(self, *statements: nodes.Stmt) -> None:
        self.tally.add(len(statements))
        self.block.extend(statements)

    def fresh(self, stem: str) -> str:
        """A name not used before in this kernel."""
        name = stem
        while name in self.names:
            self.stems[stem] = self.stems.get(stem, 1) + 1
            name = f"{stem}_{self.stems[stem]}"
        self.names.add(name)
        return name

    def let(self, stem: str, value: nodes.Expr) -> nodes.Local:
        local = nodes.Local(type_of(value), self.fresh(stem))
        self.emit(nodes.Let(local.name, value))
        return local

    def var(self, stem: str, value: nodes.Expr) -> nodes.Local:
        local = nodes.Local(type_of(value), self.fresh(stem))
        self.emit(nodes.Var(local.name, value))
        return local

    def assign(self, variable: nodes.Local, value: nodes.Expr) -> None:
        self.emit(nodes.Assign(variable.name, value))

    @contextmanager
    def nested(self) -> Generator[list[nodes.Stmt]]:
        """A block of its own; the position within it starts where it is now and is put back afterwards."""
        outer, position = self.block, self.position
        self.block = inner = []
        self.around.append(outer)
        try:
            yield inner
        finally:
            self.block, self.position = outer, position
            self.around.pop()

    def is_around(self, block: list[nodes.Stmt]) -> bool:
        """Whether a block is the one that is being written, or around it: what it has computed is known."""
        return any(each is block for each in (self.block, *self.around))

    # --- failing -----------------------------------------------------------------------------------------------------

    def failure(self, kind: str, where: Where, detail: str, *, at: nodes.Expr | None = None, line: str = "") -> nodes.Failure:
        site = ir.Site(kind, where.path, detail, line)
        return nodes.Failure(self.sites.setdefault(site, len(self.sites)), self.position if at is None else at, where.indices)

    def expect(self, condition: nodes.Expr, kind: str, where: Where, detail: str, *, at: nodes.Expr | None = None, line: str = "") -> None:
        if not self.certain or condition not in self.certain:
            self.emit(nodes.Expect(condition, self.failure(kind, where, detail, at=at, line=line)))

    def require(self, size: nodes.Expr | int, where: Where, detail: str = "the message ends here", *, at: nodes.Expr | None = None) -> None:
        """The next bytes, or those at a place, are there."""
        size = index(size) if isinstance(size, int) else size
        place = self.position if at is None else at
        kind = "truncated" if self.direction == "decode" else "length"
        if self.direction != "size":
            self.emit(nodes.Require(place, size, self.failure(kind, where, detail, at=place)))

    # --- routines ----------------------------------------------------------------------------------------------------

    def parameter(self, name: str, type_: nodes.Scalar) -> nodes.Local:
        """A parameter of the routine that is being written."""
        return nodes.Local(type_, self.fresh(name))

    def within(self, at: nodes.Expr) -> tuple[nodes.Expr, nodes.Expr]:
        """The claim that a place lies in the message."""
        return nodes.Compare("ge", at, BEGIN), nodes.Compare("le", at, END)

    def behind(self, at: nodes.Expr, after: nodes.Expr) -> tuple[nodes.Expr, ...]:
        """The claim that one place of the message lies behind another."""
        return *self.within(after), nodes.Compare("gt", after, at)

    def call(
        self, name: str, make: Callable[[Writer], Contract], arguments: tuple[nodes.Expr, ...], where: Where
    ) -> tuple[nodes.Local, ...]:
        """The results of a routine, which is made, with a writer of its own, where it is first called."""
        if name not in self.routines:
            inner = Writer(self.direction, self.strides, self.hidden, routines=self.routines, tally=self.tally)
            made = make(inner)
            self.routines[name] = ir.Routine(
                name, made.parameters, made.results, block(inner.block), made.requires, made.ensures, tuple(inner.sites)
            )
        routine = self.routines[name]
        sites = tuple(self.failure(site.kind, where, site.detail).site for site in routine.sites[1:])
        results = tuple(nodes.Local(each.type, self.fresh(each.name)) for each in routine.results)
        self.emit(nodes.Call(name, arguments, results, sites, where.indices))
        return results

    # --- moving on ---------------------------------------------------------------------------------------------------

    def advance(self, size: nodes.Expr | int) -> None:
        """Move on by bytes that were required before; a size that is not constant gets a local of its own."""
        moved = add(self.position, size)
        if isinstance(size, int | nodes.Const):
            self.position = moved
            return
        self.position = self.let("at", moved)
        if self.direction == "size":
            self.bound_size()

    def settle(self) -> None:
        """Where positions are sums of sizes: check the sum so far, so that a loop may add to it."""
        if self.direction == "size" and not isinstance(self.position, nodes.Const):
            self.position = self.let("at", self.position)
            self.bound_size()

    def cursor(self, stem: str = "next") -> nodes.Local:
        """A variable that starts at the current position."""
        self.settle()
        return self.var(stem, self.position)

    def position_invariant(self, at: nodes.Local) -> tuple[nodes.Expr, ...]:
        """The invariant of a position: it lies between the begin and the end, or is small enough to add to."""
        if self.direction == "size":
            return nodes.Compare("ge", at, index(0)), nodes.Compare("le", at, index(MAX_SIZE))
        return nodes.Compare("ge", at, BEGIN), nodes.Compare("le", at, END)

    def bound_size(self) -> None:
        """Keep a sum of sizes far from wrapping."""
        self.expect(nodes.Compare("le", self.position, index(MAX_SIZE)), "length", Where(), "the message would be larger than any memory")

    def load(self, scalar: nodes.Scalar, where: Where, order: str = "<") -> nodes.Expr:
        """The next scalar of the message."""
        self.require(nodes.WIDTH[scalar], where)
        value = nodes.Load(scalar, self.position, ">" if order == ">" else "<")
        self.advance(nodes.WIDTH[scalar])
        return value

    def store(self, value: nodes.Expr, where: Where, order: str = "<") -> None:
        """Write the next scalar of the message, or count its bytes."""
        width = nodes.WIDTH[type_of(value)]
        if self.direction == "encode":
            self.require(width, where, "no room for the message")
            self.emit(nodes.Store(self.position, value, ">" if order == ">" else "<"))
        self.advance(width)

    def once(self, value: nodes.Expr) -> nodes.Expr:
        """A value that is used more than once."""
        return self.let("value", value) if is_new_each_time(value) else value

    def checked(self, op: str, left: nodes.Expr, right: nodes.Expr, where: Where, *, line: str = "") -> nodes.Expr:
        """An i64 operation that must not wrap."""
        match op:
            case "add" | "sub" | "mul":
                left, right = self.once(left), self.once(right)
                self.expect(nodes.Fits(op, left, right), "range", where, "a number grows beyond 64 bits", line=line)
                return self.let("sum" if op != "mul" else "product", nodes.Binary(op, left, right))
            case _:
                raise AssertionError(op)


def is_new_each_time(expr: nodes.Expr) -> bool:
    """Whether the proof takes an expression for another number wherever it stands: it looks at memory, or rests on a float or a bool."""
    return any(
        isinstance(part, nodes.Load | nodes.Get | nodes.Select)
        or (isinstance(part, nodes.Convert) and type_of(part.operand) in ("bool", "f32", "f64"))
        for part in subexpressions(expr)
    )


def integer(value: nodes.Expr) -> nodes.Expr:
    """A number as an i64."""
    match value:
        case nodes.Const(_, number):
            return index(int(number))
        case _:
            return value if type_of(value) == "i64" else nodes.Convert("i64", value)


def block(statements: list[nodes.Stmt]) -> nodes.Block:
    """Statements as a block."""
    return tuple(statements)


def _escape(name: str) -> str:
    """A field's name in a template of `str.format`."""
    return name.replace("{", "{{").replace("}", "}}")
