"""What shows in a kernel's text without any proof: names bound once, nesting bounded, sites that exist."""

from __future__ import annotations

from itertools import chain, pairwise
from operator import attrgetter
from typing import TYPE_CHECKING, Any, assert_never

from rosetta_jit.kernel import ir
from rosetta_jit.kernel.limits import MAX_BLOCKS, MAX_EXPRESSION
from rosetta_jit.kernel.state import INDEX_WORDS
from rosetta_jit.kernel.terms import BEGIN, END, ROW

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping


SHORT = 32
"""Statements up to which a call costs any kernel more than 5 % of its time."""

SHORT_IN_VECTORS = 64
"""The same where LLVM computes many of them at once."""

MODERATE = 512
"""Statements up to which LLVM can be asked for all that it can do."""

LARGE = 4_000
"""Statements of a kernel from which on work that is done twice takes seconds."""

VAST = 12_000
"""Statements of kernels, each counted once for every block that it stands in, from which on work that grows faster takes minutes."""


def blocks_of(stmt: ir.Stmt) -> tuple[ir.Block, ...]:
    """The blocks inside a statement. A table is asked, as for all that every walk over kernels asks."""
    found = _BLOCKS.get(type(stmt))
    return () if found is None else found(stmt)


_BLOCKS: dict[type[ir.Stmt], Callable[[Any], tuple[ir.Block, ...]]] = {
    **dict.fromkeys((ir.For, ir.While), lambda stmt: (stmt.body,)),
    ir.If: attrgetter("then", "otherwise"),
    ir.Switch: lambda stmt: (*(block for _, block in stmt.cases), stmt.default),
}


def statements(block: ir.Block) -> Iterator[tuple[ir.Stmt, int]]:
    """Every statement of a block, of the blocks inside, and so on, each with its depth."""
    stack: list[Iterator[ir.Stmt]] = [iter(block)]
    nested = _BLOCKS
    while stack:
        depth = len(stack)
        for stmt in stack[-1]:
            yield stmt, depth
            if type(stmt) in nested:
                stack.append(chain.from_iterable(nested[type(stmt)](stmt)))
                break
        else:
            stack.pop()


def is_large(kernel: ir.Kernel) -> bool:
    """Whether a kernel is so large that it is not worth while to improve it again and again."""
    return sum(1 for body in kernel.bodies for _ in statements(body)) > LARGE


def are_vast(kernels: Iterable[ir.Kernel]) -> bool:
    """Whether kernels are so large, or nested so deep, that only work in proportion to their size is done on them."""
    return sum(depth for kernel in kernels for body in kernel.bodies for _, depth in statements(body)) > VAST


def are_straight_and_compute(kernels: Iterable[ir.Kernel]) -> bool:
    """Whether kernels, in the first of their bodies, compute with floats, without loops and without what stands for loops."""
    every = [each for kernel in kernels for each in _usual_statements(kernel)]
    if any(isinstance(each, ir.For | ir.While) for each in every):
        return False
    parts = parts_of(every)
    has_floats = any(isinstance(part, ir.Const | ir.Convert) and part.type in ("f32", "f64") for part in parts)
    return has_floats and not any(isinstance(part, ir.IsText | ir.Nearest | ir.Digits | ir.Scale) for part in parts)


def has_loops_for_vectors(kernel: ir.Kernel) -> bool:
    """Whether a kernel has, in the first of its bodies, loops over elements that do nothing but compute, and store or add integers."""
    return any(isinstance(each, ir.For) and _only_stores(each.body) for each in _usual_statements(kernel))


def is_moderate(kernel: ir.Kernel) -> bool:
    """Whether a kernel is of a size for which LLVM can be asked for all that it can do."""
    return sum(1 for _ in _usual_statements(kernel)) <= MODERATE


def _only_stores(block: ir.Block) -> bool:
    return all(isinstance(each, ir.Let | ir.Store | ir.SetField) or _gathers_integers(each) for each in block)


def _gathers_integers(stmt: ir.Stmt) -> bool:
    """Whether a round of a loop adds an integer to what the rounds before have, or likewise, in an order that does not matter."""
    match stmt:
        case ir.Assign(name, ir.Binary("add" | "xor" | "or" | "and", ir.Local(type_, variable))) if name == variable:
            return type_ not in ("f32", "f64")
        case _:
            return False


def _usual_statements(kernel: ir.Kernel) -> Iterator[ir.Stmt]:
    """What runs for the usual message: all but the later bodies."""
    for block in (kernel.bodies[0], *(routine.body for routine in kernel.routines)):
        yield from (each for each, _ in statements(block))


