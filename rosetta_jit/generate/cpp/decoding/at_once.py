"""Decoders that stand in the header, where a compiler sees the object, too, and makes no call: of messages that take a few statements.

It is the first body of the kernel for messages whose lists are empty, or have few elements. It has nothing to do where something is wrong
with a message: it says that it has not read it, and the decoder in the source file begins anew. So all checks come first, and branches that
set nothing count as something wrong. Where elements of lists must be set as they are read, `one_by_one` does it.
"""

from __future__ import annotations

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.printing.function import Function
from rosetta_jit.generate.c.printing.scope import Scope
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.cpp.decoding.one_by_one import one_by_one
from rosetta_jit.generate.cpp.header_checks import MOST, PARAMETERS, SHARED, are_marked, check, is_shared, pointers
from rosetta_jit.generate.cpp.passes.checks import fewer
from rosetta_jit.generate.cpp.passes.empty_lists import lanes_of_empty_lists, lanes_of_nothing, lists_of, of_empty_lists, of_nothing
from rosetta_jit.generate.cpp.passes.few_elements import lanes_of_opened, of_few_elements
from rosetta_jit.generate.cpp.passes.opened import without_asking, without_counting
from rosetta_jit.generate.passes.reachable import read_names
from rosetta_jit.generate.passes.roundings import two_roundings
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.passes.fold import FALSE, folded
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import replace


def is_called(lengths: int, reads_empty: str) -> bool:
    """Whether a decoder that sets so many texts, arrays and lists is called, not the one that ``reads_empty`` messages."""
    return reads_empty != "" and lengths > 1


def at_once(kernel: Kernel, lanes: Lanes, apart: tuple[Kernel, Lanes], reads_empty: str) -> tuple[str, int]:
    """The statements of such a decoder, empty where there is none, and how many texts, arrays and lists they set that have a length.

    ``lanes`` say how the kernel reaches the object, ``apart`` are kernel and lanes of a decoder that opens all lists. ``reads_empty`` are
    the statements of a decoder of messages without elements. None is called that needs lists to be empty: other messages would cost a call
    more. Of one that sets elements as it reads them a compiler says whether it is called.
    """
    if two_roundings((kernel,)):
        return "", 0
    opening, reached = without_counting(without_asking(apart[0], apart[1].opened), apart[1].given), apart[1]
    text, lengths = _checked_first(kernel, of_few_elements(opening.bodies[0], reached), lanes_of_opened(reached))
    if text:
        return text, lengths
    if text := one_by_one(opening, reached):
        return text, 1
    text, lengths = _checked_first(kernel, of_empty_lists(kernel.bodies[0], lanes), lanes_of_empty_lists(lanes))
    return ("", 0) if lists_of(lanes) and is_called(lengths, reads_empty) else (text, lengths)


def of_no_elements_at_once(kernel: Kernel, lanes: Lanes) -> str:
    """The same of messages whose texts and lists are all empty, for which their size is looked at first."""
    found = _straightened(of_nothing(kernel.bodies[0], lanes))
    if found is None or two_roundings((kernel,)):
        return ""
    checks, effects = found
    if any(isinstance(stmt, nodes.Expect) and stmt.condition == FALSE for stmt in checks):
        return ""
    return _printed(kernel, fewer(checks, is_sized=True), effects, lanes_of_nothing(lanes))


def _printed(kernel: Kernel, checks: nodes.Block, effects: nodes.Block, lanes: Lanes) -> str:
    """The statements of both, empty where they need more than what such a decoder is given."""
    words = lanes.words() | function_names() | {"data"}
    scope = Scope(Namespace(words), replace(lanes, shared=SHARED), set(), set(), set())
    function = Function(scope, kernel.sites, {}, read=read_names((*checks, *effects)))
    function.writer.depth = 2
    marked = are_marked(checks)
    for stmt in checks:
        check(function, stmt, "return false;", marked=marked)
    _print_effects(function, effects)
    is_free = scope.parameters <= PARAMETERS and all(map(is_shared, scope.support)) and not scope.tables
    return function.writer.text() if is_free and "given_object" in scope.parameters else ""


def _checked_first(kernel: Kernel, body: nodes.Block, lanes: Lanes) -> tuple[str, int]:
    """The statements of a body that checks all of a message before it sets anything, and how many texts, arrays and lists they set."""
    parts = _straightened(body)
    if parts is None:
        return "", 0
    checks, effects = parts
    lengths = sum(_has_length(lanes, each) - _is_fixed(lanes, each) for each in effects)
    return _printed(kernel, fewer(checks, is_sized=lengths == 0), effects, lanes), lengths


def _straightened(body: nodes.Block) -> tuple[nodes.Block, nodes.Block] | None:
    """What a body checks and what it sets, if it does nothing else; a check that fails stands for a branch that sets nothing."""
    if not body:
        return None
    *stmts, last = body
    checks, effects = list[nodes.Stmt](), list[nodes.Stmt]()
    for stmt in stmts:
        match stmt:
            case nodes.Require() | nodes.Expect() | nodes.Let():
                checks.append(stmt)
            case nodes.SetField() | nodes.Copy(nodes.Place(), nodes.Wire()) | nodes.Advance():
                effects.append(stmt)
            case nodes.If(_, (nodes.Copy(nodes.Place(), nodes.Wire()),), ()):
                effects.append(stmt)
            case nodes.For() if all(isinstance(each, nodes.Let | nodes.SetField | nodes.Copy) for each in stmt.body):
                effects.append(stmt)
            case nodes.If(condition, then, ()) if _only_checks(then):
                failure = nodes.Failure(0, nodes.Const("i64", 0))
                checks.append(nodes.Expect(folded(nodes.Unary("not", condition)), failure))
            case _:
                return None
    is_short = isinstance(last, nodes.Return) and not last.registers and sum(1 for _ in statements(body)) <= MOST
    return (tuple(checks), tuple(effects)) if is_short and _starts_with_bytes(checks) else None


def _has_length(lanes: Lanes, stmt: nodes.Stmt) -> bool:
    """Whether a statement sets a text or an array, as long as the message says."""
    straight = lanes.straight.get((stmt.place.lane, stmt.place.offset)) if isinstance(stmt, nodes.SetField) else None
    return isinstance(stmt, nodes.Advance) or (straight is not None and straight.is_span)


def _is_fixed(lanes: Lanes, stmt: nodes.Stmt) -> bool:
    """Whether a statement says how many bytes these are, of which each message has as many."""
    match stmt:
        case nodes.SetField(nodes.Place(lane, _, offset), nodes.Const(_, int(count))) if count < -1:
            text = lanes.straight.get((lane, offset - 8))
            return text is not None and text.text
        case _:
            return False


def _only_checks(block: nodes.Block) -> bool:
    """Whether a message is the same without a block, if nothing is wrong with it."""
    return all(isinstance(stmt, nodes.Require | nodes.Expect | nodes.Let | nodes.If | nodes.For) for stmt, _ in statements(block))


def _starts_with_bytes(checks: list[nodes.Stmt]) -> bool:
    """Whether a size that is not one is found first."""
    match checks[0] if checks else None:
        case nodes.Require(nodes.Const(), nodes.Const()):
            return True
        case _:
            return False


def _print_effects(function: Function, effects: nodes.Block) -> None:
    """What sets the object, behind pointers to its arrays."""
    lines = function.writer.lines
    before = len(lines)
    print_block(function, effects)
    lines[before:before] = pointers(function.scope)
