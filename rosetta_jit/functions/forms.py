"""What several records share: calls that are one operation of the kernel, functions of texts, laws."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

from rosetta_jit.kernel.nodes import Arithmetic, Binary, Expr, Unary
from rosetta_jit.kernel.nodes import Function as Operation
from rosetta_jit.language.affine_steps import LostError, Value
from rosetta_jit.language.function import Function, Row, Undone
from rosetta_jit.language.typed import Call, Const, Given
from rosetta_jit.lowering.evaluation import Evaluation

if TYPE_CHECKING:
    from rosetta_jit.language.function import Back


def unary_of(call: Call, values: Evaluation) -> Expr:
    """The operation of one number that is called as the function is."""
    return Unary(cast("Operation", call.function), values.of(call.arguments[0]))


def binary_of(call: Call, values: Evaluation) -> Expr:
    """The operation of two numbers that is called as the function is; of more, done from the left."""
    found, *rest = [values.of(each) for each in call.arguments]
    for each in rest:
        found = Binary(cast("Arithmetic", call.function), found, each)
    return found


# --- functions of texts --------------------------------------------------------------------------------------------------

of_texts = partial(Function, operation="string manipulation", kept=False)
"""The record of a function that takes or gives texts."""


def row(forms: str, gives: str, kind: str = "") -> tuple[Row]:
    """A row of the table of texts: what calls give, and the kind of error where they cannot."""
    return (Row("texts", forms, (gives, kind)),)


# --- laws ----------------------------------------------------------------------------------------------------------------


def undone_by(**inverses: Back) -> Undone:
    """A step that these functions undo, each as far as it says; without any, one that nothing undoes."""
    return Undone(MappingProxyType(inverses))


def loses(why: str) -> Back:
    """The value comes back but for what is said."""

    def back(_opening: Call, _step: Call, _before: Value) -> Value:
        raise LostError(why)

    return back


def if_same_constants(opening: Call, step: Call, before: Value) -> Value | None:
    """The value comes back if both calls have the same constants."""
    return before if constants_of(opening) == constants_of(step) else None


def constants_of(call: Call) -> list[object]:
    """The arguments of a call that are known, or will be when parameters are given."""
    return [each if isinstance(each, Given) else each.value for each in call.arguments if isinstance(each, Const | Given)]
