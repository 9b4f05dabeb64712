"""What is to be known of a kernel before it is improved and compiled: how large it is, what it computes, what it asks of its host."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple

from rosetta_jit.kernel import ir, nodes
from rosetta_jit.kernel.walk import blocks_of, every_statement, parts_of, statements
from rosetta_jit.startup.dataclass import dataclass

SHORT: dict[nodes.Direction, int] = {"decode": 48, "encode": 32, "size": 32}
"""Statements up to which a call costs a kernel more than 5 % of its time. Who encodes makes bytes besides."""


SHORT_IN_VECTORS = 64
"""The same where LLVM computes many of them at once."""


MODERATE = 512
"""Statements up to which LLVM can be asked for all that it can do."""


LARGE = 4_000
"""Statements of a kernel from which on work that is done twice takes seconds."""


LARGE_WITHOUT_RULES = 500
"""The same where no rules compute anything: of what reads or writes a type as it is, a pass that comes again improves next to nothing."""


def is_large(kernel: ir.Kernel, limit: int = LARGE) -> bool:
    """Whether a kernel has so many statements that it is not worth while to improve it again and again."""
    return _are_more((pair for body in kernel.bodies for pair in statements(body)), limit)


class Counted(NamedTuple):
    """How many statements there are, and how many if each is counted once for every block that it stands in."""

    statements: int
    of_all_blocks: int


def counted(kernels: Iterable[ir.Kernel]) -> Counted:
    """The statements of kernels."""
    depths = [depth for kernel in kernels for body in kernel.bodies for _, depth in statements(body)]
    return Counted(len(depths), sum(depths))


def are_straight_and_compute(kernels: Iterable[ir.Kernel]) -> bool:
    """Whether kernels, in the first of their bodies, compute with floats, without loops and without what stands for loops."""
    every = [each for kernel in kernels for each in _usual_statements(kernel)]
    if any(isinstance(each, nodes.For | nodes.While) for each in every):
        return False
    parts = parts_of(every)
    has_floats = any(isinstance(part, nodes.Const | nodes.Convert) and part.type in ("f32", "f64") for part in parts)
    return has_floats and not any(isinstance(part, nodes.IsText | nodes.Nearest | nodes.Digits | nodes.Scale) for part in parts)


def has_loops_for_vectors(kernel: ir.Kernel) -> bool:
    """Whether a kernel has, in the first of its bodies, loops over elements that do nothing but compute, and store or add integers."""
    return any(isinstance(each, nodes.For) and is_for_vectors(each.body) for each in _usual_statements(kernel))


def is_moderate(kernel: ir.Kernel) -> bool:
    """Whether a kernel is of a size for which LLVM can be asked for all that it can do."""
    return not _are_more(_usual_statements(kernel), MODERATE)


def is_for_vectors(block: nodes.Block) -> bool:
    """Whether a loop's body does nothing but compute, and store or add integers."""
    return all(isinstance(each, nodes.Let | nodes.Store | nodes.SetField) or _gathers_integers(each) for each in block)


def _gathers_integers(stmt: nodes.Stmt) -> bool:
    """Whether a round of a loop adds an integer to what the rounds before have, or likewise, in an order that does not matter."""
    match stmt:
        case nodes.Assign(name, nodes.Binary("add" | "xor" | "or" | "and", nodes.Local(type_, variable))) if name == variable:
            return type_ not in ("f32", "f64")
        case _:
            return False


def _usual_statements(kernel: ir.Kernel) -> Iterator[nodes.Stmt]:
    """What runs for the usual message: all but the later bodies."""
    for block in (kernel.bodies[0], *(routine.body for routine in kernel.routines)):
        yield from (each for each, _ in statements(block))


def is_short_and_straight(kernel: ir.Kernel) -> bool:
    """Whether a kernel, in the first of its bodies, takes no longer than a call of it by much."""
    first = kernel.bodies[0]
    is_short = not _are_more(_on_the_way(first), SHORT[kernel.direction])
    if not is_short and (_are_more(statements(first), SHORT_IN_VECTORS) or not are_straight_and_compute((kernel,))):
        return False
    return is_straight(first)


def is_straight(block: nodes.Block) -> bool:
    """Whether a block has no loops, nor the blocks inside."""
    return not any(isinstance(each, nodes.For | nodes.While) for each, _ in statements(block))


def is_short(kernel: ir.Kernel) -> bool:
    """Whether the first of a kernel's bodies has so few statements that it can be compiled once more."""
    return not _are_more(statements(kernel.bodies[0]), SHORT_IN_VECTORS)


def _on_the_way(block: nodes.Block) -> Iterator[nodes.Stmt]:
    """The statements of a block and of those inside, but for what runs where a check has failed."""
    for stmt in block:
        yield stmt
        if not (isinstance(stmt, nodes.If) and looks_closer(stmt)):
            for inside in blocks_of(stmt):
                yield from _on_the_way(inside)


def looks_closer(stmt: nodes.If) -> bool:
    """Whether a statement makes nothing but checks, one by one, where one of all of them has failed (`passes.gather`)."""
    return not stmt.otherwise and all(isinstance(each, nodes.Expect) for each in stmt.then)


def _are_more(found: Iterable[object], most: int) -> bool:
    """Whether there are more than so many; no more are looked at than say so."""
    return next(islice(found, most, None), None) is not None


@dataclass(frozen=True, slots=True)
class HostUse:
    """What kernels ask the functions of their host, and whether they ask it for the time, or for the number of a message."""

    calls: tuple[nodes.HostCall, ...]
    asks: bool

    @property
    def ours(self) -> list[str]:
        """The names of the functions that they ask and that are not the user's, in order."""
        return sorted({call.function for call in self.calls if "." in call.function})


def use_of_host(kernels: Iterable[ir.Kernel]) -> HostUse:
    """What kernels have to do with their host, by one look through all of them."""
    every = [stmt for kernel in kernels for stmt in every_statement(kernel)]
    calls = tuple([stmt for stmt in every if type(stmt) is nodes.HostCall])
    return HostUse(calls, nodes.HostValue in set(map(type, parts_of(every))))


def calls_to_host(kernels: Iterable[ir.Kernel]) -> tuple[nodes.HostCall, ...]:
    """What kernels ask functions of the host."""
    return tuple(stmt for kernel in kernels for stmt in every_statement(kernel) if isinstance(stmt, nodes.HostCall))


def leaves_something(kernel: ir.Kernel) -> bool:
    """Whether a kernel writes into lanes, so that another one may find something there."""
    return any(_writes(stmt) for block in (*kernel.bodies, *(each.body for each in kernel.routines)) for stmt, _ in statements(block))


def _writes(stmt: nodes.Stmt) -> bool:
    match stmt:
        case nodes.SetField() | nodes.Advance():
            return True
        case nodes.Copy(target=target) | nodes.Fill(target=target):
            return isinstance(target, nodes.Place)
        case nodes.HostCall():
            return stmt.target is not None
        case _:
            return False


def our_functions(kernels: Iterable[ir.Kernel]) -> list[str]:
    """The names of the functions that kernels ask and that are not the user's, in order."""
    return use_of_host(kernels).ours


def asks_host(kernels: Iterable[ir.Kernel]) -> bool:
    """Whether kernels ask the host for the time, or for the number of a message."""
    return use_of_host(kernels).asks


def registers_read(kernel: ir.Kernel) -> set[int]:
    """The registers whose values a kernel asks for."""
    return {part.number for part in parts_of(every_statement(kernel)) if isinstance(part, nodes.Register)} if kernel.registers else set()
