"""What makes generated Python quick: numbers that lie together are read and written by one call, and no check asks what is known."""

from __future__ import annotations

from collections.abc import Iterator

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.rewrite import locals_in
from rosetta_jit.kernel.terms import END, index, type_of
from rosetta_jit.kernel.walk import bound_names, statements


def grouped(block: nodes.Block) -> Iterator[list[nodes.Stmt]]:
    """The statements of a block: those that read, or write, scalars one behind the other in the message together."""
    group: list[nodes.Stmt] = []
    for stmt in block:
        if group and not continues(group, stmt):
            yield group
            group = []
        group.append(stmt)
    if group:
        yield group


def scalar_of(stmt: nodes.Stmt) -> tuple[str, nodes.Expr, str] | None:
    """Type, place and byte order of the one scalar that a statement takes from the message, or puts there."""
    match stmt:
        case nodes.Let(_, value) | nodes.SetField(_, value):
            load = _as_loaded(value)
            return (load.type, load.at, load.order) if load is not None and load.type != "bool" else None
        case nodes.Store(at, value, order):
            return (type_of(value), at, order) if type_of(value) != "bool" else None
        case _:
            return None


def _as_loaded(value: nodes.Expr) -> nodes.Load | None:
    """The scalar of the message that a value is; an integer of more bits is the same one."""
    match value:
        case nodes.Load():
            return value
        case nodes.Convert(type_, nodes.Load(inner) as load) if (
            inner[0] in "iu" and type_[0] in ("i", inner[0]) and nodes.WIDTH[type_] > nodes.WIDTH[inner]
        ):
            return load
        case _:
            return None


def continues(group: list[nodes.Stmt], stmt: nodes.Stmt) -> bool:
    """Whether a statement has to do with the number behind those that some others have to do with."""
    before = group[-1]
    one, other = scalar_of(before), scalar_of(stmt)
    if one is None or other is None or isinstance(before, nodes.Store) != isinstance(stmt, nodes.Store):
        return False
    orders = {order for type_, _, order in (*filter(None, map(scalar_of, group)), other) if nodes.WIDTH[type_] > 1}
    (base, offset), (base_2, offset_2) = based(one[1]), based(other[1])
    follows = base == base_2 and offset_2 == offset + nodes.WIDTH[one[0]]
    return len(orders) < 2 and follows and not any(isinstance(each, nodes.Let) and _reads(stmt, each.name) for each in group)


def based(at: nodes.Expr) -> tuple[nodes.Expr | None, int]:
    """A place as something and a constant."""
    match at:
        case nodes.Const(_, value):
            return None, int(value)
        case nodes.Binary("add", left, nodes.Const(_, value)):
            base, offset = based(left)
            return base, offset + int(value)
        case _:
            return at, 0


def _reads(stmt: nodes.Stmt, name: str) -> bool:
    found = scalar_of(stmt)
    base = based(found[1])[0] if found is not None else None
    return isinstance(base, nodes.Local) and base.name == name


def not_negative(block: nodes.Block, others: frozenset[str] = frozenset()) -> frozenset[str]:
    """The integers of a body that are never negative, whatever the message, as ``others`` are not: Python's have no end."""
    values: dict[str, list[nodes.Expr]] = {}
    unknown: set[str] = set()
    for stmt, _ in statements(block):
        match stmt:
            case nodes.Let(name, value) | nodes.Var(name, value) | nodes.Assign(name, value):
                values.setdefault(name, []).append(value)
            case nodes.For(variable, _, _):
                values.setdefault(variable, [])
            case nodes.Call() | nodes.HostCall():
                unknown.update(bound_names(stmt))
            case _:
                pass
    for name in _checked(block):
        values[name] = []
    known = {name for name in values if name not in unknown} | {END.name} | others
    while True:
        kept = {name for name in known if all(is_not_negative(value, known) for value in values.get(name, ()))}
        if kept == known:
            return frozenset(known)
        known = kept


def _checked(block: nodes.Block) -> Iterator[str]:
    """Names of constants of which a statement says, behind other constants at most, that they are 0 or more."""
    before = set[str]()
    for stmt, _ in statements(block):
        match stmt:
            case nodes.Let(name, _):
                before.add(name)
            case nodes.Expect(nodes.Compare("ge" | "gt", nodes.Local(_, name), nodes.Const(_, least)), _) if name in before and least >= 0:
                yield name
                before.clear()
            case _:
                before.clear()


