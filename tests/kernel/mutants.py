"""Mutants: the proof, its record or a pass with one change, so that it demands less, takes more as known, or does something else.

Each line that can be changed gives one mutant, and each obligation two more: one that does not demand it, and one that demands one less.
Which change a line gets depends on its text alone, so that a campaign can be repeated, and a table of survivors stays true while lines
move.
"""

from __future__ import annotations

import ast
import copy
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from zlib import crc32

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Edit = Callable[[ast.AST], ast.AST]

ROOT = Path(__file__).resolve().parent.parent.parent
PROOF = (
    "verify",
    "effects",
    "contracts",
    "symbolic",
    "integers",
    "obligations",
    "scope",
    "formula",
    "prove",
    "linear",
    "paths",
    "loops",
    "record",
    "meetings",
    "without_checks",
)
PASSES = (
    "affine",
    "bulk",
    "collect",
    "drop",
    "fold",
    "forget",
    "gather",
    "hoist",
    "join",
    "merge",
    "neglect",
    "reuse",
    "simplify",
    "sink",
    "unroll",
    "widen",
    "order",
)
MODULES = tuple(
    f"rosetta_jit.kernel.{name}" for name in ("shape", "walk", *(f"proof.{name}" for name in PROOF), *(f"passes.{name}" for name in PASSES))
)

DEMANDS = {"oblige", "certify", "demand"}
LEARNS = {"assume", "derive"}
SWAPPED = {"any": "all", "all": "any", "min": "max", "max": "min", "plus": "minus", "minus": "plus"}
COMPARED = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
PRELUDE = """
def _by(formula, by):
    from rosetta_jit.kernel.proof.formula import All, Any
    from rosetta_jit.kernel.proof.linear import Linear
    match formula:
        case Linear(constant, terms):
            return Linear(constant + by, terms)
        case All(parts):
            return All(tuple(_by(part, by) for part in parts))
        case Any(parts):
            return Any(tuple(_by(part, by) for part in parts))
        case _:
            return formula
"""
"""What a mutant may call: the formula whose sums are greater by some."""


@dataclass(frozen=True)
class Mutant:
    """A module with one change: of the node of that number. ``was`` and ``made`` are its statement's first line before and after."""

    module: str
    function: str
    change: str
    was: str
    made: str
    number: int

    @property
    def name(self) -> str:
        """What the table of survivors calls it."""
        return f"{self.module.removeprefix('rosetta_jit.')} {self.function}: {self.was} -> {self.made}"

    def source(self) -> str:
        """The module's text."""
        tree = parsed(self.module)
        node = next(node for node in ast.walk(tree) if node.number == self.number)
        edit = next(edit for change, edit in _changes(node) if change == self.change)
        return f"{ast.unparse(ast.fix_missing_locations(_Edit(self.number, edit).visit(tree)))}\n{PRELUDE}"


def parsed(module: str) -> ast.Module:
    """A module, its nodes numbered."""
    tree = ast.parse(path_of(module).read_text())
    for number, node in enumerate(ast.walk(tree)):
        node.number = number
    return tree


def path_of(module: str) -> Path:
    """The file of a module."""
    path = ROOT / module.replace(".", "/")
    return path.parent / "__init__.py" if path.name == "__init__" else path.with_suffix(".py")


def mutants(module: str, share: int = 1) -> Iterator[Mutant]:
    """The mutants of a module: of each obligation, and one a line; of the latter one in so many."""
    lines: dict[int, list[Mutant]] = {}
    for function, stmt in _statements(parsed(module)):
        for node in _own(stmt):
            for change, edit in _changes(node):
                if change.startswith("demands"):
                    yield _made(module, function, stmt, node, change, edit)
                elif _number_of(f"{function} {ast.unparse(stmt)}") % share == 0:
                    lines.setdefault(_line(node), []).append(_made(module, function, stmt, node, change, edit))
    for _, made in sorted(lines.items()):
        yield made[_number_of(made[0].was) % len(made)]


def _number_of(text: str) -> int:
    """A number that a text has whether it calls the nodes of kernels by their module or not."""
    return crc32(text.replace("nodes.", "").replace("ir.", "").encode())


def _line(node: ast.AST) -> int:
    match node:
        case ast.comprehension():
            return node.target.lineno
        case ast.match_case():
            return node.pattern.lineno
        case _:
            return node.lineno


def _statements(tree: ast.Module) -> Iterator[tuple[str, ast.stmt]]:
    """The statements of all functions, each with the function's name."""
    inside: dict[int, tuple[str, ast.stmt]] = {}
    for top in ast.walk(tree):
        if isinstance(top, ast.FunctionDef):
            inside |= {stmt.number: (top.name, stmt) for stmt in ast.walk(top) if isinstance(stmt, ast.stmt)}
            inside.pop(top.number)
    yield from (each for each in inside.values() if not isinstance(each[1], ast.FunctionDef) and not _is_text(each[1]))


