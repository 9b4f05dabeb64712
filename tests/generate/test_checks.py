"""Checks of a decoder in a header: fewer of them accept the same messages."""

from __future__ import annotations

from random import Random

import pytest

from rosetta_jit.generate.cpp.passes.checks import fewer
from rosetta_jit.kernel import arithmetic, nodes
from rosetta_jit.kernel.terms import END, add, index, type_of

AT, COUNT, PADDING = (nodes.Local("i64", name) for name in ("at", "count", "padding"))
WRONG = nodes.Failure(1, index(0))


def value(expr: nodes.Expr, message: bytes, known: dict[str, int]) -> int:
    """An expression of a message."""

    def of(inner: nodes.Expr) -> int:
        return value(inner, message, known)

    match expr:
        case nodes.Const(_, number):
            return int(number)
        case nodes.Local(_, name):
            return known[name]
        case nodes.Load(type_, at, order):
            there = message[of(at) : of(at) + nodes.WIDTH[type_]]
            assert len(there) == nodes.WIDTH[type_], "a check reads what is not there"
            return int(arithmetic.from_bytes(type_, there, order))
        case nodes.Convert(type_, operand):
            return int(arithmetic.convert(type_, of(operand)))
        case nodes.Binary("and", left, right):
            return of(left) & of(right)
        case nodes.Binary(op, left, right):
            return int(arithmetic.binary("i64", op, of(left), of(right)))
        case nodes.Compare(op, left, right):
            return int(arithmetic.compare(op, of(left), of(right)))
        case _:
            raise AssertionError(expr)


def accepts(checks: nodes.Block, message: bytes) -> bool:
    """Whether a message passes all checks."""
    known = {END.name: len(message)}
    for stmt in checks:
        match stmt:
            case nodes.Let(name, expr):
                known[name] = value(expr, message, known)
            case nodes.Require(at, size):
                begin, count = value(at, message, known), value(size, message, known)
                if not 0 <= begin <= len(message) or not 0 <= count <= len(message) - begin:
                    return False
            case nodes.Expect(condition):
                if not value(condition, message, known):
                    return False
            case _:
                raise AssertionError(stmt)
    return True


def word(random: Random, type_: nodes.Scalar, size: int) -> nodes.Expr:
    """A number of a message, perhaps without some of its bits, or wider."""
    expr: nodes.Expr = nodes.Load(type_, index(random.randrange(size - nodes.WIDTH[type_] + 1)), random.choice("<>"))
    if random.random() < 0.5:
        expr = nodes.Convert("i64", expr)
    if random.random() < 0.4:
        mask = random.choice((1, 3, 12, 255)) if nodes.WIDTH[type_] < 8 else 3
        expr = nodes.Binary("and", expr, nodes.Const("i64" if isinstance(expr, nodes.Convert) else type_, mask))
    return expr


def check(random: Random, name: str, size: int) -> list[nodes.Stmt]:
    """A check of a number, which may be a local."""
    type_ = random.choice(("u8", "u8", "i8", "u16", "u32", "i32", "u64"))
    expr = word(random, type_, size)
    kind = type_of(expr)
    op = random.choice(("eq", "eq", "le", "ge", "lt", "ne"))
    limit = nodes.Const(kind, random.choice((0, 0, 1, 2, 3, 7, 100)))
    if random.random() < 0.5:
        local = nodes.Local(kind, name)
        return [nodes.Let(name, expr), nodes.Expect(nodes.Compare(op, local, limit), WRONG)]
    condition: nodes.Expr = nodes.Compare(op, expr, limit)
    return [nodes.Expect(nodes.Binary("and", nodes.Compare("ge", expr, nodes.Const(kind, 0)), condition), WRONG)]


@pytest.mark.parametrize("seed", range(150))
def test_checks_of_bits_accept_what_they_accepted(seed):
    """Loads must be of what is there; messages have few ones, so that many pass."""
    random = Random(f"bits {seed}")
    size = random.randrange(8, 14)
    checks = [nodes.Require(index(0), index(size), WRONG)]
    for number in range(random.randrange(1, 5)):
        checks += check(random, f"number_{number}", size)
    padding = nodes.Binary("and", nodes.Convert("i64", nodes.Load("u8", index(3))), index(3))
    checks += [nodes.Let("padding", padding), nodes.Require(index(size), PADDING, WRONG)]
    checks += [nodes.Let("at", add(index(size), PADDING)), nodes.Expect(nodes.Compare("ge", AT, END), WRONG)]
    for is_sized in (True, False):
        found = fewer(tuple(checks), is_sized=is_sized)
        for _ in range(60):
            length = size if random.random() < 0.7 else random.randrange(size + 5)
            message = bytes(random.choice((0, 0, 0, 1, 1, 2, 3, 7, 100, 255)) for _ in range(length))
            if is_sized:
                message = message[:size]
            wanted = accepts(tuple(checks), message)
            assert accepts(found, message) == (wanted and (not is_sized or len(message) == size))


def test_a_header_is_looked_at_once():
    """As that of CDR: two bytes, and two bits of the fourth, which say that nothing follows."""
    padding = nodes.Binary("and", nodes.Convert("i64", nodes.Load("u8", index(3))), index(3))
    checks = (
        nodes.Require(index(0), index(2), WRONG),
        nodes.Expect(nodes.Compare("eq", nodes.Load("u16", index(0)), nodes.Const("u16", 256)), WRONG),
        nodes.Require(index(2), index(10), WRONG),
        nodes.Let("padding", padding),
        nodes.Require(index(12), PADDING, WRONG),
        nodes.Let("at", add(index(12), PADDING)),
        nodes.Expect(nodes.Compare("ge", AT, END), WRONG),
    )
    size, header, *rest = fewer(checks, is_sized=True)
    seen = nodes.Binary("and", nodes.Load("u32", index(0)), nodes.Const("u32", 0x0300FFFF))
    assert size == nodes.Expect(nodes.Compare("eq", END, index(12)), WRONG)
    assert isinstance(header, nodes.Expect)
    assert header.condition == nodes.Compare("eq", seen, nodes.Const("u32", 256))
    assert not any(isinstance(each, nodes.Expect | nodes.Require) for each in rest)


def test_the_last_bytes_are_as_many_as_are_left():
    """A text whose length says where the message ends needs one comparison."""
    count = nodes.Let("count", nodes.Convert("i64", nodes.Load("u32", index(0))))
    require = nodes.Require(index(4), COUNT, WRONG)
    behind = (nodes.Let("at", add(COUNT, 4)), nodes.Expect(nodes.Compare("eq", AT, END), WRONG))
    found = fewer((nodes.Require(index(0), index(4), WRONG), count, require, *behind), is_sized=False)
    assert [each for each in found if isinstance(each, nodes.Require)] == [nodes.Require(index(0), index(4), WRONG)]
    assert nodes.Expect(nodes.Compare("eq", COUNT, add(END, -4)), WRONG) in found
    for message, wanted in ((b"\2\0\0\0ab", True), (b"\2\0\0\0a", False), (b"\2\0\0\0abc", False), (b"\0\0\0", False)):
        assert accepts(found, message) == wanted
