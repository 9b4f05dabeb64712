"""Functions of angles, computed in float64 as the C library does."""

from __future__ import annotations

import math

from rosetta_jit.functions.forms import binary_of, unary_of
from rosetta_jit.kernel.nodes import Binary, Const, Expr
from rosetta_jit.kernel.terms import type_of
from rosetta_jit.language.affine_steps import Value, rounded, turned
from rosetta_jit.language.conversions import FLOAT64
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Affine, Function, Numbers, Row, Units
from rosetta_jit.language.typed import Call
from rosetta_jit.lowering.evaluation import Evaluation
from rosetta_jit.model import expr as model
from rosetta_jit.startup.dataclass import replace

OF_ONE, OF_TWO = Numbers((FLOAT64,)), Numbers((FLOAT64,), (2, 2), "two numbers")
TRIGONOMETRY = Row(
    "numbers",
    "`sin(x)`, `cos(x)`, `tan(x)`, `asin(x)`, `acos(x)`, `atan(x)`, `atan2(y, x)`",
    ("numbers", "float64, as the C library computes it; NaN where there is none"),
)
TURNS = Row("numbers", "`radians(x)`, `degrees(x)`", ("a number", "float64: `x * (pi / 180)`, `x * (180 / pi)`"))


def _lower_radians(call: Call, values: Evaluation) -> Expr:
    return _times(call, math.pi / 180, values)


def _lower_degrees(call: Call, values: Evaluation) -> Expr:
    return _times(call, 180 / math.pi, values)


def _times(call: Call, factor: float, values: Evaluation) -> Expr:
    angle = values.of(call.arguments[0])
    return Binary("mul", angle, Const(type_of(angle), factor))


def _degrees_of(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    return call.arguments[0], model.Call("degrees", (value,), call.span)


def _radians_of(call: model.Call, value: model.Expr) -> tuple[model.Expr, model.Expr]:
    return call.arguments[0], model.Call("radians", (value,), call.span)


def _follow_radians(call: Call, value: Value) -> Value:
    return rounded(replace(turned(value, 1), type=call.type), 2)


def _follow_degrees(call: Call, value: Value) -> Value:
    return rounded(replace(turned(value, -1), type=call.type), 2)


FUNCTIONS = (
    *(
        Function(each, OF_ONE, unary_of, SEVERAL, NOT_FOLLOWED, (TRIGONOMETRY,), units=Units(takes="radian"))
        for each in ("sin", "cos", "tan")
    ),
    *(
        Function(each, OF_ONE, unary_of, SEVERAL, NOT_FOLLOWED, (TRIGONOMETRY,), units=Units(gives="radian"))
        for each in ("asin", "acos", "atan")
    ),
    Function("atan2", OF_TWO, binary_of, SEVERAL, NOT_FOLLOWED, (TRIGONOMETRY,), units=Units(gives="radian", joins=True)),
    Function(
        "radians",
        OF_ONE,
        _lower_radians,
        inverse=_degrees_of,
        law=Affine(_follow_radians, rounds=True),
        rows=(TURNS,),
        units=Units(takes="degree", gives="radian"),
    ),
    Function(
        "degrees",
        OF_ONE,
        _lower_degrees,
        inverse=_radians_of,
        law=Affine(_follow_degrees, rounds=True),
        rows=(TURNS,),
        units=Units(takes="radian", gives="degree"),
    ),
)
