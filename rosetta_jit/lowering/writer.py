"""The kernel that is being written: its current block, the position in the message, fresh names, and sites of failure."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import field, replace

from rosetta_jit.kernel import ir, state
from rosetta_jit.kernel.terms import BEGIN, END, ROW, add, index, type_of
from rosetta_jit.kernel.walk import subexpressions
from rosetta_jit.lowering.limits import MAX_SIZE, MAX_STATEMENTS
from rosetta_jit.startup.dataclass import dataclass


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
    indices: tuple[ir.Expr, ...] = ()

    def member(self, name: str) -> Where:
        """A field of it."""
        return replace(self, path=f"{self.path}.{_escape(name)}") if name else self

    def members(self, names: tuple[str, ...]) -> Where:
        """A field of a field of it."""
        where = self
        for name in names:
            where = where.member(name)
        return where

    def element(self, at: ir.Expr) -> Where:
        """An element of it. Only so many indices are reported; deeper ones show as ``[]``."""
        if len(self.indices) == state.INDEX_WORDS:
            return replace(self, path=f"{self.path}[]")
        return Where(f"{self.path}[{{}}]", (*self.indices, at))


MESSAGE = Where()
"""The message as a whole."""


@dataclass(frozen=True, slots=True)
class Contract:
    """What a routine is given and gives, and what holds of it: see `kernel.ir.Routine`."""

    parameters: tuple[ir.Local, ...]
    results: tuple[ir.Local, ...]
    requires: tuple[ir.Expr, ...]
    ensures: tuple[ir.Expr, ...]


@dataclass(slots=True)
class Writer:
    """Collects statements. ``position`` is always a local plus a constant; alignment counts from ``origin``.

    ``strides`` are those of the holder's lanes, and then of the ``hidden`` ones, which are known by a name. ``registers`` are
    variables with what registers hold from the next message on. ``certain`` are conditions that hold since the bounds of a loop say so,
    which are not asked, and checks that cannot fail for the same reason.
    """

    direction: ir.Direction
    strides: list[int] = field(default_factory=list[int])
    hidden: dict[str, int] = field(default_factory=dict[str, int])
    block: list[ir.Stmt] = field(default_factory=list[ir.Stmt])
    around: list[list[ir.Stmt]] = field(default_factory=list["list[ir.Stmt]"])
    position: ir.Expr = BEGIN
    origin: ir.Expr = BEGIN
    sites: dict[ir.Site, int] = field(default_factory=lambda: {ir.Site("grow", "", "a lane is too small"): 0})
    names: set[str] = field(default_factory=lambda: {BEGIN.name, END.name, ROW.name})
    stems: dict[str, int] = field(default_factory=dict[str, int])
    deferred: list[Callable[[], None]] = field(default_factory=list["Callable[[], None]"])
    routines: dict[str, ir.Routine] = field(default_factory=dict[str, ir.Routine])
    tally: Tally = field(default_factory=Tally)
    references: References | None = None
    registers: dict[int, ir.Local] = field(default_factory=dict[int, ir.Local])
    certain: set[ir.Expr | ir.Stmt] = field(default_factory=set["ir.Expr | ir.Stmt"])

    def left_in_message(self, lane: int, size: ir.Expr) -> ir.Expr | None:
        """The count of a span whose bytes stay in the message; None if they are to be copied. Its sign says whose bytes they are, unless
        the whole lane becomes the message.
        """
        if self.references is None:
            return ir.Binary("sub", index(-1), size)
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

    def emit(self, *statements: ir.Stmt) -> None:
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

    def let(self, stem: str, value: ir.Expr) -> ir.Local:
        local = ir.Local(type_of(value), self.fresh(stem))
        self.emit(ir.Let(local.name, value))
        return local

    def var(self, stem: str, value: ir.Expr) -> ir.Local:
        local = ir.Local(type_of(value), self.fresh(stem))
        self.emit(ir.Var(local.name, value))
        return local

    def assign(self, variable: ir.Local, value: ir.Expr) -> None:
        self.emit(ir.Assign(variable.name, value))

    @contextmanager
    def nested(self) -> Generator[list[ir.Stmt]]:
        """A block of its own; the position within it starts where it is now and is put back afterwards."""
        outer, position = self.block, self.position
        self.block = inner = []
        self.around.append(outer)
        try:
            yield inner
        finally:
            self.block, self.position = outer, position
            self.around.pop()

    def is_around(self, block: list[ir.Stmt]) -> bool:
        """Whether a block is the one that is being written, or around it: what it has computed is known."""
        return any(each is block for each in (self.block, *self.around))

    # --- failing -----------------------------------------------------------------------------------------------------

    def failure(self, kind: str, where: Where, detail: str, *, at: ir.Expr | None = None, line: str = "") -> ir.Failure:
        site = ir.Site(kind, where.path, detail, line)
        return ir.Failure(self.sites.setdefault(site, len(self.sites)), self.position if at is None else at, where.indices)

    def expect(self, condition: ir.Expr, kind: str, where: Where, detail: str, *, at: ir.Expr | None = None, line: str = "") -> None:
        if condition not in self.certain:
            self.emit(ir.Expect(condition, self.failure(kind, where, detail, at=at, line=line)))

    def require(self, size: ir.Expr | int, where: Where, detail: str = "the message ends here", *, at: ir.Expr | None = None) -> None:
        """The next bytes, or those at a place, are there."""
        size = index(size) if isinstance(size, int) else size
        place = self.position if at is None else at
        kind = "truncated" if self.direction == "decode" else "length"
        if self.direction != "size":
            self.emit(ir.Require(place, size, self.failure(kind, where, detail, at=place)))

    # --- routines ----------------------------------------------------------------------------------------------------

    def parameter(self, name: str, type_: ir.Scalar) -> ir.Local:
        """A parameter of the routine that is being written."""
        return ir.Local(type_, self.fresh(name))

    def within(self, at: ir.Expr) -> tuple[ir.Expr, ir.Expr]:
        """The claim that a place lies in the message."""
        return ir.Compare("ge", at, BEGIN), ir.Compare("le", at, END)

    def behind(self, at: ir.Expr, after: ir.Expr) -> tuple[ir.Expr, ...]:
        """The claim that one place of the message lies behind another."""
        return *self.within(after), ir.Compare("gt", after, at)

    def call(self, name: str, make: Callable[[Writer], Contract], arguments: tuple[ir.Expr, ...], where: Where) -> tuple[ir.Local, ...]:
        """The results of a routine, which is made, with a writer of its own, where it is first called."""
        if name not in self.routines:
            inner = Writer(self.direction, self.strides, self.hidden, routines=self.routines, tally=self.tally)
            made = make(inner)
            self.routines[name] = ir.Routine(
                name, made.parameters, made.results, block(inner.block), made.requires, made.ensures, tuple(inner.sites)
            )
        routine = self.routines[name]
        sites = tuple(self.failure(site.kind, where, site.detail).site for site in routine.sites[1:])
        results = tuple(ir.Local(each.type, self.fresh(each.name)) for each in routine.results)
        self.emit(ir.Call(name, arguments, results, sites, where.indices))
        return results

    # --- moving on ---------------------------------------------------------------------------------------------------

    def advance(self, size: ir.Expr | int) -> None:
        """Move on by bytes that were required before; a size that is not constant gets a local of its own."""
        moved = add(self.position, size)
        if isinstance(size, int | ir.Const):
            self.position = moved
            return
        self.position = self.let("at", moved)
        if self.direction == "size":
            self.bound_size()

    def settle(self) -> None:
        """Where positions are sums of sizes: check the sum so far, so that a loop may add to it."""
        if self.direction == "size" and not isinstance(self.position, ir.Const):
            self.position = self.let("at", self.position)
            self.bound_size()

    def cursor(self, stem: str = "next") -> ir.Local:
        """A variable that starts at the current position."""
        self.settle()
        return self.var(stem, self.position)

    def position_invariant(self, at: ir.Local) -> tuple[ir.Expr, ...]:
        """The invariant of a position: it lies between the begin and the end, or is small enough to add to."""
        if self.direction == "size":
            return ir.Compare("ge", at, index(0)), ir.Compare("le", at, index(MAX_SIZE))
        return ir.Compare("ge", at, BEGIN), ir.Compare("le", at, END)

    def bound_size(self) -> None:
        """Keep a sum of sizes far from wrapping."""
        self.expect(ir.Compare("le", self.position, index(MAX_SIZE)), "length", Where(), "the message would be larger than any memory")

    def load(self, scalar: ir.Scalar, where: Where, order: str = "<") -> ir.Expr:
        """The next scalar of the message."""
        self.require(ir.WIDTH[scalar], where)
        value = ir.Load(scalar, self.position, ">" if order == ">" else "<")
        self.advance(ir.WIDTH[scalar])
        return value

    def store(self, value: ir.Expr, where: Where, order: str = "<") -> None:
        """Write the next scalar of the message, or count its bytes."""
        width = ir.WIDTH[type_of(value)]
        if self.direction == "encode":
            self.require(width, where, "no room for the message")
            self.emit(ir.Store(self.position, value, ">" if order == ">" else "<"))
        self.advance(width)

    def once(self, value: ir.Expr) -> ir.Expr:
        """A value that is used more than once."""
        return self.let("value", value) if is_new_each_time(value) else value

    def checked(self, op: str, left: ir.Expr, right: ir.Expr, where: Where, *, line: str = "") -> ir.Expr:
        """An i64 operation that must not wrap."""
        match op:
            case "add" | "sub" | "mul":
                left, right = self.once(left), self.once(right)
                self.expect(ir.Fits(op, left, right), "range", where, "a number grows beyond 64 bits", line=line)
                return self.let("sum" if op != "mul" else "product", ir.Binary(op, left, right))
            case _:
                raise AssertionError(op)


def is_new_each_time(expr: ir.Expr) -> bool:
    """Whether the proof takes an expression for another number wherever it stands: it looks at memory, or rests on a float or a bool."""
    return any(
        isinstance(part, ir.Load | ir.Get | ir.Select) or (isinstance(part, ir.Convert) and type_of(part.operand) in ("bool", "f32", "f64"))
        for part in subexpressions(expr)
    )


def integer(value: ir.Expr) -> ir.Expr:
    """A number as an i64."""
    match value:
        case ir.Const(_, number):
            return index(int(number))
        case _:
            return value if type_of(value) == "i64" else ir.Convert("i64", value)


def block(statements: list[ir.Stmt]) -> ir.Block:
    """Statements as a block."""
    return tuple(statements)


def _escape(name: str) -> str:
    """A field's name in a template of `str.format`."""
    return name.replace("{", "{{").replace("}", "}}")
