"""The fields of a wire that a mapping relates to another type: found by the walk, used by the rules.

Decoding binds each number to a local, each blob to its place and size, each array to the place of its first element, the distance
between elements, and their count; so, too, arrays and bytes of fixed length in elements of one size. Encoding asks the rules for
numbers and sizes, and binds the places of elements, which the rules fill afterwards. In the alternatives of a `Choice` the same fields
are bound in each, so they become variables.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from rosetta_jit.kernel.nodes import Const, Copy, Expr, Local, Place, Scalar, Wire
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.lowering.codec.fields import Stored, scalar_name
from rosetta_jit.lowering.writer import MESSAGE, Where, Writer
from rosetta_jit.model import expr
from rosetta_jit.model.walk import names_of, parts
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.wire.codec import Blob, Choice, Codec, Computed, Count, Number, Path, Repeat, Seq, Table
from rosetta_jit.wire.size import fixed_size

EACH = "[]"
"""In a path, stands for any element of the array before it."""


class AssignedValues(Protocol):
    """The values that rules assign, for a walk that encodes."""

    def number(self, path: Path) -> Expr:
        """The value of a number."""
        ...

    def size(self, path: Path) -> Expr:
        """The count of an array, string or blob."""
        ...

    def bytes_at(self, path: Path) -> Place | None:
        """Where the bytes of a blob come from, if from one place."""
        ...


@dataclass(frozen=True, slots=True)
class Fixed:
    """An array of fixed length: how many elements it has, and how many bytes it is from one to the next."""

    length: int
    step: int


@dataclass(frozen=True, slots=True)
class Region:
    """Elements of one size, or bytes: where the first lies, how far apart they are; ``inner`` are the arrays within each element."""

    first: Expr
    step: Expr
    scalar: Scalar
    order: str = "<"
    inner: tuple[Fixed, ...] = ()


@dataclass(slots=True)
class Found:
    """What the walk has bound, by absolute path."""

    numbers: dict[Path, Expr] = field(default_factory=dict[Path, Expr])
    counts: dict[Path, Expr] = field(default_factory=dict[Path, Expr])
    regions: dict[Path, Region] = field(default_factory=dict[Path, Region])
    variables: dict[tuple[Path, str], Local] = field(default_factory=dict[tuple[Path, str], Local])


@dataclass(frozen=True, slots=True)
class WireFields:
    """Fields of the wire, below ``path``; of an ``element`` only what is checked, for rules read and write it in its place."""

    writer: Writer
    found: Found
    assigned: AssignedValues | None = None
    path: Path = ()
    where: Where = MESSAGE
    element: bool = False
    passing: dict[Path, Expr] = field(default_factory=dict[Path, Expr])
    outer: WireFields | None = None

    def shown(self, path: Path) -> Where:
        return self.where.members(path)

    def put(self, path: Path, value: Expr) -> None:
        key = self.path + path
        if self.element:
            self.passing[path] = self.writer.let(_stem(key, "value"), value)  # what comes later in the element may depend on it
        else:
            self.found.numbers[key] = self.bind(key, "value", value)

    def get(self, path: Path) -> Expr | None:
        key = self.path + path
        if key in self.found.numbers:
            return self.found.numbers[key]
        if self.element:
            return self.passing.get(path)
        self.found.numbers[key] = self.bind(key, "value", self.assigned_at(key).number(key))
        return self.found.numbers[key]

    def put_bytes(self, path: Path, at: Expr, size: Expr) -> None:
        if not self.element:
            self.bind_bytes(self.path + path, at, size)

    def size_of(self, path: Path) -> Expr:
        key = self.path + path
        if key not in self.found.counts:
            self.found.counts[key] = self.bind(key, "count", self.assigned_at(key).size(key))
        return self.found.counts[key]

    def stored(self, path: Path, fixed: int | None = None) -> Stored:
        if fixed is not None:
            self.found.counts[self.path + path] = index(fixed)
        return Stored(self.size_of(path))

    def copy_bytes(self, path: Path, stored: Stored) -> None:
        key = self.path + path
        source = self.assigned_at(key).bytes_at(key)
        if source is None:
            self.bind_bytes(key, self.writer.position, stored.size)
        else:
            self.writer.emit(Copy(Wire(self.writer.position), source, stored.size))

    def open(self, path: Path, count: Expr) -> WireElements:
        key = self.path + path
        self.found.counts[key] = self.bind(key, "count", count)
        return WireElements(self, key, self.shown(path))

    def elements(self, path: Path, stored: Stored) -> WireElements:
        del stored
        return WireElements(self, self.path + path, self.shown(path))

    def branch(self, choice: Choice) -> None:
        """Declare the variables that every alternative is going to bind, and bind what all of them are going to read."""
        if not self.element:
            for _, codec in choice.alternatives:
                self.declare(codec, ())
            if self.assigned is None:
                return
            for path in dict.fromkeys(path for _, codec in choice.alternatives for path in numbers_of_counts(codec)):
                if (self.path + path, "value") not in self.found.variables:
                    self.get(path)

    def assigned_at(self, key: Path) -> AssignedValues:
        """Where an encoding walk gets its values; a decoding one has bound what rules read."""
        assert self.assigned is not None, key
        return self.assigned

    def choose(self, path: Path, number: int) -> None:
        raise AssertionError(path, number)

    def scatter(self, path: Path) -> None:
        raise AssertionError(path)

    def appear(self, path: Path) -> None:
        raise AssertionError(path)

    def present(self, path: Path) -> Expr:
        raise AssertionError(path)

    @property
    def scope(self) -> WireFields:
        """An element of which nothing has come is no struct, but an array in an array: its length is told further out."""
        return self if self.passing or self.outer is None else self.outer.scope

    # --- binding -----------------------------------------------------------------------------------------------------

    def bind(self, key: Path, role: str, value: Expr) -> Expr:
        """A name for a value: assigned where an alternative binds it, else new."""
        variable = self.found.variables.get((key, role))
        if variable is not None:
            self.writer.assign(variable, value)
            return variable
        return value if isinstance(value, Const) else self.writer.let(_stem(key, role), value)

    def bind_bytes(self, key: Path, at: Expr, size: Expr) -> None:
        self.found.counts[key] = self.bind(key, "count", size)
        self.found.regions[(*key, EACH)] = Region(self.bind((*key, EACH), "first", at), index(1), "u8")

    def bind_leaf(self, key: Path, leaf: Leaf, first: Expr, step: int) -> None:
        """A number of an element: where it lies in the first, and how far to the next."""
        start = self.bind(key, "first", add(first, leaf.offset))
        self.found.regions[key] = Region(start, self.bind(key, "step", index(step)), leaf.scalar, leaf.order, leaf.inner)

    def declare(self, codec: Codec, prefix: Path) -> None:
        match codec:
            case Seq(items):
                for item in items:
                    self.declare(item, prefix)
            case Choice(_, _, alternatives):
                for _, each in alternatives:
                    self.declare(each, prefix)
            case Number(path, scalar, _) | Computed(path, scalar, _, _):
                self.variable(prefix + path, "value", Const(scalar_name(scalar), 0))
            case Table(path):
                self.variable(prefix + path, "value", index(0))
            case Blob(path, _, _, _):
                self.variable(prefix + path, "count", index(0))
                self.variable((*prefix, *path, EACH), "first", index(0))
            case Repeat(path, _, item):
                self.variable(prefix + path, "count", index(0))
                for leaf in leaves(item):
                    self.variable((*prefix, *path, EACH, *leaf.path), "first", index(0))
                    self.variable((*prefix, *path, EACH, *leaf.path), "step", index(0))
            case _:
                pass

    def variable(self, path: Path, role: str, zero: Const) -> None:
        key = self.path + path
        if (key, role) not in self.found.variables:
            self.found.variables[key, role] = self.writer.var(_stem(key, role), zero)


@dataclass(frozen=True, slots=True)
class WireElements:
    """Elements of an array of the wire."""

    parent: WireFields
    key: Path
    where: Where

    def place(self, item: Codec, first: Expr, step: int) -> WireElements:
        if self.parent.element:
            return self  # bound with the elements around it, if ever
        for leaf in leaves(item):
            self.parent.bind_leaf((*self.key, EACH, *leaf.path), leaf, first, step)
        if self.parent.assigned is None and (self.key, "count") not in self.parent.found.variables:
            for leaf in inner_leaves(item):
                self.parent.bind_leaf((*self.key, EACH, *leaf.path), leaf, first, step)
        return self

    def at(self, number: Expr) -> WireFields:
        return replace(self.parent, path=(*self.key, EACH), where=self.where.element(number), element=True, passing={}, outer=self.parent)


@dataclass(frozen=True, slots=True)
class Leaf:
    """A number at a fixed offset of an element, or the first of arrays of fixed length within it."""

    path: Path
    offset: int
    scalar: Scalar
    order: str
    inner: tuple[Fixed, ...] = ()


def leaves(item: Codec) -> list[Leaf]:
    """The numbers of an element of one size. One that needs translation (`Table`) is none: rules cannot use it in its place."""
    return [leaf for leaf in _leaves(item) if not leaf.inner]


def inner_leaves(item: Codec) -> list[Leaf]:
    """The numbers in arrays of fixed length within an element of one size; bytes are such an array."""
    return [leaf for leaf in _leaves(item) if leaf.inner]


def _leaves(item: Codec, offset: int = 0) -> Iterator[Leaf]:
    match item:
        case Number(path, scalar, order):
            yield Leaf(path, offset, scalar_name(scalar), order)
        case Blob(path, Count(None, _, int(length)), terminated=False):
            yield Leaf((*path, EACH), offset, "u8", "<", (Fixed(length, 1),))
        case Repeat(path, Count(None, _, int(length)), element, (), 0):
            step = fixed_size(element)
            for leaf in _leaves(element, offset) if step is not None else ():
                yield replace(leaf, path=(*path, EACH, *leaf.path), inner=(Fixed(length, step or 0), *leaf.inner))
        case Seq(items) if fixed_size(item) is not None:
            for each in items:
                yield from _leaves(each, offset)
                offset += fixed_size(each) or 0
        case _:
            pass


def _stem(key: Path, role: str) -> str:
    name = "_".join(part for part in key if part != EACH) or "message"
    return name if role == "value" else f"{name}_{role}"


def numbers_of_counts(codec: Codec) -> Iterator[Path]:
    """The numbers by which a codec tells counts."""
    match codec:
        case Seq(items):
            for item in items:
                yield from numbers_of_counts(item)
        case Repeat(_, count, _) | Blob(_, count, _, _) if count.value is not None and not isinstance(count.value, int):
            yield from (names_of(part) for part in parts(count.value) if isinstance(part, expr.Path))
        case _:
            pass
