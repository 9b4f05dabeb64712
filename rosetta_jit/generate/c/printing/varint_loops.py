"""Loops of C++ over protobuf's packed integers, of which functions of the shared header do as many rounds as they are sure of.

    size += varint_size(value[i])               size_of_varints: all rounds
    next = write_varint(next, value[i])         write_varints: those for which the message has room
    value[used++] = read_packed(at)             read_varints: those that the message has as it should, in a lane with room for all
    value[used++] = read_packed(at) != 0        read_flags_of_varints: all, where each takes one byte, as no writer has it otherwise

A loop that is printed behind such a call does the rest, and says where something is wrong. Kernels cannot say what makes these functions
quick: how many bits a number has, and how many numbers follow in 64 bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.generate.c.printing.expressions import expression
from rosetta_jit.generate.c.words import C_TYPES
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import (
    Advance,
    Assign,
    Binary,
    Block,
    Call,
    Compare,
    Const,
    Convert,
    Expr,
    Get,
    If,
    Let,
    Local,
    Place,
    Reserve,
    SetField,
    Stmt,
    Used,
    While,
)
from rosetta_jit.kernel.passes.fold import folded
from rosetta_jit.kernel.rewrite import substituted
from rosetta_jit.kernel.terms import END, index, type_of
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope

DETAIL = "rosetta_jit::detail"
REPLACED = frozenset({"varint_size", "read_eight"})
"""Routines that a function of the header stands for, which asks the processor where the next bit is set."""


@dataclass(frozen=True, slots=True)
class Sized:
    """The bytes of ``count`` varints are added to ``total``; ``value`` is that of number ``number``."""

    number: str
    count: Expr
    value: Expr
    total: str


@dataclass(frozen=True, slots=True)
class Written:
    """The same varints are written from ``at`` on."""

    number: str
    count: Expr
    value: Expr
    at: str


@dataclass(frozen=True, slots=True)
class Appended:
    """What varints from ``at`` to ``stop`` stand for becomes rows of a lane; ``value`` says it of ``varint``."""

    at: str
    stop: Expr
    lane: int
    varint: Local
    value: Expr


Rounds = Sized | Written | Appended


def rounds_of(loop: While) -> Rounds | None:
    """What a loop does, if it is one of these."""
    match loop.condition, loop.body:
        case (
            Compare("lt", Local(_, number), count),
            (
                Call("varint_size", (value,), (Local("i64", size),)),
                Assign(total, Binary("add", Local(_, before), Local(_, added))),
                Assign(counted, more),
            ),
        ) if size == added and total == before and counted == number and _is_next(more, number):
            return Sized(number, count, value, total)
        case (
            Compare("lt", Local(_, number), count),
            (
                Call("write_varint", (Local(_, at), value), (Local("i64", behind),)),
                Assign(moved, Local(_, to)),
                Assign(counted, more),
            ),
        ) if moved == at and to == behind and counted == number and _is_next(more, number):
            return Written(number, count, value, at)
        case Compare("lt", Local(_, at), stop), body:
            return next((found for block in _blocks(body) if (found := _appended(block, at, stop)) is not None), None)
        case _:
            return None


def _is_next(expr: Expr, number: str) -> bool:
    return expr == Binary("add", Local("i64", number), index(1))


def _blocks(body: Block) -> list[Block]:
    """A block and those within its branches."""
    inner = [each for stmt in body if isinstance(stmt, If) for branch in (stmt.then, stmt.otherwise) for each in _blocks(branch)]
    return [body, *inner]


def _appended(block: Block, at: str, stop: Expr) -> Appended | None:
    """One varint that is appended, by a block that does nothing else."""
    match _without_names(block[:-1]):
        case (
            Call("read_packed", (Local(_, first),), (Local("u64") as varint, Local(_, behind))),
            Reserve(lane, room),
            SetField(Place(of, Used(used), 0), value),
            Advance(advanced, count),
        ) if first == at and {of, used, advanced} == {lane} and room == count == index(1):
            is_moved = block[-1] == Assign(at, Local("i64", behind))
            return Appended(at, stop, lane, varint, value) if is_moved else None
        case _:
            return None


def _without_names(block: Block) -> tuple[Stmt, ...]:
    """The statements of a block, where a name for the value that one sets is replaced by the value."""
    match block:
        case (Call() as call, Let(name, value), Reserve() as reserve, SetField(place, Local(_, same)), Advance() as advance) if (
            same == name
        ):
            return (call, reserve, SetField(place, value), advance)
        case _:
            return block


def replaced(scope: Scope, call: Call) -> list[str]:
    """The statements that stand for the call of a routine. The first result is returned, others come through pointers."""
    first, *others = call.results
    arguments = [bare(expression(scope, each)) for each in call.arguments] + [f"&{scope.locals.identifier(each.name)}" for each in others]
    declared = [f"{C_TYPES[each.type]} {scope.locals.identifier(each.name)} = 0;" for each in others]
    name = scope.locals.identifier(first.name)
    return [*declared, f"const {C_TYPES[first.type]} {name} = {DETAIL}::{call.routine}({', '.join(arguments)});"]


def sooner(scope: Scope, call: Call) -> tuple[str, str] | None:
    """Where there is room, a statement that does what the call of a routine does; it may set bytes behind that are not in use."""
    if call.routine != "write_two_bytes":
        return None
    at, value = (bare(expression(scope, each)) for each in call.arguments)
    bytes_, end, found = scope.takes("bytes"), expression(scope, END), scope.locals.identifier(call.results[0].name)
    function = "write_varint" if scope.lanes.forward else "write_varint_exactly"
    return f"{end} - {at} >= 10", f"{found} = {at} + {DETAIL}::{function}({bytes_} + {at}, {value});"


def called(kernel: Kernel) -> frozenset[str]:
    """The routines that are called where these functions stand for others."""
    routines, found = {each.name: each.body for each in kernel.routines}, set[str]()
    pending = [*kernel.bodies]
    while pending:
        calls = {stmt.routine for stmt, _ in statements(pending.pop()) if isinstance(stmt, Call)} & routines.keys() - REPLACED - found
        found |= calls
        pending += [routines[each] for each in calls]
    return frozenset(found)


# --- what is printed -----------------------------------------------------------------------------------------------------------------


def rounds_done(scope: Scope, rounds: Rounds) -> list[str]:
    """The statements that do rounds of a loop. `write_varints` sets bytes behind them, which must not be in use."""
    match rounds:
        case Sized(number, count, value, total):
            function = "size_of_varints" if _flag(value) is None else "size_of_flags"
            at = scope.locals.identifier(total)
            return [f"{at} = {at} + {DETAIL}::{function}({_numbered(scope, number, count, value)});"]
        case Written(number, count, value, at):
            place, target = scope.locals.identifier(at), f"{scope.takes('bytes')}, {expression(scope, END)}"
            if (flag := _flag(value)) is not None:
                rows = f"{scope.rows(flag.lane)} + {expression(scope, folded(substituted(flag.row, {number: index(0)})))}"
                name, end = scope.locals.identifier(number), bare(expression(scope, count))
                return [f"{place} = {DETAIL}::write_flags({target}, {place}, {name}, {end}, {rows});"]
            written = f"{place} = {DETAIL}::write_varints({target}, {place}, {_numbered(scope, number, count, value)});"
            return [written] if scope.lanes.forward else []
        case Appended():
            return _appending(scope, rounds)


def _flag(value: Expr) -> Place | None:
    """The place of the bool that a varint is."""
    match value:
        case Convert(_, Get("bool", place)):
            return place
        case _:
            return None


def _numbered(scope: Scope, number: str, count: Expr, value: Expr) -> str:
    """The number of the next one, how many they are, and a function from a number to a value."""
    each = f"{number} of several"
    text = bare(expression(scope, substituted(value, {number: Local("i64", each)})))
    function = f"[&](std::int64_t {scope.locals.identifier(each)}) {{ return {text}; }}"
    return f"{scope.locals.identifier(number)}, {bare(expression(scope, count))}, {function}"


def _appending(scope: Scope, rounds: Appended) -> list[str]:
    lanes, lane = scope.lanes, rounds.lane
    several, used = scope.locals.identifier(f"{rounds.at} several"), scope.used(lane)
    lacking = f"{several} - ({scope.capacity(lane)} - {used})"
    grown = lanes.grown(lane, lacking)
    assert grown is not None
    scope.moved.add(lane)
    moved = f"{scope.rows(lane)} = {lanes.member(lane)}"
    counted, read = _counted(scope, rounds)
    return [
        f"const int64_t {several} = {DETAIL}::{counted};",
        f"if ({several} > {scope.capacity(lane)} - {used}) {{",
        f"    static_cast<void>({grown});",
        f"    {moved};",
        "}",
        f"if ({several} > 0 && {several} <= {scope.capacity(lane)} - {used}) {{",
        *(f"    {each}" for each in read),
        "}",
    ]


def _counted(scope: Scope, rounds: Appended) -> tuple[str, list[str]]:
    """What counts the integers, and the statements that read them."""
    at, used = scope.locals.identifier(rounds.at), scope.used(rounds.lane)
    stop, bytes_, end = bare(expression(scope, rounds.stop)), scope.takes("bytes"), expression(scope, END)
    rows = f"{scope.rows(rounds.lane)} + {used}"
    if rounds.value == Compare("ne", rounds.varint, Const("u64", 0)):
        return f"count_of_flags({bytes_}, {at}, {stop})", [f"{used} += {DETAIL}::read_flags_of_varints({bytes_}, {at}, {stop}, {rows});"]
    varint = scope.locals.identifier(each := f"{rounds.varint.name} of several")
    value = bare(expression(scope, substituted(rounds.value, {rounds.varint.name: Local("u64", each)})))
    return f"count_of_varints({bytes_}, {at}, {stop}, {end})", [
        f"const auto number = [](std::uint64_t {varint}) -> {C_TYPES[type_of(rounds.value)]} {{ return {value}; }};",
        f"{used} += {DETAIL}::read_varints({bytes_}, {at}, {stop}, {end}, {rows}, number);",
    ]
