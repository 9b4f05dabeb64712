"""Decoders that stand in the header and set elements of lists as they read them: of short messages with lists of texts, or lists within.

It is the first body of the kernel. Where anything is wrong with a message, the decoder in the source file begins anew, and says what it is.
So it does with a long message, of whose time a call takes little, and with one that has fewer bytes than a list has elements.
"""

from __future__ import annotations

from rosetta_jit.backends.printing import Namespace
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.printing.function import Function
from rosetta_jit.generate.c.printing.scope import Scope
from rosetta_jit.generate.c.printing.statements import print_block
from rosetta_jit.generate.c.support import function_names
from rosetta_jit.generate.cpp.header_checks import MOST, PARAMETERS, SHARED, is_shared, pointers
from rosetta_jit.generate.cpp.passes.empty_lists import NOT_EMPTY
from rosetta_jit.generate.cpp.passes.few_elements import lanes_of_opened
from rosetta_jit.generate.cpp.passes.texts_read import with_texts_read
from rosetta_jit.generate.passes.aligned import as_printed
from rosetta_jit.generate.passes.decided import decided
from rosetta_jit.generate.passes.reachable import reached, read_names
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Block, Stmt
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.terms import END, index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.startup.dataclass import replace

MOST_BYTES = 512
"""Messages that are short: of longer ones a call takes little of the time."""
FAIL = "return false;"
REFUSED = nodes.Call | nodes.HostCall | nodes.Return
"""What leaves the function, or may."""


def one_by_one(kernel: Kernel, lanes: Lanes) -> str:
    """The statements of such a decoder, behind which it returns; empty where there is none. ``lanes`` say which lists the kernel opens."""
    *stmts, last = reached(decided(kernel.bodies[0]))
    body = tuple(_checked(stmt, lanes.opened.union(lanes.given)) for stmt in stmts)
    body, lanes = with_texts_read(body, lanes, FAIL)
    found = [stmt for stmt, _ in statements(body)]
    is_short = isinstance(last, nodes.Return) and not last.registers and len(found) <= 2 * MOST
    if not is_short or any(isinstance(stmt, REFUSED) for stmt in found) or not _are_opened_once(body, lanes):
        return ""
    return _printed(kernel, (_few_bytes(), *body), lanes_of_opened(lanes))


def _few_bytes() -> Stmt:
    return nodes.Expect(nodes.Compare("le", END, index(MOST_BYTES)), NOT_EMPTY)


def _checked(stmt: Stmt, opened: frozenset[int]) -> Stmt:
    """A statement that finds a list to be short by the bytes of the message, in place of one that asks for room for its elements."""
    match stmt:
        case nodes.Reserve(lane, count) if lane in opened:
            return nodes.Expect(nodes.Compare("le", count, END), NOT_EMPTY)
        case _:
            return with_blocks(stmt, lambda block: tuple(_checked(each, opened) for each in block))


def _are_opened_once(body: Block, lanes: Lanes) -> bool:
    """Whether each list is opened in one place, where its elements are declared."""
    places = [(stmt.place.lane, stmt.place.offset) for stmt, _ in statements(body) if isinstance(stmt, nodes.SetField)]
    lists = [at for at in places if at in lanes.straight and lanes.straight[at].lane in lanes.opened]
    return len(lists) == len(set(lists))


def _printed(kernel: Kernel, body: Block, lanes: Lanes) -> str:
    """The statements as text, empty where they need more than what such a decoder is given."""
    scope = Scope(Namespace(lanes.words() | function_names() | {"data"}), replace(lanes, shared=SHARED), set(), set(), set())
    function = Function(scope, kernel.sites, {}, read=read_names(as_printed(body)), otherwise=FAIL)
    function.writer.depth = 2
    print_block(function, body)
    function.writer.lines[:0] = pointers(scope)
    is_free = scope.parameters <= PARAMETERS and all(map(is_shared, scope.support)) and not scope.tables
    return function.writer.text() if is_free and "given_object" in scope.parameters else ""
