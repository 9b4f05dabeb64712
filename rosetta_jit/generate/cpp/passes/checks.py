"""Fewer checks for a decoder that gives up where any of them fails: they have no order, and say nothing of what is wrong.

A message is found to be long enough once. Checks of unsigned numbers at places that are known become checks of bits, and one comparison
looks at those of up to eight bytes: that a number is a constant, that it is less than a power of two, or that some of its bits are 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from rosetta_jit.generate.cpp.passes.empty_lists import with_values
from rosetta_jit.generate.passes.positions import NONE, after_binding, after_require, difference, is_position
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS
from rosetta_jit.kernel.nodes import Block, Expr, Scalar, Stmt
from rosetta_jit.kernel.passes.fold import TRUE, folded
from rosetta_jit.kernel.rewrite import reads_memory, substituted, with_expressions
from rosetta_jit.kernel.terms import END, add, index
from rosetta_jit.startup.dataclass import replace

Number = tuple[tuple[int, int], ...]
"""An unsigned number of the message: where each of its bytes lies, the lowest first, and which bits of that it has."""
Bits = Mapping[int, tuple[int, int]]
"""For bytes of the message, by where they lie, which of their bits are known, and what they are."""
IMPLIED = nodes.Failure(-1, index(0))
"""What stands for a check that others have made: it says of places what is known."""
WORDS: dict[int, Scalar] = {1: "u8", 2: "u16", 4: "u32", 8: "u64"}


def fewer(checks: Block, *, is_sized: bool) -> Block:
    """The checks that are left; with ``is_sized`` those of messages that have no arrays and texts, and so may be of one size.

    A compiler that knows the size leaves out most checks.
    """
    ends = [each.at for each in checks if isinstance(each, nodes.Require)]
    sure, (first, *_) = _sure(checks), checks
    assert isinstance(first, nodes.Require)
    if is_sized and all(isinstance(at, nodes.Const) for at in ends):
        known: Stmt = nodes.Expect(nodes.Compare("eq", END, index(sure)), first.failure)
        rest = tuple(_where_it_ends(checks, index(sure)))
    else:
        known = nodes.Require(index(0), index(sure), first.failure)
        rest = _to_the_end(_as_one(each for each in checks if not _is_sure(each)), sure)
    return (known, *texts_last(_joined(rest, sure)))


def texts_last(checks: Iterable[Stmt]) -> Block:
    """Checks of texts, which take longest, behind the others."""
    return tuple(sorted(checks, key=_is_of_text))


def _is_of_text(stmt: Stmt) -> bool:
    return isinstance(stmt, nodes.Expect) and isinstance(stmt.condition, nodes.IsText)


def _is_sure(stmt: Stmt) -> bool:
    return isinstance(stmt, nodes.Require) and isinstance(stmt.at, nodes.Const) and isinstance(stmt.size, nodes.Const)


def _sure(checks: Block) -> int:
    """How many bytes a message has at places that are known."""
    ends = ((each.at, each.size) for each in checks if isinstance(each, nodes.Require))
    return max(int(at.value + size.value) for at, size in ends if isinstance(at, nodes.Const) and isinstance(size, nodes.Const))


def _where_it_ends(checks: Block, size: nodes.Const) -> Iterator[Stmt]:
    """Checks with the size in place of the end."""
    for stmt in checks:
        match stmt:
            case nodes.Require(_, nodes.Const(), _):
                pass
            case nodes.Require(nodes.Const(_, at), more, failure):
                yield nodes.Expect(nodes.Compare("le", more, index(int(size.value - at))), failure)
            case nodes.Expect(condition, failure):
                yield nodes.Expect(folded(substituted(condition, {END.name: size})), failure)
            case _:
                yield with_expressions(stmt, lambda each: substituted(each, {END.name: size}))


def _as_one(checks: Iterable[Stmt]) -> Block:
    """Checks in which bytes that must be there, and so many more behind them, are found to be there in one comparison.

    Of both it is known then that they hold, and that their places lie in the message.
    """
    values, found, last = dict[str, Expr](), list[Stmt](), 0
    for stmt in checks:
        match stmt:
            case nodes.Require(at, nodes.Const() as more, failure) if isinstance(before := found[last] if found else None, nodes.Require):
                end = substituted(add(before.at, before.size), values)
                if difference(substituted(at, values), end) == index(0):
                    found[last : last + 1] = nodes.Require(before.at, add(before.size, more), failure), replace(before, failure=IMPLIED)
                    found.append(replace(stmt, failure=IMPLIED))
                    continue
            case nodes.Let(name, value) if not reads_memory(value):
                values[name] = substituted(value, values)
            case _:
                pass
        last = len(found) if isinstance(stmt, nodes.Require) else last
        found.append(stmt)
    return tuple(found)


def _to_the_end(checks: Block, sure: int) -> Block:
    """Checks in which bytes that must be there, and be the last ones, are found to be as many as are left, in one comparison."""
    values = {each.name: each.value for each in checks if isinstance(each, nodes.Let)}
    ends = {
        number: values[each.condition.left.name]
        for number, each in enumerate(checks)
        if isinstance(each, nodes.Expect)
        and isinstance(each.condition, nodes.Compare)
        and each.condition.op in ("eq", "ge")
        and isinstance(each.condition.left, nodes.Local)
        and each.condition.left.name in values
        and each.condition.right == END
    }
    known = after_require(NONE, index(0), index(sure))
    for number, stmt in enumerate(checks):
        match stmt:
            case nodes.Require(at, size, failure):
                for last, end in ends.items() if failure != IMPLIED else ():
                    if is_position(known, at) and difference(end, add(at, size)) == index(0):
                        left = nodes.Expect(nodes.Compare("eq", size, nodes.Binary("sub", END, at)), failure)
                        return (*checks[:number], left, *checks[number + 1 : last], *checks[last + 1 :])
                known = after_require(known, at, size)
            case nodes.Let(name, value):
                known = after_binding(known, name, value)
            case _:
                pass
    return checks


def _joined(checks: Block, size: int) -> Block:
    """Checks whose bits of the first ``size`` bytes, which are there, are looked at first."""
    numbers, known, bits, rest = dict[str, Number](), dict[str, Expr](), dict[int, tuple[int, int]](), list[Stmt]()
    for each in checks:
        stmt = with_values(each, known)
        match stmt:
            case nodes.Expect(condition, _) if condition == TRUE:
                continue
            case nodes.Expect(condition, _):
                found = _both(bits, _bits(condition, numbers))
                if found is not None and all(at < size for at in found):
                    bits = dict(found)
                    known |= _said(condition)
                    continue
            case nodes.Let(name, nodes.Const() as value):
                known[name] = value
            case nodes.Let(name, value) if (number := _number(value, numbers)) is not None:
                numbers[name] = number
            case _:
                pass
        rest.append(stmt)
    return (*_words(bits, size), *rest)


def _said(condition: Expr) -> dict[str, Expr]:
    """A local that is a constant where a condition of bits holds."""
    match condition:
        case nodes.Compare("eq", nodes.Local(_, name), nodes.Const() as value):
            return {name: value}
        case nodes.Compare("le", nodes.Local(type_, name), nodes.Const(_, 0)):
            return {name: nodes.Const(type_, 0)}
        case _:
            return {}


def _number(expr: Expr, numbers: Mapping[str, Number]) -> Number | None:
    """An expression as bits of the message, if it is nothing else."""
    match expr:
        case nodes.Load(type_, nodes.Const(_, at), order) if type_ in WORDS.values():
            width = nodes.WIDTH[type_]
            places = range(int(at), int(at) + width)
            return tuple((place, 255) for place in (places if order == "<" else reversed(places)))
        case nodes.Local(_, name):
            return numbers.get(name)
        case nodes.Convert(type_, operand) if type_ not in FLOATS:
            number = _number(operand, numbers)
            is_kept = number is not None and (nodes.WIDTH[type_] > len(number) or type_ == WORDS.get(len(number)))
            return number if is_kept else None
        case nodes.Binary("and", operand, nodes.Const(_, mask)):
            number = _number(operand, numbers)
            return None if number is None or mask < 0 else tuple((at, has & _byte(mask, place)) for place, (at, has) in enumerate(number))
        case _:
            return None


def _byte(number: float, place: int) -> int:
    return int(number) >> 8 * place & 255


def _bits(condition: Expr, numbers: Mapping[str, Number]) -> Bits | None:
    """A condition as what it says of bits, if it says nothing else."""
    match condition:
        case nodes.Binary("and", left, right):
            one = _bits(left, numbers)
            return None if one is None else _both(one, _bits(right, numbers))
        case nodes.Compare("eq" | "le" | "ge" as op, left, nodes.Const(_, value)) if (number := _number(left, numbers)) is not None:
            return _compared(op, number, int(value))
        case _:
            return None


def _compared(op: str, number: Number, value: int) -> Bits | None:
    """What a comparison with a constant says of bits."""
    is_less = op == "le" and value >= 0 and value & value + 1 == 0
    is_equal = op == "eq" and value >= 0 and value < 1 << 8 * len(number)
    if op == "ge" and value <= 0:
        return {}
    if is_less:
        return {at: (has & ~_byte(value, place), 0) for place, (at, has) in enumerate(number)}
    bits = {at: (has, _byte(value, place)) for place, (at, has) in enumerate(number)}
    return bits if is_equal and not any(one & ~has for has, one in bits.values()) else None


def _both(bits: Bits, more: Bits | None) -> Bits | None:
    """What is known of bits from two checks; None if the second is none of bits, or both never hold."""
    if more is None:
        return None
    found = dict(bits)
    for at, (has, value) in more.items():
        had, before = found.get(at, (0, 0))
        if (before ^ value) & had & has:
            return None
        found[at] = had | has, before | value
    return found


def _words(bits: Bits, size: int) -> Iterator[Stmt]:
    """Comparisons for bits of the first ``size`` bytes: each looks at as many of the bytes as one can."""
    left = sorted(at for at, (has, _) in bits.items() if has)
    while left:
        starts = {width: min(left[0], size - width) for width in WORDS if width <= size}
        looked_at = {width: sum(at < start + width for at in left) for width, start in starts.items()}
        width = max(starts, key=lambda each: (looked_at[each], -each))
        start, type_ = starts[width], WORDS[width]
        each = [bits.get(at, (0, 0)) if at >= left[0] else (0, 0) for at in range(start, start + width)]
        has, value = (int.from_bytes(bytes(some), "little") for some in zip(*each, strict=True))
        yield nodes.Expect(_word(nodes.Load(type_, index(start), "<"), has, value), nodes.Failure(0, index(0)))
        left = left[looked_at[width] :]


def _word(word: nodes.Load, has: int, value: int) -> Expr:
    """Whether a word has bits as they are known; of a number that is less than a power of two compilers know more than of its bits."""
    others = ((1 << 8 * nodes.WIDTH[word.type]) - 1) ^ has
    if value == 0 and others & others + 1 == 0:
        return nodes.Compare("le", word, nodes.Const(word.type, others))
    seen = nodes.Binary("and", word, nodes.Const(word.type, has)) if others else word
    return nodes.Compare("eq", seen, nodes.Const(word.type, value))
