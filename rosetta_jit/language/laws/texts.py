"""Which functions of texts undo each other, and what is lost where they do not: g(f(x)) = x for every x that neither refuses.

| f                    | g                    |                                                     |
|----------------------|----------------------|-----------------------------------------------------|
| `text(n)`            | `integer`            | exact                                               |
| `text(x)`, float64   | `number`             | exact: as few digits as read back                   |
| `text(b, e)`         | `bytes(s, e)`        | exact, and the reverse                              |
| `"a" + s`, `s + "a"` | `behind`, `before`   | exact, and the reverse                              |
| `join`               | `split`              | exact, and the reverse                              |
| `iso8601(n)`         | `nanoseconds`        | exact                                               |
| `integer`, `number`  | `text`               | other spellings of the number are lost              |
| `nanoseconds`        | `iso8601`            | other spellings of the date are lost                |
| `until_nul`, `padded`| each other           | what is behind the first NUL is lost                |
| `timestamp`          | `nanoseconds`        | nanoseconds that a float64 does not tell are lost   |
| `nanoseconds(x)`     | `timestamp`          | rounded to nanoseconds and to a float64             |
"""

from __future__ import annotations

from rosetta_jit.language.typed import Const, Expr, TextCall
from rosetta_jit.model.types import Float

SPELLING = "a number is written in one way, however it was spelt"
DATE = "a date is written in one way, in UTC, however it was spelt"
MOMENT = "it is rounded to a float64, which tells moments of today to about 240 ns"
BEHIND_NUL = "what is behind the first NUL is dropped"

LOST = {
    ("integer", "written"): SPELLING,
    ("number", "written"): SPELLING,
    ("nanoseconds", "iso8601"): DATE,
    ("seconds", "iso8601"): "it becomes a whole second, in UTC",
    ("seconds", "timestamp"): "what is behind the point is dropped",
    ("timestamp", "nanoseconds"): MOMENT,
    ("timestamp", "seconds"): "large integers are rounded to a float",
    ("until_nul", "padded"): BEHIND_NUL,
    ("padded", "until_nul"): BEHIND_NUL,
}
"""What one function and the one behind it drop."""

SAME = frozenset((("decoded", "bytes"), ("bytes", "decoded"), ("join", "split"), ("split", "join")))
"""Those that undo each other where their last arguments are the same."""


def inner_text(call: TextCall) -> Expr | None:
    """The one argument that is not written down; None where there are several."""
    others = [each for each in call.arguments if not isinstance(each, Const)]
    return others[0] if len(others) == 1 else None


def why_lost(expr: Expr) -> str | None:
    """Why no part of a value of several comes back, where that is known."""
    return MOMENT if isinstance(expr, TextCall) and expr.function == "timestamp" else None


def rounds_moment(step: TextCall, opening: TextCall) -> bool:
    """Whether a float64 of seconds was made nanoseconds and is made a float64 again."""
    return (opening.function, step.function) == ("nanoseconds", "timestamp") and isinstance(opening.arguments[0].type, Float)


def undone(step: TextCall, opening: TextCall) -> bool | str:
    """Whether a function gives back what another one was given; else why not, where that is known."""
    pair = (opening.function, step.function)
    if (step.function == "iso8601" and isinstance(opening.arguments[0].type, Float)) or rounds_moment(step, opening):
        return rounds_moment(step, opening)
    if pair in LOST:
        return LOST[pair]
    if pair in SAME:
        return _written(step) == _written(opening)
    match pair:
        case ("written", "integer"):
            return len(opening.arguments) == 1 and not isinstance(opening.arguments[0].type, Float)
        case ("written", "number"):
            number, *decimals = opening.arguments
            return not decimals and isinstance(number.type, Float) and number.type.bits == 64
        case ("iso8601", "nanoseconds"):
            return len(opening.arguments) == 1
        case ("iso8601", "seconds"):
            return isinstance(opening.arguments[-1], Const)
        case ("concatenated", ("behind" | "before") as side):
            return _is_added(opening, side) and _written(step) == _written(opening)
        case (("behind" | "before") as side, "concatenated"):
            return _is_added(step, side) and _written(step) == _written(opening)
        case _:
            return False


def _is_added(call: TextCall, side: str) -> bool:
    """Whether a text that is written down stands at that end of a sum."""
    return isinstance(call.arguments[0 if side == "behind" else 1], Const)


def _written(call: TextCall) -> list[object]:
    return [each.value for each in call.arguments if isinstance(each, Const)]
