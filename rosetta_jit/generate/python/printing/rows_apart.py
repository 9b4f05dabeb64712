"""Functions for the rows of types that contain themselves (see `passes/rows_apart`): a message that brings none calls none.

def _borrow_1_rows(data, end, most, cursor, kids, kids_q, kids_room, kids_used):
    kids_name_q = _EMPTY_q                          lanes that nothing but these rows has to do with
    ...
    def made_kids(index):
        ...
    own_kids = kids_used                            rows of the message itself, before the loop finds others in them
    while cursor < kids_used:
        ...
    own_rows = [made_kids(index) for index in range(own_kids)]
    del made_kids
    return own_rows

made_kids = _borrow_1_rows(...) if kids_used else []
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from rosetta_jit.generate.python.printing.beginning import begin, completed, empty_lane, lanes_of_function
from rosetta_jit.generate.python.printing.printed import Function
from rosetta_jit.generate.python.printing.statements import print_block
from rosetta_jit.generate.unit import Role
from rosetta_jit.kernel.nodes import Block
from rosetta_jit.kernel.walk import bound_names

FROM_CALL = ("data", "end", "most")


def print_rows_apart(function: Function, role: Role, body: Block, apart: range, name: str) -> tuple[frozenset[int], list[str]]:
    """The statements of a body, of which some become a call; gives the lanes that only those have to do with, and their function."""
    scope, objects = function.scope, function.objects
    print_block(function, body[: apart.start])
    before = function.writer.lines[:]
    function.writer.lines.clear()
    print_block(function, body[apart.start : apart.stop])
    inner = [each for line in function.writer.lines for each in completed(line, function)]
    function.writer.lines.clear()
    made = objects.inner(scope)
    scope.has_rows_apart = True
    print_block(function, body[apart.stop :])
    after = function.writer.lines[:]
    outside = _words(each for line in (*objects.begun(scope), *before, *after) for each in completed(line, function))
    late = frozenset[int]().union(*(each.lanes for each in scope.direct.fields))
    names = {lane: {line.partition(" = ")[0] for line in empty_lane(function, lane)} for lane in lanes_of_function(function) - {0}}
    within = frozenset(lane for lane in names.keys() - late if not names[lane] & outside)
    rows = [lane for lane in sorted(names) if f"made_{scope.lanes.rows(lane)}" in outside]
    used, found = [scope.used(lane) for lane in rows], [f"made_{scope.lanes.rows(lane)}" for lane in rows]
    own = [scope.locals.identifier(f"own\0{scope.lanes.rows(lane)}") for lane in rows]
    index, result = scope.locals.identifier("index"), scope.locals.identifier("own\0rows")
    lists = ", ".join(f"[{one}({index}) for {index} in range({count})]" for one, count in zip(found, own, strict=True))
    lines = [
        *begin(function, role, names.keys() - within, says=False),
        *made,
        *(f"{count} = {each}" for count, each in zip(own, used, strict=True)),
        *(line.removeprefix("    ") for line in inner),
        f"{result} = {lists}",
        f"del {', '.join(objects.inner_names(scope))}",
        f"return {result}",
    ]
    given = {scope.locals.identifier(each) for stmt in body[: apart.start] for each in bound_names(stmt) if each in function.read}
    given |= {*FROM_CALL, *(f"call_{what}" for what in scope.from_call)}.union(*(names[lane] for lane in names.keys() - within - late))
    needed = sorted(given & _words(lines), key=lambda each: (each not in FROM_CALL, each))
    call, none = f"{name}({', '.join(needed)})", ", ".join(["()"] * len(rows))
    function.writer.lines[:] = [
        *before,
        f"    {', '.join(found)} = {call} if {' or '.join(used)} else {f'({none})' if len(rows) > 1 else none}",
        *after,
    ]
    return within, [f"def {name}({', '.join(needed)}):", *(f"    {line}" if line else "" for line in lines)]


def _words(lines: Iterable[str]) -> set[str]:
    return set(re.findall(r"\w+", "\n".join(lines)))
