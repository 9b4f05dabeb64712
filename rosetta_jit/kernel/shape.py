"""What shows in a kernel's text without any proof: names bound once, nesting bounded, sites that exist."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.limits import MAX_BLOCKS, MAX_EXPRESSION
from rosetta_jit.kernel.state import INDEX_WORDS
from rosetta_jit.kernel.terms import BEGIN, END, ROW
from rosetta_jit.kernel.walk import bound_names, expressions_of, operands, statements

OF_A_BODY = frozenset[type[nodes.Stmt | nodes.Expr]](
    (nodes.Return, nodes.Reserve, nodes.Advance, nodes.HostCall, nodes.Used, nodes.HostValue, nodes.Register)
)
"""Kinds of statements and expressions that bodies may have and routines may not: returns, and uses of lanes, the host and registers."""

TOO_DEEP = "an expression is nested too deep"


def shape_error(kernel: ir.Kernel) -> str | None:
    """What is wrong with a kernel's text, if anything is."""
    if not kernel.bodies:
        return "a kernel without bodies"
    if any(stride < 0 for stride in kernel.strides):
        return "a lane whose rows have less than no bytes"
    if not 0 <= kernel.hidden <= len(kernel.strides):
        return f"{kernel.hidden} of {len(kernel.strides)} lanes are hidden"
    if kernel.kept and (kernel.direction != "decode" or kernel.kept[0] != 0 or not all(0 <= lane < kernel.lanes for lane in kernel.kept)):
        return "it keeps lanes that it cannot keep"
    for number, routine in enumerate(kernel.routines):
        problem = _routine_error(routine, kernel.routines[:number])
        if problem is not None:
            return f"routine {routine.name}: {problem}"
    inner = [pair for body in kernel.bodies for pair in statements(body)]
    every = [stmt for stmt, _ in inner]
    parts = _parts(every)
    if parts is None:
        return TOO_DEEP
    problem = _registers_error(kernel.registers, every, parts)
    if problem is not None:
        return problem
    return _statements_error(inner, (BEGIN.name, END.name, ROW.name), len(kernel.sites), kernel.routines)


def _registers_error(count: int, every: list[nodes.Stmt], parts: list[nodes.Expr]) -> str | None:
    changed = [[number for number, _ in stmt.registers] for stmt in every if isinstance(stmt, nodes.Return)]
    named = {part.number for part in parts if isinstance(part, nodes.Register)} | {number for numbers in changed for number in numbers}
    unknown = [number for number in named if not 0 <= number < count]
    if unknown:
        return f"no register {unknown[0]}"
    return None if all(a < b for numbers in changed for a, b in pairwise(numbers)) else "a register that is set twice"


def _routine_error(routine: ir.Routine, before: tuple[ir.Routine, ...]) -> str | None:
    if any(routine.name == other.name for other in before):
        return "a name that another one has"
    if any(result.type not in ("i64", "u64") for result in routine.results):
        return "a result that is no integer of 64 bits"
    inside = list(statements(routine.body))
    parts = _parts([stmt for stmt, _ in inside])
    if parts is None:
        return TOO_DEEP
    if not OF_A_BODY.isdisjoint([type(stmt) for stmt, _ in inside]) or not OF_A_BODY.isdisjoint(map(type, parts)):
        return "something that only a body can do"
    names = BEGIN.name, END.name, *(parameter.name for parameter in routine.parameters)
    if len(set(names)) < len(names):
        return "a parameter that is named twice"
    return _statements_error(inside, names, len(routine.sites), before)


def _statements_error(
    inside: list[tuple[nodes.Stmt, int]], names: tuple[str, ...], sites: int, routines: tuple[ir.Routine, ...]
) -> str | None:
    bound = set(names)
    known = {routine.name: routine for routine in routines}
    for stmt, depth in inside:
        for name in bound_names(stmt):
            if name in bound:
                return f"{name} is bound twice"
            bound.add(name)
        problem = _statement_error(stmt, depth, sites, known)
        if problem is not None:
            return problem
    return None


def _statement_error(stmt: nodes.Stmt, depth: int, sites: int, routines: Mapping[str, ir.Routine]) -> str | None:
    if depth > MAX_BLOCKS:
        return "blocks are nested too deep"
    match stmt:
        case nodes.Require(_, _, failure) | nodes.Expect(_, failure) | nodes.HostCall(_, _, _, failure):
            return _failing_error((failure.site,), failure.indices, sites)
        case nodes.Call(name, arguments, results, named, indices):
            routine = routines.get(name)
            if routine is None:
                return f"no routine {name} before"
            counts = len(arguments), len(results), 1 + len(named)
            if counts != (len(routine.parameters), len(routine.results), len(routine.sites)):
                return f"a call that does not fit {name}"
            return _failing_error(named, indices, sites)
        case _:
            return None


def _failing_error(named: tuple[int, ...], indices: tuple[nodes.Expr, ...], sites: int) -> str | None:
    missing = [site for site in named if not 1 <= site < sites]
    if missing:
        return f"no site {missing[0]}"
    return "too many indices" if len(indices) > INDEX_WORDS else None


def _parts(stmts: list[nodes.Stmt]) -> list[nodes.Expr] | None:
    """All expressions of some statements, and all inside them, level by level; None where one is nested too deep."""
    level, found = [expr for stmt in stmts for expr in expressions_of(stmt)], list[nodes.Expr]()
    for _ in range(1 + MAX_EXPRESSION):
        if not level:
            return found
        found += level
        level = [part for expr in level for part in operands(expr)]
    return None