def is_not_negative(expr: nodes.Expr, known: frozenset[str] | set[str]) -> bool:
    """Whether an integer is 0 or more, if those of the names are."""
    match expr:
        case nodes.Const(_, value):
            return value >= 0
        case nodes.Local(_, name):
            return name in known
        case nodes.Load(type_, _, _):
            return type_[0] == "u"
        case nodes.Binary("add" | "mul", left, right):
            return is_not_negative(left, known) and is_not_negative(right, known)
        case nodes.Convert(type_, operand):
            inner = type_of(operand)
            return type_[0] in "iu" and inner[0] in "iu" and nodes.WIDTH[type_] >= nodes.WIDTH[inner] and is_not_negative(operand, known)
        case _:
            return False


ALWAYS = 1 << 20
"""Rows that any message may have."""


def bounded(check: nodes.Require | nodes.Expect) -> frozenset[nodes.Expr]:
    """The numbers of rows that a message may have which passes a check: these take a byte each at least, or are few."""
    match check:
        case nodes.Require(_, nodes.Binary("mul", count, nodes.Const(_, value)) as size) if value >= 1:
            return frozenset((size, count))
        case nodes.Require(_, size):
            return frozenset((size,))
        case nodes.Expect(nodes.Compare("le", count, nodes.Const(_, most))) if most <= ALWAYS:
            return frozenset((count,))
        case _:
            return frozenset()


def without_sign(condition: nodes.Expr, known: frozenset[str]) -> nodes.Expr:
    """A condition that does not ask whether an integer is 0 or more which cannot be another one, as those of the names cannot."""
    match condition:
        case nodes.Binary("and", nodes.Compare("ge", value, nodes.Const(_, 0)), nodes.Compare("le", same, _) as most):
            return most if value == same and is_not_negative(value, known) else condition
        case _:
            return condition


def turned(loop: nodes.For) -> tuple[nodes.Place, nodes.Expr, str] | None:
    """The array that a loop copies between a lane and the message, byte by byte turned around: its first row, its place, its type."""
    names = {each.name: each.value for each in loop.body if isinstance(each, nodes.Let)}
    *lets, last = loop.body or (None,)
    if not all(isinstance(each, nodes.Let) for each in lets):
        return None
    match last:
        case nodes.SetField(place, nodes.Load(type_, at, ">")) | nodes.Store(at, nodes.Get(type_, place), ">") if nodes.WIDTH[type_] > 1:
            row, base = without(place.row, loop.variable, 1), without(_resolved(at, names), loop.variable, nodes.WIDTH[type_])
            used = set(names) & (locals_in(row) | locals_in(base)) if row is not None and base is not None else {""}
            if row is None or base is None or used or place.offset or len(names) > 1:
                return None
            return nodes.Place(place.lane, row), base, type_
        case _:
            return None


def _resolved(expr: nodes.Expr, names: dict[str, nodes.Expr]) -> nodes.Expr:
    return names.get(expr.name, expr) if isinstance(expr, nodes.Local) else expr


def without(expr: nodes.Expr, variable: str, times: int) -> nodes.Expr | None:
    """An expression that is ``variable * times`` more than another: that other one."""
    match expr:
        case nodes.Local(_, name) if name == variable and times == 1:
            return index(0)
        case nodes.Binary("mul", nodes.Local(_, name), nodes.Const(_, factor)) if name == variable and factor == times:
            return index(0)
        case nodes.Binary("add", left, right):
            for one, other in ((left, right), (right, left)):
                found = without(one, variable, times)
                if found is not None and variable not in locals_in(other):
                    return other if found == index(0) else nodes.Binary("add", other, found)
            return None
        case _:
            return None


def zigzag_of(convert: nodes.Convert) -> nodes.Expr | None:
    """The integer, of 64 bits and no sign, whose lowest bit is the sign of a number with the others: if it is 1 all others are inverted."""
    match convert:
        case nodes.Convert(type_, nodes.Binary("xor", nodes.Binary("shr", value, nodes.Const("u64", 1)), nodes.Select() as sign)):
            lowest = nodes.Binary("and", value, nodes.Const("u64", 1))
            inverted = nodes.Select(
                nodes.Compare("ne", lowest, nodes.Const("u64", 0)), nodes.Const("u64", 2**64 - 1), nodes.Const("u64", 0)
            )
            fits = isinstance(value, nodes.Binary) and value.op == "and" and value.right == nodes.Const("u64", 2**32 - 1)
            return value if sign == inverted and (type_ == "i64" or (type_ == "i32" and fits)) else None
        case _:
            return None
