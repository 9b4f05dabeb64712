"""Functions that read the rows of types that contain themselves, which call each other (see `descents`).

def _read_kids(data, end, left, at, depth):
    ...
    return m(kids_v, kids_n, kids_2), at_2
"""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.backends.printing import Writer
from rosetta_jit.generate.passes.descents import Descents, NotNested
from rosetta_jit.generate.passes.reachable import read_names
from rosetta_jit.generate.python.passes.bools import with_bytes
from rosetta_jit.generate.python.passes.borrowed import borrowed_block
from rosetta_jit.generate.python.passes.groups import not_negative
from rosetta_jit.generate.python.passes.late_checks import with_late_checks
from rosetta_jit.generate.python.passes.search import FEW, direct
from rosetta_jit.generate.python.passes.sums import ends_first, with_locals
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.scope import Scope
from rosetta_jit.generate.python.printing.statements import COPY, print_block
from rosetta_jit.kernel import nodes

OF_READERS = frozenset(("left", "element"))
"""What no other local of these functions is called: how many rows of each lane there may still be, and one of them."""


def print_readers(writer: Writer, descents: Descents, function: Callable[[], Function]) -> bool:
    """The functions of all lanes; gives whether arrays may be views of the message. Raises NotNested where one would need rows of lanes."""
    printed = [_reader(lane, descents, function()) for lane in sorted(descents.rows)]
    copies = any("copy" in scope.from_call for scope, _ in printed)
    for _, lines in printed:
        writer.lines += [*([""] * 2 if writer.lines else []), *(with_copy(line, copies=copies) for line in lines)]
    return copies


def with_copy(line: str, *, copies: bool) -> str:
    """A line with what it stands for."""
    return line.replace(COPY, ", call_copy" if copies else "")


def counts_of_rows(descents: Descents, scope: Scope) -> list[str]:
    """The line that begins to count the rows of all lanes; raises NotNested where the message needs rows of one."""
    if any(lane in descents.rows for lane, _ in scope.views):
        raise NotNested
    return [f"left = [most] * {len(descents.left)}"]


def _reader(lane: int, descents: Descents, function: Function) -> tuple[Scope, list[str]]:
    scope, kernel, objects = function.scope, function.kernel, function.objects
    assert objects.layout is not None
    block = borrowed_block(with_locals(with_bytes(descents.rows[lane])), kernel, objects.layout)
    row = nodes.Place(lane, descents.row)
    block, scope.direct = direct(block, kernel, objects.layout, objects.inner_arrays, objects.blobs, few=0 if scope.numpy else FEW, row=row)
    function.positive = not_negative(block, descents.behind())
    block, checks = with_late_checks(ends_first(block), descents.visits)
    *stmts, last = block
    assert isinstance(last, nodes.Return)
    scope.direct.visits, scope.direct.left, scope.direct.checks = descents.visits, descents.left, checks
    function.read = read_names(block, scope.direct.read())
    at, depth = (scope.locals.identifier(each.name) for each in (descents.at, descents.depth))
    print_block(function, tuple(stmts))
    result = f"{objects.row(scope, lane)}, {function.text(last.position)}"
    if scope.views or scope.counted or scope.rooms or scope.rows or function.moved or scope.from_call - {"copy"}:
        raise NotNested
    head = f"def {scope.reader(lane)}(data, end, left, {at}, {depth}{COPY}):"
    return scope, [head, *function.writer.lines, f"    return {result}"]
