"""What the kernel's host says of this message."""

from __future__ import annotations

from rosetta_jit.kernel.nodes import Expr, HostValue
from rosetta_jit.language.function import NOT_FOLLOWED, SEVERAL, Function, Numbers, Row
from rosetta_jit.language.typed import INT64, Call
from rosetta_jit.lowering.evaluation import Evaluation

NOTHING = Numbers((INT64,), (0, 0), "no values")
OF_MESSAGES = Row(
    "numbers",
    "`now()`, `counter()`",
    ("", "int64: when the message is made, in ns since 1970; how many messages the decoder or encoder has made before"),
)


def _lower_now(_call: Call, _values: Evaluation) -> Expr:
    return HostValue("now")


def _lower_counter(_call: Call, _values: Evaluation) -> Expr:
    return HostValue("number")


FUNCTIONS = tuple(
    Function(name, NOTHING, lower, SEVERAL, NOT_FOLLOWED, (OF_MESSAGES,), operation="generators", kept=False, changes=True)
    for name, lower in (("now", _lower_now), ("counter", _lower_counter))
)