def _is_text(stmt: ast.stmt) -> bool:
    """Whether a statement is a docstring, or says to the type checker that nothing gets there."""
    match stmt:
        case ast.Expr(value=ast.Constant() | ast.Call(func=ast.Name(id="assert_never"))):
            return True
        case _:
            return False


def _own(stmt: ast.stmt) -> Iterator[ast.AST]:
    """A statement and the expressions in it, without those of the statements inside."""
    waiting: list[ast.AST] = [stmt]
    while waiting:
        node = waiting.pop(0)
        if isinstance(node, ast.expr | ast.comprehension | ast.match_case) or node is stmt:
            yield node
        waiting += [child for child in ast.iter_child_nodes(node) if not isinstance(child, ast.stmt | ast.pattern)]


def _changes(node: ast.AST) -> Iterator[tuple[str, Edit]]:  # noqa: C901 - one line a change
    """What can be changed about a node: a name, and a function of a copy of the node."""
    match node:
        case ast.Expr(value=ast.Call(func=ast.Name(id=name))) if name in DEMANDS:
            yield "demands nothing", lambda _: ast.Pass()
        case ast.Expr(value=ast.Call()):
            yield "does nothing", lambda _: ast.Pass()
        case ast.Raise():
            yield "demands nothing", lambda _: ast.Pass()
        case ast.Return(value=ast.Constant(value=str()) | ast.JoinedStr()):
            yield "demands nothing", lambda each: _set(each, value=ast.Constant(None))
        case ast.If() | ast.While() | ast.IfExp():
            yield "the other way", lambda each: _set(each, test=ast.UnaryOp(ast.Not(), each.test))
        case ast.AugAssign():
            yield "does nothing", lambda _: ast.Pass()
        case ast.Call(func=ast.Name(id="oblige"), args=[_, _, _]):
            yield "demands one less", lambda each: _set(each, args=[each.args[0], _by(each.args[1], 1), each.args[2]])
        case ast.Call(func=ast.Attribute(attr=name), args=[_]) if name in LEARNS:
            yield "knows one more", lambda each: _set(each, args=[_by(each.args[0], -1)])
        case ast.Call(func=ast.Name(id=name)) if name in SWAPPED:
            yield "swapped", lambda each: _set(each, func=ast.Name(SWAPPED[each.func.id], ast.Load()))
        case ast.Compare(ops=[op]):
            yield "compares otherwise", lambda each: _set(each, ops=[COMPARED[type(op)]()])
        case ast.BoolOp(op=op):
            yield "joined otherwise", lambda each: _set(each, op=ast.Or() if isinstance(op, ast.And) else ast.And())
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            yield "not negated", lambda each: each.operand
        case ast.BinOp(op=ast.Add() | ast.Sub() as op):
            yield "swapped", lambda each: _set(each, op=ast.Sub() if isinstance(op, ast.Add) else ast.Add())
        case ast.Constant(value=bool(value)):
            yield "the opposite", lambda each: _set(each, value=not value)
        case ast.Constant(value=int(value)):
            yield "one more", lambda each: _set(each, value=value + 1)
        case ast.comprehension(ifs=[_, *_]):
            yield "of all", lambda each: _set(each, ifs=[])
        case ast.match_case(guard=ast.expr()):
            yield "without its guard", lambda each: _set(each, guard=None)
        case _:
            return


def _by(formula: ast.expr, by: int) -> ast.expr:
    return ast.Call(ast.Name("_by", ast.Load()), [formula, ast.Constant(by)], [])


def _set(node: ast.AST, **changes: object) -> ast.AST:
    for name, value in changes.items():
        setattr(node, name, value)
    return node


def _made(module: str, function: str, stmt: ast.stmt, node: ast.AST, change: str, edit: Edit) -> Mutant:
    after = _Edit(node.number, edit).visit(copy.deepcopy(stmt))
    return Mutant(module, function, change, _head(stmt), _head(ast.fix_missing_locations(after)), node.number)


class _Edit(ast.NodeTransformer):
    def __init__(self, number: int, edit: Edit) -> None:
        self.number, self.edit = number, edit

    def visit(self, node: ast.AST) -> ast.AST:
        if getattr(node, "number", None) == self.number:
            return self.edit(node)
        return self.generic_visit(node)


def _head(stmt: ast.AST) -> str:
    """A statement's first line; of a match all that its cases ask."""
    if isinstance(stmt, ast.Match):
        return f"{ast.unparse(stmt).splitlines()[0]} {crc32(ast.unparse(stmt).encode()):08x}"
    return ast.unparse(stmt).splitlines()[0]
