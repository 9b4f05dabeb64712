"""Presence words that nothing reads: objects say by themselves, or locals do, which fields have come.

present = 0                                         has_pose = False
...                                                 ...
        present = present | 2                               if not has_pose:
        ...                                                     has_pose = True
message.presence = present                          made.pose = ... if has_pose else None
"""

from __future__ import annotations

from collections.abc import Set

from rosetta_jit.generate.python.printing.scope import Scope
from rosetta_jit.kernel.nodes import Block, Get, Place, SetField, Stmt
from rosetta_jit.kernel.rewrite import with_blocks
from rosetta_jit.kernel.terms import index
from rosetta_jit.kernel.walk import expressions_of, statements, subexpressions
from rosetta_jit.model.layout import Layout, Row


def unasked_words(body: Block, layout: Layout | None, scope: Scope) -> frozenset[Place]:
    """The presence words of the message all of whose fields are attributes if they come, or have a local that says so."""
    if layout is None or not isinstance(layout.root, Row) or not scope.flat:
        return frozenset()
    asked, root = set[int](), layout.root
    for each in root.members:
        late = scope.direct.late_at(each.slot)
        is_told = (late is not None and late.is_presence) or getattr(each.slot, "offset", None) in (scope.attributes or {})
        if each.presence is not None and not is_told:
            asked.add(each.presence // 64)
    read = {
        part.place
        for stmt, _ in statements(body)
        for expr in expressions_of(stmt)
        for part in subexpressions(expr)
        if isinstance(part, Get)
    }
    words = (Place(0, index(0), root.offset + 8 * number) for number in range(root.presence_words) if number not in asked)
    return frozenset(place for place in words if place not in read)


def without_words(block: Block, places: Set[Place]) -> Block:
    """A block that sets none of some words."""

    def inside(stmt: Stmt) -> Stmt:
        return with_blocks(stmt, lambda inner: without_words(inner, places))

    return tuple(inside(stmt) for stmt in block if not (isinstance(stmt, SetField) and stmt.place in places)) if places else block
