"""Constants, copies and values computed before go where they are used; what is decided, done once or never, or unused goes away."""

from __future__ import annotations

from collections import Counter
from dataclasses import field
from itertools import repeat

from rosetta_jit.kernel import ir
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.passes.fold import FALSE, TRUE, folded
from rosetta_jit.kernel.rewrite import ends, names_in, names_read, with_blocks, with_bodies, with_expressions, with_operands
from rosetta_jit.kernel.terms import BEGIN, END, ROW, index, split, type_of
from rosetta_jit.kernel.walk import statements, subexpressions
from rosetta_jit.startup.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class _Names:
    """What is known of a body's locals: how often each is still assigned, which are settled, their values, and what is computed already,
    with the order in which it was.

    A variable is settled behind the last Assign to it in the text. In a loop that is true until the round's end, where what was computed
    in the round is forgotten.
    """

    assigned: Counter[str]
    fixed: set[str]
    values: dict[str, ir.Expr]
    computed: dict[ir.Expr, ir.Expr]
    news: list[ir.Expr] = field(default_factory=list["ir.Expr"])


def simplify(kernel: ir.Kernel) -> ir.Kernel:
    """The kernel with less in it."""
    return with_bodies(kernel, tuple(map(_body, kernel.bodies)))


def _body(body: ir.Block) -> ir.Block:
    assigned = Counter(stmt.name for stmt, _ in statements(body) if isinstance(stmt, ir.Assign))
    names = _Names(assigned, {BEGIN.name, END.name, ROW.name}, {}, {})
    simple = _block(body, names)
    return _used(simple, names_read(simple), set())


# --- forward: values ---------------------------------------------------------------------------------------------------


def _block(block: ir.Block, names: _Names) -> ir.Block:
    result: list[ir.Stmt] = []
    for stmt in block:
        result.extend(_statement(with_expressions(stmt, lambda expr: _expression(expr, names)), names))
        if ends(tuple(result[-1:])):
            break
    return tuple(result)


def _expression(expr: ir.Expr, names: _Names) -> ir.Expr:
    if isinstance(expr, ir.Local):
        value = names.values.get(expr.name, expr)
        return names.computed.get(value, value)
    if isinstance(expr, ir.Const):
        return expr
    simple = folded(with_operands(expr, lambda operand: _expression(operand, names)))
    return names.computed.get(simple, simple)


def _statement(stmt: ir.Stmt, names: _Names) -> ir.Block:
    match stmt:
        case ir.Let(name, value):
            return _let(name, value, names)
        case ir.Var(name, value) if not names.assigned[name]:
            return _let(name, value, names)
        case ir.Assign(name, _):
            names.assigned[name] -= 1
            if not names.assigned[name]:
                names.fixed.add(name)
            return (stmt,)
        case ir.Expect(condition, _) if condition == TRUE:
            return ()
        case ir.Expect(ir.Compare("eq", ir.Local(type_, name) as local, ir.Const() as value), _) if (
            type_ not in FLOATS and name in names.fixed
        ):
            names.computed[local] = value
            names.news.append(local)
            return (stmt,)
        case ir.If(ir.Const(_, value), then, otherwise):
            return _block(then if value else otherwise, names)
        case ir.Switch(ir.Const(_, value), cases, default):
            return _block(dict(cases).get(int(value), default), names)
        case ir.For(variable, ir.Const(_, count), body) if count <= 1:
            names.values[variable] = index(0)
            return _block(body, names) if count == 1 else ()
        case ir.While(ir.Const(_, False), _, _, _):
            return ()
        case ir.Call():
            names.fixed.update(result.name for result in stmt.results)
            return (stmt,)
        case ir.HostCall():
            names.fixed.add(stmt.result.name)
            return (stmt,)
        case _:
            return _nested(stmt, names)


def _let(name: str, value: ir.Expr, names: _Names) -> ir.Block:
    base, _ = split(value)
    if isinstance(value, ir.Const) or (isinstance(base, ir.Local) and base.name in names.fixed):
        names.values[name] = value
        return ()
    names.fixed.add(name)
    if _is_settled(value, names):
        if value in names.computed:
            names.values[name] = names.computed[value]
            return ()
        names.computed[value] = ir.Local(type_of(value), name)
        names.news.append(value)
    return (ir.Let(name, value),)


def _nested(stmt: ir.Stmt, names: _Names) -> ir.Block:
    if isinstance(stmt, ir.For):
        names.fixed.add(stmt.variable)
    known = iter([(stmt.condition, TRUE), (stmt.condition, FALSE)]) if isinstance(stmt, ir.If) else repeat(None)
    simple = with_blocks(stmt, lambda block: _branch(block, names, next(known)))
    match simple:
        case ir.If(_, (), ()) | ir.For(_, _, ()):
            return ()
        case _:
            return (simple,)


def _branch(block: ir.Block, names: _Names, known: tuple[ir.Expr, ir.Expr] | None) -> ir.Block:
    """A block that may run or not, where an expression has a known value: what is computed in it is forgotten behind it."""
    mark = len(names.news)
    if known is not None and known[0] not in names.computed and _is_settled(known[0], names):
        names.computed[known[0]] = known[1]
        names.news.append(known[0])
    result = _block(block, names)
    while len(names.news) > mark:
        del names.computed[names.news.pop()]
    return result


def _is_settled(expr: ir.Expr, names: _Names) -> bool:
    """Whether an expression keeps its value, and another that is equal as text has the same: 0.0 and -0.0 are equal, not the same."""
    for part in subexpressions(expr):
        match part:
            case ir.Load() | ir.Get() | ir.Used() | ir.IsText() | ir.Nearest():
                return False
            case ir.Local(_, name) if name not in names.fixed:
                return False
            case ir.Const("f32" | "f64", 0):
                return False
            case _:
                pass
    return True


# --- backward: uses ----------------------------------------------------------------------------------------------------


def _used(block: ir.Block, read: set[str], live: set[str]) -> ir.Block:
    """The block without values that nothing reads. ``live`` gathers what is read behind; a variable is kept if it is read anywhere."""
    result: list[ir.Stmt] = []
    for stmt in reversed(block):
        match stmt:
            case ir.Let(name, _) if name not in live:
                continue
            case ir.Var(name, _) | ir.Assign(name, _) if name not in read:
                continue
            case _:
                kept = with_blocks(stmt, lambda inner: _used(inner, read, live))
        live.update(names_in((kept,)))
        result.append(kept)
    return tuple(reversed(result))