def is_short_and_straight(kernel: ir.Kernel) -> bool:
    """Whether a kernel, in the first of its bodies, takes no longer than a call of it by much."""
    every = [each for each, _ in statements(kernel.bodies[0])]
    if len(every) > SHORT and not (len(every) <= SHORT_IN_VECTORS and are_straight_and_compute((kernel,))):
        return False
    return not any(isinstance(each, ir.For | ir.While) for each in every)


def is_short(kernel: ir.Kernel) -> bool:
    """Whether the first of a kernel's bodies has so few statements that it can be compiled once more."""
    return sum(1 for _ in statements(kernel.bodies[0])) <= SHORT_IN_VECTORS


def expressions_of(stmt: ir.Stmt) -> tuple[ir.Expr, ...]:
    """The expressions that stand in a statement itself."""
    return _EXPRESSIONS[type(stmt)](stmt)


def _host_expressions(call: ir.HostCall) -> tuple[ir.Expr, ...]:
    spans = (part for extent in extents_of(call) for part in (_start(extent.address), extent.size))
    return (*call.arguments, *spans, call.failure.at, *call.failure.indices)


_EXPRESSIONS: dict[type[ir.Stmt], Callable[[Any], tuple[ir.Expr, ...]]] = {
    ir.Require: lambda stmt: (stmt.at, stmt.size, stmt.failure.at, *stmt.failure.indices),
    ir.Expect: lambda stmt: (stmt.condition, stmt.failure.at, *stmt.failure.indices),
    **dict.fromkeys((ir.Let, ir.Var, ir.Assign, ir.Switch), lambda stmt: (stmt.value,)),
    ir.Store: attrgetter("at", "value"),
    ir.SetField: attrgetter("place.row", "value"),
    **dict.fromkeys((ir.Reserve, ir.Advance, ir.For), lambda stmt: (stmt.count,)),
    ir.Copy: lambda stmt: (_start(stmt.target), _start(stmt.source), stmt.size),
    ir.Fill: lambda stmt: (_start(stmt.target), stmt.size),
    ir.While: lambda stmt: (stmt.condition, *stmt.invariant, stmt.measure),
    ir.If: lambda stmt: (stmt.condition,),
    ir.Return: lambda stmt: (stmt.position, *(value for _, value in stmt.registers)),
    ir.Call: lambda stmt: (*stmt.arguments, *stmt.indices),
    ir.HostCall: _host_expressions,
}


def operands(expr: ir.Expr) -> tuple[ir.Expr, ...]:
    """The expressions that stand in an expression itself."""
    found = _OPERANDS.get(type(expr))
    return () if found is None else found(expr)


_OPERANDS: dict[type[ir.Expr], Callable[[Any], tuple[ir.Expr, ...]]] = {
    **dict.fromkeys((ir.Binary, ir.Compare, ir.Fits), attrgetter("left", "right")),
    **dict.fromkeys((ir.Unary, ir.Convert, ir.Bits), lambda expr: (expr.operand,)),
    **dict.fromkeys((ir.Digits, ir.Scale), lambda expr: (expr.value,)),
    ir.Load: lambda expr: (expr.at,),
    ir.Get: lambda expr: (expr.place.row,),
    ir.Select: attrgetter("condition", "then", "otherwise"),
    ir.IsText: lambda expr: (_start(expr.address), expr.size),
    ir.Nearest: lambda expr: (_start(expr.address), expr.size, expr.exponent),
    ir.Lookup: lambda expr: (expr.index,),
}


def calls_to_host(kernels: Iterable[ir.Kernel]) -> list[ir.HostCall]:
    """What kernels ask functions of the host."""
    return [stmt for kernel in kernels for body in kernel.bodies for stmt, _ in statements(body) if isinstance(stmt, ir.HostCall)]


def leaves_something(kernel: ir.Kernel) -> bool:
    """Whether a kernel writes into lanes, so that another one may find something there."""
    return any(_writes(stmt) for block in (*kernel.bodies, *(each.body for each in kernel.routines)) for stmt, _ in statements(block))


def _writes(stmt: ir.Stmt) -> bool:
    match stmt:
        case ir.SetField() | ir.Advance():
            return True
        case ir.Copy(target=target) | ir.Fill(target=target):
            return isinstance(target, ir.Place)
        case ir.HostCall():
            return stmt.target is not None
        case _:
            return False


def our_functions(kernels: Iterable[ir.Kernel]) -> list[str]:
    """The names of the functions that kernels ask and that are not the user's, in order."""
    return sorted({call.function for call in calls_to_host(kernels) if "." in call.function})


def asks_host(kernels: Iterable[ir.Kernel]) -> bool:
    """Whether kernels ask the host for the time, or for the number of a message."""
    return any(isinstance(part, ir.HostValue) for kernel in kernels for part in parts_of(_statements_of(kernel)))


