"""Expressions of a kernel, evaluated over what is known: each value is a linear sum, a formula, or unknown.

Evaluating an expression proves the obligations that lie in it (bounds of loads, no wrapping, no division by zero, types), so that
whoever has a value has the proof too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS, LARGEST_SCALE, MOST_DIGITS, limits
from rosetta_jit.kernel.limits import MAX_PLACES
from rosetta_jit.kernel.proof import claims
from rosetta_jit.kernel.proof.formula import All, Any, Formula, bounded, equal, negated
from rosetta_jit.kernel.proof.linear import Linear, minus, plus, shifted, sum_of, times
from rosetta_jit.kernel.proof.obligations import UnprovenError, certify, demand, oblige
from rosetta_jit.kernel.proof.prove import Facts
from rosetta_jit.kernel.proof.scope import Scope, Typed, Value
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.kernel.proof import integers
else:
    integers = Late("rosetta_jit.kernel.proof.integers")

ROUNDING = frozenset(("sqrt", "floor", "ceil", "trunc", "rint"))
"""Functions that a float32 has too."""

# --- what is evaluated must be -----------------------------------------------------------------------------------------


def integer(scope: Scope, expr: nodes.Expr, type_: nodes.Scalar = "i64") -> Linear:
    """Value of an expression that must be an integer of a type."""
    found, value = evaluate(scope, expr)
    if found != type_:
        raise UnprovenError(f"{found} where {type_} belongs")
    return linear(value)


def linear(value: Value) -> Linear:
    """A value that is an integer by its type."""
    if not isinstance(value, Linear):
        raise UnprovenError("no integer")
    return value


def condition(scope: Scope, expr: nodes.Expr) -> Formula:
    """Value of an expression that must be a bool."""
    found, value = evaluate(scope, expr)
    if found != "bool":
        raise UnprovenError(f"{found} where bool belongs")
    return value


def check_extent(scope: Scope, address: nodes.Address, size: Linear) -> Linear:
    """``size >= 0`` bytes from an address lie in the message, or in a lane; returns the first byte's offset there."""
    oblige(scope, size, claims.SIZE)
    match address:
        case nodes.Wire(at):
            start = integer(scope, at)
            check_wire(scope, start, size)
            return start
        case nodes.Place():
            row = _row(scope, address)
            stride = scope.strides[address.lane]
            start = shifted(times(row, stride), address.offset)
            oblige(scope, minus(minus(times(scope.capacity[address.lane], stride), start), size), claims.WITHIN_LANE)
            return start
        case _:
            assert_never(address)


def check_wire(scope: Scope, start: Linear, size: Linear) -> None:
    """``size`` bytes from ``start`` lie in the message."""
    oblige(scope, minus(minus(scope.end, start), size), claims.BEFORE_END)
    oblige(scope, minus(start, scope.begin), claims.AFTER_BEGIN)


def check_field(scope: Scope, place: nodes.Place, type_: nodes.Scalar) -> None:
    """A scalar lies in a row of a lane, aligned."""
    row = _row(scope, place)
    width, stride = nodes.WIDTH[type_], scope.strides[place.lane]
    certify(scope, place.offset + width <= stride, claims.WITHIN_ROW)
    certify(scope, place.offset % width == 0 and stride % width == 0, claims.ALIGNED)
    oblige(scope, shifted(minus(scope.capacity[place.lane], row), -1), claims.BELOW_CAPACITY)


def _row(scope: Scope, place: nodes.Place) -> Linear:
    check_lane(scope, place.lane)
    certify(scope, place.offset >= 0, claims.OFFSET)
    row = integer(scope, place.row)
    oblige(scope, row, claims.ROW_NUMBER)
    return row


def check_lane(scope: Scope, lane: int) -> None:
    """The lane exists."""
    certify(scope, 0 <= lane < len(scope.strides), claims.LANE)


