"""Division: exact, rounded down, and what that leaves."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Expr
from rosetta_jit.language.affine_steps import UNSHOWN, LostError, Value, divided_by, fraction, rounded, scaled
from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.folding import folded
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Affine, Function, Numbers, Row, Whole
from rosetta_jit.language.typed import INT64, Call, Const
from rosetta_jit.lowering.arithmetic import divided, floored
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Float, Type

EXACT = Row(
    "numbers",
    "`divide(x, y)`",
    ("two integers, or floats", "the quotient; of integers without a remainder, else an error of kind `range`"),
)
FLOORED = Row(
    "numbers",
    "`floor_divide(x, y)`, `modulo(x, y)`",
    ("integers", "the quotient rounded down, and what it leaves, with the sign of `y`"),
)
TWO = "two numbers"


def _lower_divide(call: Call, values: Evaluation) -> Expr:
    number, divisor = (values.of(each) for each in call.arguments)
    return divided(values.writer, number, divisor, values.where, values.line)


def _lower_floored(call: Call, values: Evaluation) -> Expr:
    number, divisor = (values.of(each) for each in call.arguments)
    return floored(values.writer, call.function, number, divisor, values.where, values.line)


def _times(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    number, divisor = call.arguments
    return number, model.Binary("*", value, divisor, call.span)


def _divisor(call: Call) -> int | float:
    match call.arguments[1]:
        case Const(value=int() | float() as divisor) if divisor:
            return divisor
        case _:
            raise LostError(UNSHOWN)


def _follow_divide(call: Call, value: Value) -> Value:
    return rounded(scaled(value, 1 / fraction(_divisor(call))), 1)


def _follow_floored(call: Call, value: Value) -> Value:
    return divided_by(value, _divisor(call), call.function, call.type)


def _below(call: model.Call) -> int | None:
    """The divisor, where it is known and above 0."""
    known = folded(call.arguments[1]) if len(call.arguments) == 2 else None
    return known.value if isinstance(known, model.Literal) and type(known.value) is int and known.value > 0 else None


def _joined(call: model.Call, high: model.Expr, low: model.Expr, _type: Type | None) -> model.Expr:
    product = model.Binary("*", high, model.Literal(_below(call) or 0, call.span), call.span)
    return model.Binary("+", product, low, call.span)


def _fold_divide(numbers: list[int]) -> int | None:
    number, divisor = numbers
    return None if not divisor or number % divisor else number // divisor


def _fold_floor_divide(numbers: list[int]) -> int | None:
    return numbers[0] // numbers[1] if numbers[1] else None


def _fold_modulo(numbers: list[int]) -> int | None:
    return numbers[0] % numbers[1] if numbers[1] else None


FUNCTIONS = (
    Function(
        "divide",
        Numbers((INT64, Float(32), FLOAT64), (2, 2), TWO, _fold_divide, divides=True),
        _lower_divide,
        inverse=_times,
        law=Affine(_follow_divide, exact=True, rounds=True),
        rows=(EXACT,),
    ),
    Function(
        "floor_divide",
        Numbers((INT64,), (2, 2), TWO, _fold_floor_divide, divides=True),
        _lower_floored,
        inverse=_times,
        law=Affine(_follow_floored),
        rows=(FLOORED,),
        whole=Whole("modulo", _below, _joined),
    ),
    Function("modulo", Numbers((INT64,), (2, 2), TWO, _fold_modulo, divides=True), _lower_floored, SEVERAL, NOT_FOLLOWED, (FLOORED,)),
)
