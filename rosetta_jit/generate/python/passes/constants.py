"""A constant that a message begins with is read together with the numbers behind it: by one call.

if _load_Q_be(data, 0)[0] != 41:                    code, speed = _load_Qd_be(data, 0)
    raise _Failed(3, 0)                             if code != 41:
speed = _load_d_be(data, 8)[0]                          raise _Failed(3, 0)
"""

from __future__ import annotations

from rosetta_jit.generate.python.passes.groups import continues
from rosetta_jit.kernel.nodes import Block, Compare, Const, Expect, Let, Load, Local, Stmt


def with_constants(block: Block) -> Block:
    """A block that compares constants behind the numbers that follow them in the message, where it takes these at once."""
    found: list[Stmt] = []
    rest = list(block)
    while rest:
        stmt = rest.pop(0)
        match stmt:
            case Expect(Compare("eq", Load(type_) as load, Const() as value), failure) if type_ != "bool":
                code = Local(type_, f"code\0{len(found)}")
                group: list[Stmt] = [Let(code.name, load)]
                while rest and continues(group, rest[0]):
                    group.append(rest.pop(0))
                found += [*group, Expect(Compare("eq", code, value), failure)] if len(group) > 1 else [stmt]
            case _:
                found.append(stmt)
    return tuple(found)