def in_range(scope: Scope, value: Linear, type_: nodes.Scalar) -> Linear:
    """``value``, proven to be in its type's range: the operation that made it did not wrap."""
    (low, high), wraps = limits(type_), claims.NO_WRAP[type_]
    if scope.record is None and scope.facts.lies_within(value, low, high):
        return value
    oblige(scope, shifted(times(value, -1), high), wraps)
    oblige(scope, shifted(value, -low), wraps)
    return value


def unknown(scope: Scope, type_: nodes.Scalar) -> Value:
    """Any value of a type."""
    return None if type_ == "bool" or type_ in FLOATS else scope.facts.fresh(*limits(type_))


# --- expressions -------------------------------------------------------------------------------------------------------


def evaluate(scope: Scope, expr: nodes.Expr) -> Typed:
    """Type and value of an expression; raises UnprovenError where an obligation in it cannot be shown.

    The patterns of frequent kinds bind no attributes, which would take twice as long.
    """
    match expr:
        case nodes.Local():
            found = scope.locals.get(expr.name)
            if found is None or found[0] != expr.type:
                raise UnprovenError(f"{expr.name} is not visible here" if found is None else f"{expr.name} is no {expr.type}")
            return found
        case nodes.Const():
            return expr.type, _constant(expr.type, expr.value)
        case nodes.Binary():
            return _binary(scope, expr.op, evaluate(scope, expr.left), evaluate(scope, expr.right))
        case nodes.Compare():
            return "bool", _compare(expr.op, evaluate(scope, expr.left), evaluate(scope, expr.right))
        case nodes.Get():
            check_field(scope, expr.place, expr.type)
            return expr.type, unknown(scope, expr.type)
        case nodes.Load():
            check_wire(scope, integer(scope, expr.at), Linear(nodes.WIDTH[expr.type]))
            return expr.type, unknown(scope, expr.type)
        case nodes.Convert() | nodes.Bits():
            return _converted(scope, expr)
        case nodes.Used(lane) | nodes.Capacity(lane):
            check_lane(scope, lane)
            return "i64", (scope.used if isinstance(expr, nodes.Used) else scope.capacity)[lane]
        case nodes.HostValue(what) | nodes.Register(what):
            kind = "host" if isinstance(expr, nodes.HostValue) else "register"
            return "i64", scope.facts.named((kind, what), *limits("i64"))
        case nodes.Unary():
            return _unary(scope, expr)
        case nodes.Fits():
            return "bool", _fits(scope, expr)
        case nodes.Select():
            return _select(scope, expr)
        case nodes.IsText(address, size):
            check_extent(scope, address, integer(scope, size))
            return "bool", None
        case nodes.Nearest() | nodes.Digits() | nodes.Scale() | nodes.Lookup():
            return _looked_up(scope, expr) if isinstance(expr, nodes.Lookup) else _decimal(scope, expr)
        case _:
            assert_never(expr)


def _fits(scope: Scope, expr: nodes.Fits) -> Formula:
    low, high = limits("i64")
    result = _integer_binary(scope, expr.op, "i64", integer(scope, expr.left), integer(scope, expr.right))
    return All((shifted(result, -low), shifted(times(result, -1), high)))


def _looked_up(scope: Scope, expr: nodes.Lookup) -> Typed:
    demand(bool(expr.values), "a value among none")
    low, high = limits(expr.type)
    demand(expr.type != "bool" and all(low <= value <= high for value in expr.values), f"a value that is no {expr.type}")
    number = integer(scope, expr.index)
    oblige(scope, number, claims.WITHIN_TABLE)
    oblige(scope, shifted(times(number, -1), len(expr.values) - 1), claims.WITHIN_TABLE)
    return expr.type, scope.facts.fresh(min(expr.values), max(expr.values))


