"""Constants, copies and values computed before go where they are used; what is decided, done once or never, or unused goes away."""

from __future__ import annotations

from collections import Counter
from itertools import repeat

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.passes.fold import FALSE, TRUE, folded
from rosetta_jit.kernel.rewrite import OF_MEMORY, ends, names_read, with_blocks, with_bodies, with_expressions, with_operands
from rosetta_jit.kernel.terms import BEGIN, END, ROW, index, split, type_of
from rosetta_jit.kernel.walk import NESTED, flat, parts_of, subexpressions
from rosetta_jit.startup.dataclass import dataclass, field


@dataclass(frozen=True, slots=True)
class _Names:
    """What is known of a body's locals: how often each is still assigned, which are settled, their values, and what is computed already,
    with the order in which it was.

    A variable is settled behind the last Assign to it in the text. In a loop that is true until the round's end, where what was computed
    in the round is forgotten.
    """

    assigned: Counter[str]
    fixed: set[str]
    values: dict[str, nodes.Expr]
    computed: dict[nodes.Expr, nodes.Expr]
    news: list[nodes.Expr] = field(default_factory=list["nodes.Expr"])
    kinds: set[type[nodes.Expr]] = field(default_factory=set["type[nodes.Expr]"])

    def learn(self, expr: nodes.Expr, value: nodes.Expr) -> None:
        """An expression has a value from here on."""
        self.computed[expr] = value
        self.news.append(expr)
        self.kinds.add(type(expr))

    def simple(self, expr: nodes.Expr) -> nodes.Expr:
        """The simplest form of an expression. Of most nothing is known, which their kind tells in less time than their hash."""
        match expr:
            case nodes.Const():
                return expr
            case nodes.Local():
                found = self.values.get(expr.name, expr)
            case _:
                found = folded(with_operands(expr, self.simple))
        return self.computed.get(found, found) if type(found) in self.kinds else found


def simplify(kernel: ir.Kernel) -> ir.Kernel:
    """The kernel with less in it."""
    return with_bodies(kernel, tuple(map(_body, kernel.bodies)))


def _body(body: nodes.Block) -> nodes.Block:
    assigned = Counter([stmt.name for stmt in flat(body) if type(stmt) is nodes.Assign])
    names = _Names(assigned, {BEGIN.name, END.name, ROW.name}, {}, {})
    simple = _block(body, names)
    return _used(simple, names_read(simple), set())


# --- forward: values ---------------------------------------------------------------------------------------------------


def _block(block: nodes.Block, names: _Names) -> nodes.Block:
    result: list[nodes.Stmt] = []
    for stmt in block:
        made = _statement(with_expressions(stmt, names.simple), names)
        result += made
        if made and ends(made):
            break
    return tuple(result)


def _statement(stmt: nodes.Stmt, names: _Names) -> nodes.Block:
    match stmt:
        case nodes.Let(name, value):
            return _let(name, value, names)
        case nodes.Var(name, value) if not names.assigned[name]:
            return _let(name, value, names)
        case nodes.Assign(name, _):
            names.assigned[name] -= 1
            if not names.assigned[name]:
                names.fixed.add(name)
            return (stmt,)
        case nodes.Expect(nodes.Const(_, value), _) if value:
            return ()
        case nodes.Expect(nodes.Compare("eq", nodes.Local(type_, name) as local, nodes.Const() as value), _) if (
            type_ not in FLOATS and name in names.fixed
        ):
            names.learn(local, value)
            return (stmt,)
        case nodes.If(nodes.Const(_, value), then, otherwise):
            return _block(then if value else otherwise, names)
        case nodes.Switch(nodes.Const(_, value), cases, default):
            return _block(dict(cases).get(int(value), default), names)
        case nodes.For(variable, nodes.Const(_, count), body) if count <= 1:
            names.values[variable] = index(0)
            return _block(body, names) if count == 1 else ()
        case nodes.While(nodes.Const(_, False), _, _, _):
            return ()
        case nodes.Call():
            names.fixed.update(result.name for result in stmt.results)
            return (stmt,)
        case nodes.HostCall():
            names.fixed.add(stmt.result.name)
            return (stmt,)
        case _:
            return _nested(stmt, names)


def _let(name: str, value: nodes.Expr, names: _Names) -> nodes.Block:
    base, _ = split(value)
    if isinstance(value, nodes.Const) or (isinstance(base, nodes.Local) and base.name in names.fixed):
        names.values[name] = value
        return ()
    names.fixed.add(name)
    if _is_settled(value, names):
        if value in names.computed:
            names.values[name] = names.computed[value]
            return ()
        names.learn(value, nodes.Local(type_of(value), name))
    return (nodes.Let(name, value),)


def _nested(stmt: nodes.Stmt, names: _Names) -> nodes.Block:
    if type(stmt) not in NESTED:
        return (stmt,)
    if isinstance(stmt, nodes.For):
        names.fixed.add(stmt.variable)
    known = iter([(stmt.condition, TRUE), (stmt.condition, FALSE)]) if isinstance(stmt, nodes.If) else repeat(None)
    simple = with_blocks(stmt, lambda block: _branch(block, names, next(known)))
    return () if _does_nothing(simple) else (simple,)


def _does_nothing(stmt: nodes.Stmt) -> bool:
    match stmt:
        case nodes.If(_, (), ()) | nodes.For(_, _, ()):
            return True
        case _:
            return False


def _branch(block: nodes.Block, names: _Names, known: tuple[nodes.Expr, nodes.Expr] | None) -> nodes.Block:
    """A block that may run or not, where an expression has a known value: what is computed in it is forgotten behind it."""
    mark = len(names.news)
    if known is not None and known[0] not in names.computed and _is_settled(known[0], names):
        names.learn(*known)
    result = _block(block, names)
    while len(names.news) > mark:
        del names.computed[names.news.pop()]
    return result


def _is_settled(expr: nodes.Expr, names: _Names) -> bool:
    """Whether an expression keeps its value, and another that is equal as text has the same: 0.0 and -0.0 are equal, not the same."""
    for part in subexpressions(expr):
        kind = type(part)
        if kind in OF_MEMORY:
            return False
        if isinstance(part, nodes.Local) and part.name not in names.fixed:
            return False
        if isinstance(part, nodes.Const) and not part.value and part.type in FLOATS:
            return False
    return True


# --- backward: uses ----------------------------------------------------------------------------------------------------


def _used(block: nodes.Block, read: set[str], live: set[str]) -> nodes.Block:
    """The block without values that nothing reads. ``live`` gathers what is read behind; a variable is kept if it is read anywhere."""
    result: list[nodes.Stmt] = []
    for stmt in reversed(block):
        match stmt:
            case nodes.Let(name, _) if name not in live:
                continue
            case nodes.Var(name, _) | nodes.Assign(name, _) if name not in read:
                continue
            case _:
                kept = with_blocks(stmt, lambda inner: _used(inner, read, live))
                if _does_nothing(kept):
                    continue
        live.update([part.name for part in parts_of((kept,)) if type(part) is nodes.Local])
        result.append(kept)
    return tuple(reversed(result))
