"""Counts of rows of types that contain themselves are checked where they are not 0: most rows have none within.

count = n                                       kids = []
if count < 0:                                   behind = begin
    raise _Failed(6, begin)                     if count:
if count > end - begin:                             if count < 0:
    raise _Failed(8, begin)                             raise _Failed(6, begin)
kids = []                                           if count > end - begin:
behind = begin                                          raise _Failed(8, begin)
if count > 0:                                       ...
    ...
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from rosetta_jit.kernel.nodes import Binary, Block, Call, Convert, Expect, Expr, Let, Local, Require, Stmt
from rosetta_jit.kernel.passes.fold import TRUE, folded
from rosetta_jit.kernel.rewrite import substituted, with_operands
from rosetta_jit.kernel.terms import add, index
from rosetta_jit.kernel.walk import parts_of


def with_late_checks(block: Block, visits: Collection[str]) -> tuple[Block, dict[str, Block]]:
    """A block without the checks that hold where a count is 0, and these by the visits before which they stood."""
    found, late = list[Stmt](), dict[str, Block]()
    for stmt in _without_copies(block):
        match stmt:
            case Call(name, (_, Local() as count)) if name in visits:
                begins = [found.pop() for _ in range(isinstance(found[-1], Let))]
                checks = list[Stmt]()
                while found and _holds_of_none(found[-1], count, found[:-1]):
                    checks.insert(0, found.pop())
                late[name] = tuple(checks)
                found += [*begins, stmt]
            case _:
                found.append(stmt)
    return tuple(found), late


def _holds_of_none(check: Stmt, count: Local, before: Sequence[Stmt]) -> bool:
    """Whether a check holds where a count is 0: that for as many bytes does where the message is known to have what lies before."""
    match check:
        case Expect(condition):
            return folded(substituted(condition, {count.name: index(0)})) == TRUE
        case Require(at, size) if size == count:
            values = {each.name: each.value for each in before if isinstance(each, Let)}
            ends = [add(each.at, each.size) for each in before if isinstance(each, Require)]
            behind = [each.results[0] for each in before if isinstance(each, Call)]
            return _resolved(at, values) in [_resolved(each, values) for each in (*ends, *behind)]
        case _:
            return False


def _resolved(expr: Expr, values: Mapping[str, Expr]) -> Expr:
    """A position with values in place of all locals that have them."""
    match expr:
        case Local(_, name) if name in values:
            return _resolved(values[name], values)
        case Binary("add", left, right):
            return add(_resolved(left, values), _resolved(right, values))
        case _:
            return with_operands(expr, lambda each: _resolved(each, values))


def _without_copies(block: Block) -> Block:
    """A block in which a local that is read once, by the local behind it, is left out."""
    found = list[Stmt]()
    for stmt in block:
        match found[-1] if found else None, stmt:
            case Let(name, value), Let(_, Convert(_, Local(_, same))) if name == same and _reads(block, name) == 1:
                found[-1] = Let(stmt.name, substituted(stmt.value, {name: value}))
            case _:
                found.append(stmt)
    return tuple(found)


def _reads(block: Block, name: str) -> int:
    return sum(isinstance(part, Local) and part.name == name for part in parts_of(block))
