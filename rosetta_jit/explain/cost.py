"""What a kernel costs at most: bytes that it touches and operations that it does, counted in its statements.

    Cost = bytes read, bytes written, operations, checks, Repeated*         Repeated = count, Cost

Stretches of a size that only the message knows are repeated bytes. Of several branches the dearest counts, each loop taken once; of
several attempts the first. Operations are those on values: where a value lies is not counted, nor what a loop itself does.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from types import MappingProxyType
from typing import assert_never

from rosetta_jit.explain.counts import count_text, factored, named_counts
from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.terms import END, type_of
from rosetta_jit.kernel.traits import looks_closer
from rosetta_jit.kernel.walk import operands
from rosetta_jit.startup.dataclass import dataclass, field, replace


@dataclass(frozen=True, slots=True)
class Cost:
    """Bytes, operations and checks of a message as such, and what is repeated."""

    read: int = 0
    written: int = 0
    operations: int = 0
    checks: int = 0
    repeated: tuple[Repeated, ...] = ()


@dataclass(frozen=True, slots=True)
class Repeated:
    """A cost, so many times."""

    count: str
    cost: Cost


FREE = Cost()
NO_FIELDS: Mapping[str, str] = MappingProxyType({})


def cost_of(kernel: ir.Kernel, fields: Mapping[str, str] = NO_FIELDS) -> Cost:
    """The cost of a kernel, in the first of its attempts; ``fields`` are the paths of fields by the names that the kernel gives them."""
    routines: dict[str, Cost] = {}
    for routine in kernel.routines:
        routines[routine.name] = _Counter({**fields, **named_counts(routine.body, routine.sites)}, routines).block(routine.body)
    return _Counter({**fields, **named_counts(kernel.bodies[0], kernel.sites)}, routines).block(kernel.bodies[0])


def total(cost: Cost) -> tuple[int, int]:
    """Bytes and steps with each loop taken once: by this costs are compared."""
    inner = [total(each.cost) for each in cost.repeated]
    steps = cost.operations + cost.checks
    return cost.read + cost.written + sum(size for size, _ in inner), steps + sum(count for _, count in inner)


def plus(left: Cost, right: Cost) -> Cost:
    """Both costs; what is repeated as often is one."""
    together: dict[str, Cost] = {}
    for each in (*left.repeated, *right.repeated):
        together[each.count] = plus(together.get(each.count, FREE), each.cost)
    return Cost(
        left.read + right.read,
        left.written + right.written,
        left.operations + right.operations,
        left.checks + right.checks,
        tuple(Repeated(count, cost) for count, cost in together.items()),
    )


def _sum(costs: Iterable[Cost]) -> Cost:
    return reduce(plus, costs, FREE)


def _dearest(costs: Iterable[Cost]) -> Cost:
    return max(costs, key=total, default=FREE)


@dataclass(frozen=True, slots=True)
class _Counter:
    """Counts statements; ``names`` are what counts are called, ``routines`` what calls cost."""

    names: Mapping[str, str]
    routines: Mapping[str, Cost]
    values: dict[str, nodes.Expr] = field(default_factory=dict[str, "nodes.Expr"])

    def block(self, block: nodes.Block) -> Cost:
        return _sum(map(self.statement, block))

    def statement(self, stmt: nodes.Stmt) -> Cost:
        match stmt:
            case nodes.Require(at, size):
                return plus(Cost(checks=1), plus(self.place(at), self.place(size)))
            case nodes.Expect(condition):
                return plus(Cost(checks=1), replace(self.value(condition), operations=0))
            case nodes.Let(name, value):
                self.values[name] = value
                return self.value(value)
            case nodes.Var(_, value) | nodes.Assign(_, value):
                return self.value(value)
            case nodes.Store(at, value):
                return _sum((self.place(at), self.value(value), Cost(written=nodes.WIDTH[type_of(value)])))
            case nodes.SetField(place, value):
                return _sum((self.address(place), self.value(value), Cost(written=nodes.WIDTH[type_of(value)])))
            case nodes.Copy(target, source, size):
                return _sum((self.address(target), self.address(source), self.stretch(size, Cost(read=1, written=1))))
            case nodes.Fill(target, size):
                return plus(self.address(target), self.stretch(size, Cost(written=1)))
            case nodes.Reserve() | nodes.Advance() | nodes.Return():
                return FREE
            case nodes.Call(routine):
                return self.routines.get(routine, FREE)
            case nodes.HostCall(_, arguments):
                return _sum((Cost(operations=1, checks=1), *map(self.value, arguments)))
            case nodes.For() | nodes.While() | nodes.If() | nodes.Switch():
                return self.nest(stmt)
            case _:
                assert_never(stmt)

    def nest(self, stmt: nodes.Nest) -> Cost:
        match stmt:
            case nodes.For(_, count, body):
                return self.times(count, self.block(body))
            case nodes.While(condition, body):
                rounds = count_text(_bound(condition), self.values, self.names)
                return Cost(repeated=(Repeated(rounds, plus(self.value(condition), self.block(body))),))
            case nodes.If(condition, then, otherwise):
                if looks_closer(stmt):
                    return plus(Cost(checks=1), replace(self.value(condition), operations=0))
                return plus(self.value(condition), _dearest((self.block(then), self.block(otherwise))))
            case nodes.Switch(value, cases, default):
                return plus(self.value(value), _dearest((*(self.block(block) for _, block in cases), self.block(default))))
            case _:
                assert_never(stmt)

    def times(self, count: nodes.Expr, cost: Cost) -> Cost:
        """A cost so many times; a known number of times it is multiplied."""
        count, factor = factored(count, self.values)
        cost = _scaled(cost, factor)
        if isinstance(count, nodes.Const):
            return _scaled(cost, int(count.value))
        return Cost(repeated=(Repeated(count_text(count, self.values, self.names), cost),)) if cost != FREE else FREE

    def stretch(self, size: nodes.Expr, byte: Cost) -> Cost:
        return self.times(size, byte)

    def address(self, address: nodes.Address) -> Cost:
        match address:
            case nodes.Wire(at):
                return self.place(at)
            case nodes.Place(_, row):
                return self.place(row)
            case _:
                assert_never(address)

    def place(self, expr: nodes.Expr) -> Cost:
        """What reading a position or a size costs: its arithmetic is not counted, the bytes that it looks at are."""
        return replace(self.value(expr), operations=0)

    def value(self, expr: nodes.Expr) -> Cost:
        """Bytes that an expression reads, and its operations."""
        match expr:
            case nodes.Const() | nodes.Local() | nodes.Used() | nodes.Capacity():
                return FREE
            case nodes.Load(type_, at):
                return plus(self.place(at), Cost(read=nodes.WIDTH[type_]))
            case nodes.Get(type_, place):
                return plus(self.address(place), Cost(read=nodes.WIDTH[type_]))
            case nodes.IsText(address, size):
                return plus(self.address(address), self.stretch(size, Cost(read=1)))
            case _:
                return _sum((Cost(operations=1), *map(self.value, operands(expr))))


def _bound(condition: nodes.Expr) -> nodes.Expr:
    """What a loop counts up to, if it counts."""
    match condition:
        case nodes.Compare("lt", nodes.Local(), nodes.Local(_, name) as bound) if name != END.name:
            return bound
        case _:
            return condition


def _scaled(cost: Cost, factor: int) -> Cost:
    """A cost a known number of times."""
    repeated = tuple(replace(each, cost=_scaled(each.cost, factor)) for each in cost.repeated)
    return Cost(cost.read * factor, cost.written * factor, cost.operations * factor, cost.checks * factor, repeated if factor else ())