def _decimal(scope: Scope, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> Typed:
    match expr:
        case nodes.Nearest(address, size, exponent):
            check_extent(scope, address, integer(scope, size))
            integer(scope, exponent)
            return "f64", None
        case nodes.Digits(value, places):
            demand(evaluate(scope, value)[0] in FLOATS, "digits of an integer")
            demand(places is None or 0 <= places <= MAX_PLACES, "too many decimals")
            return "u64", scope.facts.fresh(0, MOST_DIGITS if places is None else limits("u64")[1])
        case nodes.Scale(value):
            demand(evaluate(scope, value)[0] in FLOATS, "the scale of an integer")
            return "i64", scope.facts.fresh(-LARGEST_SCALE, LARGEST_SCALE)
        case _:
            assert_never(expr)


def _constant(type_: nodes.Scalar, value: float) -> Value:
    if type_ in FLOATS:
        return None
    if type_ == "bool":
        return bool(value)
    low, high = limits(type_)
    if not isinstance(value, int) or not low <= value <= high:
        raise UnprovenError(f"{value} is no {type_}")
    return sum_of((int(value), ()))


def _binary(scope: Scope, op: nodes.Arithmetic, left: Typed, right: Typed) -> Typed:
    type_ = left[0]
    if type_ != right[0]:
        raise UnprovenError(f"{op} of {type_} and {right[0]}")
    if type_ in FLOATS:
        demand(op in {"add", "sub", "mul", "div", "rem", "min", "max", "atan2"}, f"{op} of floats")
        demand(op != "atan2" or type_ == "f64", f"{op} of {type_}")
        return type_, None
    if type_ == "bool":
        return type_, _logical(op, left[1], right[1])
    return type_, _checked_binary(scope, op, type_, linear(left[1]), linear(right[1]))


def _logical(op: nodes.Arithmetic, left: Formula, right: Formula) -> Formula:
    match op:
        case "and":
            return bounded(All((left, right)))
        case "or":
            return bounded(Any((left, right)))
        case "xor":
            return None
        case _:
            raise UnprovenError(f"{op} of bools")


def _checked_binary(scope: Scope, op: nodes.Arithmetic, type_: nodes.Scalar, left: Linear, right: Linear) -> Linear:
    """``left op right``, with its obligations."""
    match op:
        case "wrapping_add":
            demand(limits(type_)[0] == 0, f"{op} of {type_}")
        case "add" | "sub":
            return in_range(scope, _integer_binary(scope, op, type_, left, right), type_)
        case "mul":
            return in_range(scope, _product(scope.facts, type_, left, right), type_)
        case "div" | "rem":
            oblige(scope, negated(equal(right, Linear(0))), claims.DIVISOR)
            low = limits(type_)[0]
            overflows = All((equal(left, Linear(low)), equal(right, Linear(-1))))
            oblige(scope, low == 0 or negated(overflows), claims.QUOTIENT)
        case "shl" | "shr":
            oblige(scope, All((right, shifted(times(right, -1), 8 * nodes.WIDTH[type_] - 1))), claims.SHIFT)
        case _:
            pass
    return _integer_binary(scope, op, type_, left, right)


def _product(facts: Facts, type_: nodes.Scalar, left: Linear, right: Linear) -> Linear:
    """``left * right``, of which more is learnt where it might not fit its type for all that is known."""
    found = integers.product(facts, left, right)
    low, high = limits(type_)
    if max(len(left.terms), len(right.terms)) > 1 and not facts.proves_thoroughly(
        All((shifted(found, -low), shifted(times(found, -1), high)))
    ):
        integers.look_at_whole_sums(facts, left, right)
    return found


def _integer_binary(scope: Scope, op: nodes.Arithmetic, type_: nodes.Scalar, left: Linear, right: Linear) -> Linear:
    """The mathematical result of ``left op right``."""
    facts = scope.facts
    match op:
        case "add":
            return plus(left, right)
        case "wrapping_add":
            return _low_bits(scope, plus(left, right), type_)
        case "sub":
            return minus(left, right)
        case "mul":
            return integers.product(facts, left, right)
        case "div":
            return integers.quotient(facts, left, right)
        case "rem":
            return integers.remainder(facts, left, right)
        case "and":
            return integers.bits_and(facts, left, right, limits(type_))
        case "or" | "xor":
            return integers.bits_or(facts, left, right, limits(type_), exclusive=op == "xor")
        case "shl":
            return integers.shift_left(facts, left, right, limits(type_))
        case "shr":
            return integers.shift_right(facts, left, right, limits(type_))
        case "atan2":
            raise UnprovenError("atan2 of integers")
        case "min" | "max":
            return _extreme(facts, left, right, 1 if op == "max" else -1)
        case _:
            assert_never(op)


def _extreme(facts: Facts, left: Linear, right: Linear, sign: int) -> Linear:
    """The greater of two, or with ``sign`` -1 the lesser."""
    above = times(minus(left, right), sign)
    result = facts.chosen(((above, left), (negated(above), right)))
    facts.derive(All((times(minus(result, left), sign), times(minus(result, right), sign))))
    return result


def _unary(scope: Scope, expr: nodes.Unary) -> Typed:
    type_, value = evaluate(scope, expr.operand)
    match expr.function:
        case "not" if type_ == "bool":
            return type_, negated(value)
        case "neg" | "abs" if type_ in FLOATS:
            return type_, None
        case "not":
            flipped = shifted(times(linear(value), -1), -1)
            return type_, flipped if limits(type_)[0] < 0 else shifted(flipped, limits(type_)[1] + 1)
        case "neg":
            return type_, in_range(scope, times(linear(value), -1), type_)
        case "abs":
            number = linear(value)
            opposite = times(number, -1)
            return type_, in_range(scope, scope.facts.chosen(((number, number), (negated(number), opposite))), type_)
        case _:
            demand(type_ == "f64" or (type_ == "f32" and expr.function in ROUNDING), f"{expr.function} of {type_}")
            return type_, None


def _compare(op: nodes.Comparison, left: Typed, right: Typed) -> Formula:
    if left[0] != right[0]:
        raise UnprovenError(f"{op} of {left[0]} and {right[0]}")
    if left[0] == "bool" or left[0] in FLOATS:
        return None
    a, b = linear(left[1]), linear(right[1])
    match op:
        case "le":
            return minus(b, a)
        case "lt":
            return shifted(minus(b, a), -1)
        case "ge":
            return minus(a, b)
        case "gt":
            return shifted(minus(a, b), -1)
        case "eq":
            return equal(a, b)
        case "ne":
            return negated(equal(a, b))
        case _:
            assert_never(op)


def _convert(scope: Scope, target: nodes.Scalar, source: nodes.Scalar, value: Value) -> Value:
    if target in FLOATS:
        return None
    if source == "bool":
        return value if target == "bool" else scope.facts.fresh(0, 1)
    if source in FLOATS:
        return unknown(scope, target)
    if target == "bool":
        return negated(equal(linear(value), Linear(0)))
    low, high = limits(target)
    is_wider = limits(source)[0] >= low and limits(source)[1] <= high
    return value if is_wider else _low_bits(scope, linear(value), target)


def _low_bits(scope: Scope, value: Linear, type_: nodes.Scalar) -> Linear:
    """The low bits of an integer as one of a type: the integer itself where it fits."""
    low, high = limits(type_)
    fits = All((shifted(value, -low), shifted(times(value, -1), high)))
    return value if scope.facts.proves(fits) else scope.facts.named(("low bits", type_, value), low, high)


def _converted(scope: Scope, expr: nodes.Convert | nodes.Bits) -> Typed:
    source, value = evaluate(scope, expr.operand)
    if isinstance(expr, nodes.Convert):
        return expr.type, _convert(scope, expr.type, source, value)
    same = nodes.WIDTH[source] == nodes.WIDTH[expr.type] and "bool" not in {source, expr.type}
    demand(same, f"a {source} has not the bits of a {expr.type}")
    return expr.type, unknown(scope, expr.type)


def _select(scope: Scope, expr: nodes.Select) -> Typed:
    chosen = condition(scope, expr.condition)
    type_, then = evaluate(scope, expr.then)
    other_type, otherwise = evaluate(scope, expr.otherwise)
    if type_ != other_type:
        raise UnprovenError(f"a choice between {type_} and {other_type}")
    if type_ == "bool" or type_ in FLOATS:
        return type_, None
    return type_, scope.facts.chosen(((chosen, linear(then)), (negated(chosen), linear(otherwise))))