def registers_read(kernel: ir.Kernel) -> set[int]:
    """The registers whose values a kernel asks for."""
    return {part.number for part in parts_of(_statements_of(kernel)) if isinstance(part, ir.Register)} if kernel.registers else set()


def _statements_of(kernel: ir.Kernel) -> Iterator[ir.Stmt]:
    """The statements of all bodies."""
    return (stmt for body in kernel.bodies for stmt, _ in statements(body))


def extents_of(call: ir.HostCall) -> tuple[ir.Extent, ...]:
    """The bytes that a function of the host reads, and those that it fills."""
    return call.inputs if call.target is None else (*call.inputs, call.target)


def subexpressions(expr: ir.Expr) -> list[ir.Expr]:
    """An expression and all inside it."""
    return _with_parts([expr])


def parts_of(stmts: Iterable[ir.Stmt]) -> list[ir.Expr]:
    """All expressions of some statements, and all inside them."""
    return _with_parts([expr for stmt in stmts for expr in _EXPRESSIONS[type(stmt)](stmt)])


def _with_parts(parts: list[ir.Expr]) -> list[ir.Expr]:
    """Expressions and, behind them, all inside them."""
    inside = _OPERANDS
    for part in parts:  # which grows
        if type(part) in inside:
            parts += inside[type(part)](part)
    return parts


def bound_names(stmt: ir.Stmt) -> tuple[str, ...]:
    """The names that a statement binds."""
    found = _BOUND.get(type(stmt))
    return () if found is None else found(stmt)


_BOUND: dict[type[ir.Stmt], Callable[[Any], tuple[str, ...]]] = {
    **dict.fromkeys((ir.Let, ir.Var), lambda stmt: (stmt.name,)),
    ir.For: lambda stmt: (stmt.variable,),
    ir.Call: lambda stmt: tuple([result.name for result in stmt.results]),
    ir.HostCall: lambda stmt: (stmt.result.name,),
}


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


def _registers_error(count: int, every: list[ir.Stmt]) -> str | None:
    changed = [[number for number, _ in stmt.registers] for stmt in every if isinstance(stmt, ir.Return)]
    named = {part.number for part in parts_of(every) if isinstance(part, ir.Register)} | {
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
        isinstance(stmt, ir.Return | ir.Reserve | ir.Advance | ir.HostCall) or any(map(_of_a_body, expressions_of(stmt)))
        for stmt, _ in inside
    ):
        return "something that only a body can do"
    names = BEGIN.name, END.name, *(parameter.name for parameter in routine.parameters)
    if len(set(names)) < len(names):
        return "a parameter that is named twice"
    return _statements_error(inside, names, len(routine.sites), before)


def _of_a_body(expr: ir.Expr) -> bool:
    """Whether an expression asks for a used length, for what the host tells, or for a register."""
    return any(isinstance(part, ir.Used | ir.HostValue | ir.Register) for part in subexpressions(expr))


def _statements_error(
    inside: Iterable[tuple[ir.Stmt, int]], names: tuple[str, ...], sites: int, routines: tuple[ir.Routine, ...]
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


def _statement_error(stmt: ir.Stmt, depth: int, sites: int, routines: Mapping[str, ir.Routine]) -> str | None:
    if depth > MAX_BLOCKS:
        return "blocks are nested too deep"
    if any(_too_deep(expr) for expr in expressions_of(stmt)):
        return "an expression is nested too deep"
    match stmt:
        case ir.Require(_, _, failure) | ir.Expect(_, failure) | ir.HostCall(_, _, _, failure):
            return _failing_error((failure.site,), failure.indices, sites)
        case ir.Call(name, arguments, results, named, indices):
            routine = routines.get(name)
            if routine is None:
                return f"no routine {name} before"
            counts = len(arguments), len(results), 1 + len(named)
            if counts != (len(routine.parameters), len(routine.results), len(routine.sites)):
                return f"a call that does not fit {name}"
            return _failing_error(named, indices, sites)
        case _:
            return None


def _failing_error(named: tuple[int, ...], indices: tuple[ir.Expr, ...], sites: int) -> str | None:
    missing = [site for site in named if not 1 <= site < sites]
    if missing:
        return f"no site {missing[0]}"
    return "too many indices" if len(indices) > INDEX_WORDS else None


def _too_deep(expr: ir.Expr) -> bool:
    level = operands(expr)
    for _ in range(MAX_EXPRESSION):
        if not level:
            return False
        level = tuple(chain.from_iterable(map(operands, level)))
    return True


def _start(address: ir.Address) -> ir.Expr:
    match address:
        case ir.Wire(at):
            return at
        case ir.Place(_, row, _):
            return row
        case _:
            assert_never(address)
