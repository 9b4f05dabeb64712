"""The statements of a decoder that read the rows of types that contain themselves, all of which a message may lack.

limit = end + 1
done = 0
while (done < limit) and (cursor < kids_used):      a message without kids gets here with 0 rows, and needs no locals for their fields
    ...
"""

from __future__ import annotations

from rosetta_jit.generate.passes.reachable import read_names
from rosetta_jit.generate.python.passes.mentions import assigned, changed_lane, lanes_of
from rosetta_jit.generate.python.passes.slots import parts_of
from rosetta_jit.kernel.ir import Kernel
from rosetta_jit.kernel.nodes import Advance, Binary, Block, Call, Compare, Const, Expr, Let, Local, Stmt, Used, Var, While
from rosetta_jit.kernel.rewrite import may_return, names_read
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import statements
from rosetta_jit.model.layout import Layout, Span
from rosetta_jit.startup.dataclass import replace

NO_ROWS = range(0)


def rows_apart(body: Block, kernel: Kernel, layout: Layout) -> tuple[Block, range]:
    """A body, and those statements by number: the loop, behind the locals that only it reads. None where others need what they change."""
    recursive = {lane for lane, _ in layout.recursive}
    loops = [stmt for stmt in body if isinstance(stmt, While) and _visits(stmt, recursive)]
    if kernel.kept or len(loops) != 1:
        return body, NO_ROWS
    before, after = body[: body.index(loops[0])], body[body.index(loops[0]) + 1 :]
    begun = _begun_for_loop(before, after)
    before, apart = tuple(stmt for stmt in before if stmt not in begun), (*(_at_first(stmt) for stmt in begun), *loops)
    inner = [stmt for stmt, _ in statements(apart)]
    changed = {changed_lane(stmt) for stmt in inner} | {lane for stmt in inner for lane in lanes_of(stmt) if not lane}
    if changed & {0, *_lanes_of_message(layout, recursive)} or assigned(apart) & read_names(after) or may_return(apart):
        return body, NO_ROWS
    return (*before, *apart, *after), range(len(before), len(before) + len(apart))


def _begun_for_loop(before: Block, after: Block) -> tuple[Let | Var, ...]:
    """The statements that begin locals which only the loop reads, and may stand right before it.

    Those are the last ones, constants, and how many rows of a lane there are before any are taken: none.
    """
    found, others = list[Let | Var](), names_read(after)
    for number, stmt in reversed([*enumerate(before)]):
        is_last = len(found) == len(before) - number - 1
        if isinstance(stmt, Let | Var) and stmt.name not in others and (is_last or _stays_the_same(stmt, before[:number])):
            found.insert(0, stmt)
        else:
            others |= names_read((stmt,)) | assigned((stmt,))
    return tuple(found)


def _stays_the_same(stmt: Let | Var, before: Block) -> bool:
    """Whether a local would begin with the same, or with 0, wherever it stands: no statement ``before`` it takes rows."""
    is_first = not any(isinstance(each, Advance | Call) for each, _ in statements(before))
    return isinstance(stmt.value, Const) or (isinstance(stmt.value, Used) and is_first)


def _at_first(stmt: Let | Var) -> Stmt:
    """A statement that says of a lane that it has no row yet."""
    return replace(stmt, value=index(0)) if isinstance(stmt.value, Used) else stmt


def _visits(loop: While, recursive: set[int]) -> bool:
    """Whether a loop goes on while there are rows of some lanes that it has not read: without any it ends at once."""
    match loop.condition:
        case Binary("and", _, rows):
            asked = _lanes_with_rows(rows)
            return bool(asked) and asked <= recursive
        case _:
            return False


def _lanes_with_rows(condition: Expr) -> set[int]:
    """The lanes one of which has more rows than a local says, if that is what a condition asks."""
    match condition:
        case Compare("lt", Local(), Used(lane)):
            return {lane}
        case Binary("or", left, right) if (one := _lanes_with_rows(left)) and (other := _lanes_with_rows(right)):
            return one | other
        case _:
            return set()


def _lanes_of_message(layout: Layout, recursive: set[int]) -> set[int]:
    """The lanes of all that is in a message but within rows of its own type."""
    found, pending = set[int](), [layout.root]
    while pending:
        spans = [each for each in parts_of(pending.pop()) if isinstance(each, Span) and each.lane not in found | recursive]
        found |= {each.lane for each in spans}
        pending += [layout.lanes[each.lane].element for each in spans]
    return found
