"""What shows in a kernel's text without any proof: names bound once, nesting bounded, sites that exist."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.limits import MAX_BLOCKS, MAX_EXPRESSION
from rosetta_jit.kernel.state import INDEX_WORDS
from rosetta_jit.kernel.terms import BEGIN, END, ROW
from rosetta_jit.kernel.walk import bound_names, expressions_of, operands, parts_of, statements, subexpressions


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
    problem = _registers_error(kernel.registers, [stmt for stmt, _ in inner])
    if problem is not None:
        return problem
    return _statements_error(inner, (BEGIN.name, END.name, ROW.name), len(kernel.sites), kernel.routines)


def _registers_error(count: int, every: list[nodes.Stmt]) -> str | None:
    changed = [[number for number, _ in stmt.registers] for stmt in every if isinstance(stmt, nodes.Return)]
    named = {part.number for part in parts_of(every) if isinstance(part, nodes.Register)} | {
        number for numbers in changed for number in numbers
    }
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
    if any(
        isinstance(stmt, nodes.Return | nodes.Reserve | nodes.Advance | nodes.HostCall) or any(map(_of_a_body, expressions_of(stmt)))
        for stmt, _ in inside
    ):
        return "something that only a body can do"
    names = BEGIN.name, END.name, *(parameter.name for parameter in routine.parameters)
    if len(set(names)) < len(names):
        return "a parameter that is named twice"
    return _statements_error(inside, names, len(routine.sites), before)


def _of_a_body(expr: nodes.Expr) -> bool:
    """Whether an expression asks for a used length, for what the host tells, or for a register."""
    return any(isinstance(part, nodes.Used | nodes.HostValue | nodes.Register) for part in subexpressions(expr))


def _statements_error(
    inside: list[tuple[nodes.Stmt, int]], names: tuple[str, ...], sites: int, routines: tuple[ir.Routine, ...]
) -> str | None:
    if _are_deep([stmt for stmt, _ in inside]):
        return "an expression is nested too deep"
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


def _are_deep(stmts: list[nodes.Stmt]) -> bool:
    """Whether an expression of some statements is nested too deep: all are looked through together, level by level."""
    level = [expr for stmt in stmts for expr in expressions_of(stmt)]
    for _ in range(1 + MAX_EXPRESSION):
        if not level:
            return False
        level = [part for expr in level for part in operands(expr)]
    return True
