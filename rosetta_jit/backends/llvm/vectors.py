"""Stores side by side as one store of a vector, whose numbers are loaded and computed together.

    set lane 2[start].0 = f32((load f64< [begin + 8] * 0.0174:f64))
    set lane 2[start + 1].0 = f32((load f64< [begin + 16] * 0.0174:f64))

are a load, a product, a conversion and a store of two numbers each. LLVM has a pass that finds such statements (superword-level
parallelism); llvmlite offers it only as a part of levels of optimisation, which take five times as long as all that kernels need. Where
each element has a rule of its own, the statements stand there in order.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from llvmlite import ir

from rosetta_jit.backends.llvm import stmt as llvm_stmt
from rosetta_jit.backends.llvm.alike import Part as AnyPart
from rosetta_jit.backends.llvm.alike import Place, Series
from rosetta_jit.backends.llvm.expr import (
    FLOAT_BINARY,
    base_and_offset,
    expression,
    place_alignment,
    place_pointer,
    scalar_constant,
    wire_pointer,
)
from rosetta_jit.backends.llvm.frame import Frame
from rosetta_jit.backends.llvm.values import I32, LLVM_TYPES, intrinsic, is_float
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in, names_read
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.kernel.walk import operands, statements
from rosetta_jit.startup.dataclass import dataclass

SIZES = (8, 4, 2)
"""How many numbers a vector has, the best first."""

WIDEST = 32
"""The most bytes that are stored at once: some CPUs take their time before they store twice as many."""

DEEP = 32
"""How far what is stored is followed to what it is computed from."""

NUMBERS = frozenset(("f32", "f64", "i32", "i16", "i8"))
"""What vectors are made of. Integers only become floats: CPUs have instructions for these."""

BINARY = frozenset(("add", "sub", "mul", "div"))
INTRINSICS = {"abs": "fabs", "sqrt": "sqrt"}
UNARY = frozenset(("neg", *INTRINSICS))
"""What is computed of floats by one instruction."""


@dataclass(frozen=True, slots=True)
class Vector:
    """Numbers that are computed together: of the first one, what is done, and the vectors that it is done with.

    Where there are none, numbers lie side by side in memory, are constants, or are all the same local.
    """

    numbers: tuple[nodes.Expr, ...]
    operands: tuple[Vector, ...] = ()


@dataclass(frozen=True, slots=True)
class Wide:
    """Stores side by side that are one."""

    first: nodes.SetField | nodes.Store
    value: Vector


Part = AnyPart | Wide


def joined(body: nodes.Block, parts: Sequence[AnyPart], strides: Sequence[int]) -> Sequence[Part]:
    """The parts of a body with stores side by side as one, without the locals that nobody asks for then."""
    look, found, stretch = _Look(body, strides), list["Part"](), list["nodes.Stmt"]()
    for part in parts:
        if isinstance(part, nodes.SetField | nodes.Store) or (isinstance(part, nodes.Let) and look.stays(part.value)):
            stretch.append(part)
        else:
            found += [*look.joined(stretch), part]
            stretch = []
    found += look.joined(stretch)
    return _asked_for(found) if any(isinstance(each, Wide) for each in found) else parts


def _asked_for(parts: Sequence[Part]) -> list[Part]:
    """The parts without locals that none behind them asks for."""
    names, kept = set[str](), list["Part"]()
    for part in reversed(parts):
        if isinstance(part, nodes.Let) and part.name not in names:
            continue
        kept.append(part)
        match part:
            case Wide(first, value):
                target = first.place.row if isinstance(first, nodes.SetField) else first.at
                names |= locals_in(target).union(*map(locals_in, _scalars(value)))
            case Series():
                names |= names_read(part.body).union(each.first for each in part.carried)
            case Place():
                names.update(part.names.values())
            case _:
                names |= names_read((part,))
    return kept[::-1]


def _scalars(vector: Vector) -> Iterator[nodes.Expr]:
    """What of a vector is computed for one number: addresses, and locals that are the same for all. Shared operands are looked at once."""
    seen, pending = set[int](), [vector]
    while pending:
        each = pending.pop()
        if id(each) not in seen:
            seen.add(id(each))
            pending += each.operands
            if not each.operands:
                yield each.numbers[0]


class _Look:
    """A look at the stores of a body: what they store, and which memory nobody writes."""

    def __init__(self, body: nodes.Block, strides: Sequence[int]) -> None:
        self.strides = strides
        self.known: dict[tuple[str, ...], Vector | None] = {}
        self.values = {each.name: each.value for each in body if isinstance(each, nodes.Let)}
        every = [each for each, _ in statements(body)]
        self.variables = {each.name for each in every if isinstance(each, nodes.Var)}
        self.written = {where for each in every for where in _written(each)}
        self.runs_others = any(isinstance(each, nodes.Call | nodes.HostCall) for each in every)

    def stays(self, value: nodes.Expr) -> bool:
        """Whether a value is the same wherever it is computed in the body."""
        match value:
            case nodes.Local(_, name):
                return name not in self.variables
            case nodes.Load():
                is_still = None not in self.written
            case nodes.Get(_, place):
                is_still = place.lane not in self.written
            case nodes.Used() | nodes.Register() | nodes.IsText() | nodes.Nearest():
                return False
            case _:
                is_still = True
        return is_still and not self.runs_others and all(map(self.stays, operands(value)))

    def joined(self, stretch: Sequence[nodes.Stmt]) -> Sequence[Part]:
        """Statements that bind and store, with stores side by side as one, behind all that is bound."""
        stores = [each for each in stretch if isinstance(each, nodes.SetField | nodes.Store)]
        wide = list(self._wide(stores))
        if len(wide) == len(stores):
            return stretch
        return [*(each for each in stretch if isinstance(each, nodes.Let)), *wide]

    def _wide(self, stores: Sequence[nodes.SetField | nodes.Store]) -> Iterator[Wide | nodes.SetField | nodes.Store]:
        at = 0
        while at < len(stores):
            most = min(len(stores) - at, WIDEST // nodes.WIDTH[type_of(stores[at].value)])
            sizes = [size for size in SIZES if size <= most]
            vectors = ((size, self._stored(stores[at : at + size])) for size in sizes)
            size, vector = next((found for found in vectors if found[1] is not None), (1, None))
            yield stores[at] if vector is None else Wide(stores[at], vector)
            at += size

    def _stored(self, stores: Sequence[nodes.SetField | nodes.Store]) -> Vector | None:
        """What stores write, if they lie side by side and it can be computed together."""
        kind = type_of(stores[0].value)
        if not is_float(kind) or not _follow(list(map(self._position, stores)), kind):
            return None
        vector = self._vector([each.value for each in stores], DEEP)
        return vector if vector is not None and vector.operands else None  # what is only copied LLVM joins itself

    def _vector(self, numbers: Sequence[nodes.Expr], depth: int) -> Vector | None:
        """A vector of numbers that are computed alike; None if there is no gain in it, or too much to follow."""
        first = numbers[0]
        kind = type_of(first)
        if isinstance(first, nodes.Local):
            return self._bound(numbers, depth)
        if not depth or kind not in NUMBERS or any(type(each) is not type(first) or type_of(each) != kind for each in numbers):
            return None
        match first:
            case nodes.Const():
                return Vector(tuple(numbers))
            case nodes.Load() | nodes.Get():
                return Vector(tuple(numbers)) if self.stays(first) and _follow(list(map(self._position, numbers)), kind) else None
            case nodes.Unary() | nodes.Binary() | nodes.Convert() if is_float(kind) and all(_does_as(first, each) for each in numbers):
                inner = [self._vector(each, depth - 1) for each in zip(*map(operands, numbers), strict=True)]
                found = tuple(each for each in inner if each is not None)
                return Vector(tuple(numbers), found) if len(found) == len(inner) else None
            case _:
                return None

    def _bound(self, numbers: Sequence[nodes.Expr], depth: int) -> Vector | None:
        """The same for locals, each of which is followed once."""
        names = tuple([each.name for each in numbers if isinstance(each, nodes.Local)])
        if names not in self.known:
            self.known[names] = None
            if len(names) == len(numbers) and all(each in self.values for each in names):
                is_one = len(set(names)) == 1
                self.known[names] = Vector(tuple(numbers)) if is_one else self._vector([self.values[each] for each in names], depth - 1)
        return self.known[names]

    def _position(self, part: nodes.Expr | nodes.Stmt) -> tuple[int | nodes.Order, nodes.Expr, int]:
        """The lane, or the byte order in the message, what is computed of a place there, and the bytes behind that."""
        match part:
            case nodes.SetField(place) | nodes.Get(_, place):
                base, rows = base_and_offset(place.row)
                return place.lane, base, rows * self.strides[place.lane] + place.offset
            case nodes.Store(at, _, order) | nodes.Load(_, at, order):
                return order, *base_and_offset(at)
            case _:
                raise AssertionError(part)


def _written(stmt: nodes.Stmt) -> Iterator[int | None]:
    """The lanes that a statement may write to; None stands for the message."""
    match stmt:
        case nodes.SetField(place):
            yield place.lane
        case nodes.Copy(target=target) | nodes.Fill(target=target):
            yield target.lane if isinstance(target, nodes.Place) else None
        case nodes.Store():
            yield None
        case _:
            pass


def _does_as(first: nodes.Expr, other: nodes.Expr) -> bool:
    """Whether two expressions of the same type do the same with their operands, and in one instruction."""
    match first, other:
        case nodes.Unary(function, _), nodes.Unary(same, _):
            return function == same and function in UNARY
        case nodes.Binary(op, _, _), nodes.Binary(same, _, _):
            return op == same and op in BINARY
        case nodes.Convert(), nodes.Convert():
            return True
        case _:
            return False


def _follow(places: Sequence[tuple[int | nodes.Order, nodes.Expr, int]], kind: nodes.Scalar) -> bool:
    """Whether each place is the next number behind the one before it, with its low byte first."""
    width = nodes.WIDTH[kind]
    return places[0][0] != ">" and all(before[:2] == behind[:2] and before[2] + width == behind[2] for before, behind in pairwise(places))


# --- printing ------------------------------------------------------------------------------------------------------------


def print_part(frame: Frame, part: Part) -> None:
    """Print a part of a block, unless one before it has ended it."""
    if not isinstance(part, Wide):
        llvm_stmt.print_part(frame, part)
    elif not frame.builder.block.is_terminated:
        _print_wide(frame, part)


def _print_wide(frame: Frame, wide: Wide) -> None:
    """Print the store of a vector."""
    first, value = wide.first, _value(frame, wide.value, {})
    if isinstance(first, nodes.Store):
        frame.builder.store(value, wire_pointer(frame, first.at), align=1)
    else:
        frame.builder.store(value, place_pointer(frame, first.place), align=place_alignment(frame, first.place, type_of(first.value)))


def _value(frame: Frame, vector: Vector, known: dict[int, ir.Value]) -> ir.Value:
    """A vector, computed once."""
    if id(vector) not in known:
        inner = [_value(frame, each, known) for each in vector.operands]
        known[id(vector)] = _computed(frame, vector, inner) if inner else _found(frame, vector.numbers)
    return known[id(vector)]


def _found(frame: Frame, numbers: Sequence[nodes.Expr]) -> ir.Value:
    """Numbers that nothing is done with: one behind another in memory, constants, or one local again and again."""
    first = numbers[0]
    kind = type_of(first)
    wide = ir.VectorType(LLVM_TYPES[kind], len(numbers))
    match first:
        case nodes.Load(_, at, _):
            return frame.builder.load(wire_pointer(frame, at), typ=wide, align=1)
        case nodes.Get(_, place):
            return frame.builder.load(place_pointer(frame, place), typ=wide, align=place_alignment(frame, place, kind))
        case nodes.Local():
            alone = frame.builder.insert_element(ir.Constant(wide, ir.Undefined), expression(frame, first), ir.Constant(I32, 0))
            return frame.builder.shuffle_vector(alone, ir.Constant(wide, ir.Undefined), ir.Constant(ir.VectorType(I32, len(numbers)), None))
        case _:
            return ir.Constant(wide, [scalar_constant(kind, each.value) for each in numbers if isinstance(each, nodes.Const)])


def _computed(frame: Frame, vector: Vector, inner: Sequence[ir.Value]) -> ir.Value:
    """What is done with the numbers of some vectors."""
    builder, first = frame.builder, vector.numbers[0]
    kind = type_of(first)
    wide = ir.VectorType(LLVM_TYPES[kind], len(vector.numbers))
    match first:
        case nodes.Unary("neg", _):
            return builder.fneg(inner[0])
        case nodes.Unary(function, _):
            name = f"llvm.{INTRINSICS[function]}.v{len(vector.numbers)}{kind}"
            return builder.call(intrinsic(frame.module, name, wide, [wide]), inner)
        case nodes.Binary(op, _, _):
            return getattr(builder, FLOAT_BINARY[op])(*inner)
        case nodes.Convert(_, operand) if not is_float(type_of(operand)):
            return builder.sitofp(inner[0], wide)
        case nodes.Convert(_, operand) if type_of(operand) == kind:
            return inner[0]
        case _:
            return builder.fptrunc(inner[0], wide) if kind == "f32" else builder.fpext(inner[0], wide)
