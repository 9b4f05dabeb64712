"""Where the rounds of a loop read and write: of each access the first round's place, and how far the next round's is from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rosetta_jit.kernel.nodes import WIDTH, Address, Binary, Const, Convert, Expr, For, Get, Load, Local, Place, Select, SetField, Store
from rosetta_jit.kernel.passes.affine import Rounds, rounds_of
from rosetta_jit.kernel.rewrite import OF_MEMORY
from rosetta_jit.kernel.terms import mul, split, type_of
from rosetta_jit.kernel.walk import flat, parts_of
from rosetta_jit.startup.dataclass import dataclass

MESSAGE = -1
"""The message, among the numbers of lanes."""


@dataclass(frozen=True, slots=True)
class Access:
    """``width`` bytes of a lane or the message in each round: ``start + offset + step * round``.

    Of a lane, ``start`` is a row; the others are bytes.
    """

    where: int
    start: Expr
    offset: int
    step: int
    width: int
    writes: bool = False

    @property
    def stream(self) -> tuple[int, Expr, int]:
        """What accesses have in common that lie in one array."""
        return self.where, self.start, self.step

    def is_beside(self, other: Access) -> bool:
        """Whether in each round both are within the bytes of one step."""
        if self.stream != other.stream:
            return False
        ends = self.offset + self.width, other.offset + other.width
        return max(ends) - min(self.offset, other.offset) <= self.step


def accesses_of(loop: For, strides: Sequence[int]) -> tuple[Access, ...] | None:
    """All accesses of a loop whose body has no blocks inside; None if one of them does not go along a fixed distance each round."""
    rounds, stmts = rounds_of(loop), flat(loop.body)
    found: list[Access | None] = []
    for part in parts_of(stmts):
        match part:
            case Load(type_, at):
                found.append(_in_message(at, WIDTH[type_], rounds))
            case Get(type_, place):
                found.append(_in_lane(place, WIDTH[type_], rounds, strides))
            case _ if type(part) in OF_MEMORY:
                return None
            case _:
                pass
    for stmt in stmts:
        match stmt:
            case Store(at, value):
                found.append(_in_message(at, WIDTH[type_of(value)], rounds, writes=True))
            case SetField(place, value):
                found.append(_in_lane(place, WIDTH[type_of(value)], rounds, strides, writes=True))
            case _:
                pass
    known = tuple(each for each in found if each is not None)
    return known if len(known) == len(found) else None


def _in_message(at: Expr, width: int, rounds: Rounds, *, writes: bool = False) -> Access | None:
    match rounds.affine(at):
        case None:
            return None
        case found:
            start, offset = split(found.base)
            return Access(MESSAGE, start, offset, int(found.step.value), width, writes) if isinstance(found.step, Const) else None


def _in_lane(place: Place, width: int, rounds: Rounds, strides: Sequence[int], *, writes: bool = False) -> Access | None:
    stride = strides[place.lane]
    match rounds.affine(place.row):
        case None:
            return None
        case found:
            start, rows = split(found.base)
            step = mul(found.step, stride)
            offset = rows * stride + place.offset
            return Access(place.lane, start, offset, int(step.value), width, writes) if isinstance(step, Const) else None


def starts_at(address: Address, access: Access, strides: Sequence[int]) -> bool:
    """Whether an address is where the first round of an access is."""
    match address:
        case Place(lane, row, offset):
            start, rows = split(row)
            return (lane, start, rows * strides[lane] + offset) == (access.where, access.start, access.offset)
        case _:
            return (MESSAGE, *split(address.at)) == (access.where, access.start, access.offset)


def stay_apart(one: Access, other: Access, count: Expr, lets: Mapping[str, Expr]) -> bool:
    """Whether no round of an access touches what another round of the other one writes."""
    if one.where != other.where or not (one.writes or other.writes):
        return True
    return one.is_beside(other) or _lies_behind(one, other, count, lets) or _lies_behind(other, one, count, lets)


def _lies_behind(one: Access, other: Access, count: Expr, lets: Mapping[str, Expr]) -> bool:
    """Whether the first round of an access in the message is behind the last one of another."""
    if one.where != MESSAGE or other.width > other.step:
        return False
    between = _Sum(lets)
    between.add(one.start, 1)
    between.add(other.start, -1)
    between.add(count, -other.step)
    return between.constant + one.offset - other.offset >= 0 and between.is_positive


class _Sum:
    """A sum of terms, each so many times, in which locals stand for what they are."""

    def __init__(self, lets: Mapping[str, Expr]) -> None:
        self.lets = lets
        self.constant = 0
        self.terms: dict[Expr, int] = {}

    def add(self, expr: Expr, times: int) -> None:
        match expr:
            case Const(_, value):
                self.constant += int(value) * times
            case Binary("add", left, right):
                self.add(left, times)
                self.add(right, times)
            case Binary("mul", left, Const(_, factor)):
                self.add(left, times * int(factor))
            case Local(_, name) if isinstance(value := self.lets.get(name), Binary | Const | Local):
                self.add(value, times)
            case _:
                self.terms[expr] = self.terms.get(expr, 0) + times

    @property
    def is_positive(self) -> bool:
        """Whether no term takes anything away."""
        return all(times == 0 or (times > 0 and _is_positive(term, self.lets)) for term, times in self.terms.items())


def _is_positive(expr: Expr, lets: Mapping[str, Expr]) -> bool:
    """Whether an integer is known not to be negative."""
    match expr:
        case Const(_, value):
            return value >= 0
        case Local(_, name) if name in lets:
            return _is_positive(lets[name], lets)
        case Select(_, then, otherwise):
            return _is_positive(then, lets) and _is_positive(otherwise, lets)
        case Binary("and", left, right):
            return _is_positive(left, lets) or _is_positive(right, lets)
        case Convert("i64", operand):
            return type_of(operand) in ("u8", "u16", "u32", "bool")
        case _:
            return False
