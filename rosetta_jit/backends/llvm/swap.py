"""Numbers of the other byte order: what swaps their bytes, one after another, becomes a call of a function that is compiled once a machine.

    set lane[row].0 = load f64> [at]; set lane[row].8 = load f64> [at + 8]; set lane[row].16 = load f64> [at + 16]; …
    for i < count: { let item = at + i * stride; set lane[start + i].0 = load > [item]; set lane[start + i].8 = load > [item + 8]; … }

`rosetta_swap8(target, source, count)` copies numbers of eight bytes, each in reverse order of its bytes; `rosetta_swap4` and
`rosetta_swap2` do so with shorter ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from llvmlite import ir

from rosetta_jit.backends.llvm.expr import expression, place_pointer, wire_pointer
from rosetta_jit.backends.llvm.frame import I64, constant
from rosetta_jit.backends.llvm.support import declared
from rosetta_jit.kernel.ir import WIDTH, Binary, Const, For, Let, Load, Local, Place, SetField
from rosetta_jit.kernel.terms import split
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosetta_jit.backends.llvm.alike import Series
    from rosetta_jit.backends.llvm.frame import Frame
    from rosetta_jit.kernel.ir import Expr, Stmt


SEVERAL = 3
"""Fields from which on a call is shorter than what it stands for."""


@dataclass(frozen=True, slots=True)
class Run:
    """Fields of a row that lie one behind another, in the message as in the holder: so many numbers, each of ``width`` bytes."""

    place: Place
    at: Expr
    width: int
    count: int


def with_runs(parts: Sequence[Stmt | Series]) -> Sequence[Stmt | Series | Run]:
    """The parts of a block, with runs of fields in their places."""
    found, behind = list["Stmt | Series | Run"](), 0
    while behind < len(parts):
        run = _run(parts, behind)
        found.append(parts[behind] if run is None else run)
        behind += 1 if run is None else run.count
    return found


def _run(parts: Sequence[object], begin: int) -> Run | None:
    """The run that begins at a part of a block."""
    match parts[begin]:
        case SetField(Place(lane, row, offset) as place, Load(type_, at, ">")) if (width := WIDTH[type_]) > 1:
            pass
        case _:
            return None
    (base, start), count = split(at), 1
    while begin + count < len(parts):
        match parts[begin + count]:
            case SetField(Place(number, same, field), Load(like, where, ">")) if (number, same, WIDTH[like]) == (lane, row, width):
                if field != offset + count * width or split(where) != (base, start + count * width):
                    break
            case _:
                break
        count += 1
    return Run(place, at, width, count) if count >= SEVERAL else None


def print_run(frame: Frame, run: Run) -> None:
    """A call for all of its fields."""
    target, source = place_pointer(frame, run.place), wire_pointer(frame, run.at)
    frame.builder.call(declared(frame.module, f"rosetta_swap{run.width}"), [target, source, constant(run.count)])


def swapped(frame: Frame, loop: For) -> bool:
    """Print a loop as a call, if it does nothing but swap bytes."""
    match loop.body:
        case (
            Let(item, Binary("add", at, Binary("mul", Local(_, index), Const(_, step)))),
            SetField(Place(lane, row), _) as first,
            *others,
        ):
            width = _width((first, *others), item, Place(lane, row))
            row = _start(row, loop.variable)
            if index != loop.variable or row is None or not width or not frame.strides[lane] == step == width * (1 + len(others)):
                return False
        case _:
            return False
    count = frame.builder.mul(expression(frame, loop.count), constant(1 + len(others)), flags=("nsw",))
    target, source = place_pointer(frame, Place(lane, row)), wire_pointer(frame, at)
    frame.builder.call(declared(frame.module, f"rosetta_swap{width}"), [target, source, count])
    return True


def _width(stores: Sequence[Stmt], item: str, place: Place) -> int:
    """The bytes of each number, if one after another is stored where it lies in the element; else 0."""
    width = 0
    for number, store in enumerate(stores):
        match store:
            case SetField(Place(lane, row, offset), Load(type_, at, ">")) if (lane, row) == (place.lane, place.row):
                width = width or WIDTH[type_]
                if width == 1 or width != WIDTH[type_] or offset != number * width or _offset(at, item) != offset:
                    return 0
            case _:
                return 0
    return width


def _start(row: Expr, index: str) -> Expr | None:
    """The first row of a loop over rows."""
    match row:
        case Binary("add", start, Local(_, name)) if name == index:
            return start
        case _:
            return None


def _offset(at: Expr, item: str) -> int | None:
    """How far a place lies behind the begin of an item."""
    match at:
        case Local(_, name) if name == item:
            return 0
        case Binary("add", Local(_, name), Const(_, offset)) if name == item:
            return int(offset)
        case _:
            return None


def define(function: ir.Function) -> None:
    """``void rosetta_swap8(target, source, count)`` and its like: a loop of which LLVM makes one over vectors."""
    target, source, count = function.args
    target.add_attribute("noalias")
    source.add_attribute("noalias")
    number = ir.IntType(8 * int(function.name.removeprefix("rosetta_swap")))
    before, head, inside, behind = map(function.append_basic_block, ("entry", "for", "each", "after"))
    ir.IRBuilder(before).branch(head)
    builder = ir.IRBuilder(head)
    index = builder.phi(I64, name="index")
    index.add_incoming(constant(0), before)
    builder.cbranch(builder.icmp_signed("<", index, count), inside, behind)
    builder.position_at_end(inside)
    value = builder.load(builder.gep(source, [index], source_etype=number), typ=number, align=1)
    builder.store(builder.bswap(value), builder.gep(target, [index], source_etype=number), align=1)
    index.add_incoming(builder.add(index, constant(1), flags=("nsw",)), inside)
    builder.branch(head)
    ir.IRBuilder(behind).ret_void()
