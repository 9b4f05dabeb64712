"""Sums that several statements of a block name, as the place of a text is, become locals before the first of them.

if length > end - (at + 4):                         begin_at_4 = at + 4
    raise _Failed(3, at + 4)                        if length > end - begin_at_4:
text = data[at + 4 : at + 4 + length].decode()          raise _Failed(3, begin_at_4)
after = (at + 4) + length                           text = data[begin_at_4 : begin_at_4 + length].decode()
                                                    after = begin_at_4 + length
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from rosetta_jit.kernel.nodes import Assign, Binary, Block, Const, Expect, Expr, IsText, Let, Load, Local, Require, Stmt, Store, While, Wire
from rosetta_jit.kernel.rewrite import locals_in, with_blocks, with_expressions, with_operands
from rosetta_jit.kernel.walk import bound_names, expressions_of, statements, subexpressions

OFTEN = 3
"""How many times a block computes a sum that gets a local."""


def with_locals(block: Block) -> Block:
    """A block in which sums that it computes several times are locals."""
    found = block
    for sum_, count in Counter(each for stmt in block for each in _computed(stmt)).items():
        match sum_:
            case Binary("add", Local(_, name), Const(_, value)) if count >= OFTEN and value > 0 and not _is_address(found, sum_):
                found = _with(found, Let(f"begin\0{name}_{int(value)}", sum_)) or found
            case _:
                pass
    for name in [stmt.name for stmt in found if isinstance(stmt, Let)]:
        number, let = next((number, stmt) for number, stmt in enumerate(found) if isinstance(stmt, Let) and stmt.name == name)
        if isinstance(let.value, Binary) and any(let.value in _computed(stmt) for stmt in found[:number]):
            found = _with((*found[:number], *found[number + 1 :]), let) or found
    return tuple(with_blocks(stmt, with_locals) for stmt in found)


def ends_first(block: Block) -> Block:
    """A block that computes where a part of the message ends before it checks that the message has it."""
    found: list[Stmt] = []
    for stmt in block:
        number = next((number for number, each in enumerate(found) if _is_check_of(each, stmt)), None)
        if number is not None and isinstance(stmt, Let) and _holds(found[number:], stmt.value):
            found.insert(number, stmt)
        else:
            found.append(with_blocks(stmt, ends_first))
    return tuple(found)


def _is_check_of(check: Stmt, stmt: Stmt) -> bool:
    """Whether one statement checks that the message has a part, and another computes where that ends."""
    return isinstance(check, Require) and isinstance(stmt, Let) and stmt.value == Binary("add", check.at, check.size)


def _with(block: Block, let: Let) -> Block | None:
    """A block with a local before the first statement that names its value; nothing where that does not stay the same."""
    named = [number for number, stmt in enumerate(block) if let.value in {*_all_sums(stmt), *_computed(stmt)}]
    begin, end = named[0], named[-1] + 1
    if not _holds(block[begin:end], let.value):
        return None
    local = Local("i64", let.name)
    return (*block[:begin], let, *(_replaced(stmt, let.value, local) for stmt in block[begin:end]), *block[end:])


def _computed(stmt: Stmt) -> Iterator[Expr]:
    """The sums that a statement itself computes where nothing fails."""
    match stmt:
        case Require(at, size):
            exprs: tuple[Expr, ...] = (at, size)
        case Expect(IsText(Wire(at), size)):
            exprs = (Binary("add", at, size),)
        case Expect(condition) | While(condition):
            exprs = (condition,)
        case _:
            exprs = expressions_of(stmt)
    return (part for expr in exprs for part in subexpressions(expr) if isinstance(part, Binary) and part.op == "add")


def _all_sums(stmt: Stmt) -> set[Expr]:
    """The sums in a statement, and in those within it."""
    exprs = (expr for each, _ in statements((stmt,)) for expr in expressions_of(each))
    return {part for expr in exprs for part in subexpressions(expr) if isinstance(part, Binary)}


def _is_address(block: Sequence[Stmt], sum_: Expr) -> bool:
    """Whether a number lies there: it may be read together with those before it."""
    parts = (part for stmt, _ in statements(tuple(block)) for expr in expressions_of(stmt) for part in subexpressions(expr))
    stores = any(isinstance(stmt, Store) and stmt.at == sum_ for stmt, _ in statements(tuple(block)))
    return stores or any(isinstance(part, Load) and part.at == sum_ for part in parts)


def _holds(block: Sequence[Stmt], sum_: Expr) -> bool:
    """Whether no statement sets what a sum has."""
    names = locals_in(sum_)
    stmts = [stmt for stmt, _ in statements(tuple(block))]
    return not names & {name for stmt in stmts for name in (*bound_names(stmt), *([stmt.name] if isinstance(stmt, Assign) else []))}


def _replaced(stmt: Stmt, sum_: Expr, local: Local) -> Stmt:
    def put(expr: Expr) -> Expr:
        return local if expr == sum_ else with_operands(expr, put)

    return with_blocks(with_expressions(stmt, put), lambda block: tuple(_replaced(each, sum_, local) for each in block))
