"""What genpy's Time and Duration can do besides having ``secs`` and ``nsecs``: they are made of seconds, compared, and calculated with.

A result is a new object, never a view. The other operand may be one of genpy's own.
"""

from __future__ import annotations

from collections.abc import Callable
from numbers import Integral, Real
from operator import ge, gt, le, lt
from typing import Any, Literal

from rosetta_jit.frameworks.ros1.time_types import STRUCTS
from rosetta_jit.model.types import Ref, Schema
from rosetta_jit.runtime.holder import Holder, holder_class

NANO = 1_000_000_000
SCHEMA = Schema(STRUCTS)

Kind = Literal["time", "duration"]


def kind_of(value: Any) -> Kind | None:
    """Whether a value is a time, a duration, or neither."""
    if not (hasattr(value, "secs") and hasattr(value, "nsecs")):
        return None
    return "time" if hasattr(value, "to_time") else "duration"


def made(like: Any, kind: Kind, secs: float, nsecs: int = 0) -> Any:
    """A time or a duration with the manners of another."""
    return holder_class(Ref(kind), SCHEMA, like.family_.manners)(secs, nsecs)  # pyright: ignore[reportCallIssue] - `initialise` is its own


def initialise(self: Any, secs: float = 0, nsecs: int = 0) -> None:
    """Seconds and nanoseconds; those beyond a second are carried over. With a float there are no nanoseconds."""
    Holder.__init__(self)
    if not isinstance(secs, Integral):
        if nsecs:
            raise ValueError("if secs is a float, nsecs cannot be set")
        secs, nsecs = _split(secs)
    if secs or nsecs:
        carried, self.nsecs = divmod(int(nsecs), NANO)
        total = int(secs) + carried
        if total < 0 and kind_of(self) == "time":
            raise TypeError("time values must be positive")
        self.secs = total


def _split(seconds: float) -> tuple[int, int]:
    return int(seconds), int((seconds - int(seconds)) * NANO)


def from_sec(cls: Any, float_secs: float) -> Any:
    """Make one of seconds, as `time.time` gives them."""
    return made(cls, _own(cls), *_split(float_secs))


def to_nsec(self: Any) -> int:
    """Nanoseconds."""
    return self.secs * NANO + self.nsecs


def to_sec(self: Any) -> float:
    """Seconds, as a float."""
    return self.secs + self.nsecs / NANO


def set_nsec(self: Any, nanoseconds: int) -> Any:
    """Become so many nanoseconds; returns itself."""
    self.secs, self.nsecs = divmod(nanoseconds, NANO)
    return self


def set_both(self: Any, secs: int, nsecs: int) -> None:
    """Become these seconds and nanoseconds."""
    self.secs, self.nsecs = secs, nsecs


def canon(self: Any) -> None:
    """Carry over nanoseconds beyond a second."""
    set_nsec(self, to_nsec(self))


def is_zero(self: Any) -> bool:
    """Whether it is no time at all."""
    return not (self.secs or self.nsecs)


def _own(self: Any) -> Kind:
    return "time" if self.family_.struct.name == "time" else "duration"


def _comparing(compare: Callable[[int, int], bool]) -> Callable[[Any, Any], bool]:
    """A comparison with one of the same kind."""

    def compared(self: Any, other: Any) -> bool:
        return compare(to_nsec(self), to_nsec(other)) if kind_of(other) == _own(self) else NotImplemented

    return compared


def _hash(self: Any) -> int:
    return hash((self.secs, self.nsecs))


def _is_some(self: Any) -> bool:
    return not is_zero(self)


def _str(self: Any) -> str:
    return str(to_nsec(self))


def _repr(self: Any) -> str:
    return f"genpy.{_own(self).capitalize()}[{to_nsec(self)}]"


# --- sums and differences ----------------------------------------------------------------------------------------------------


def _add(self: Any, other: Any) -> Any:
    """A duration is added to either, a time to a duration alone."""
    kinds = {_own(self), kind_of(other)}
    if None in kinds or (kind_of(other) == "time" and _own(self) == "time"):
        return NotImplemented
    return made(self, "time" if "time" in kinds else "duration", self.secs + other.secs, self.nsecs + other.nsecs)


def _subtract(self: Any, other: Any) -> Any:
    """The duration between two times; either before a duration."""
    kind = kind_of(other)
    if kind is None or (kind == "time" and _own(self) == "duration"):
        return NotImplemented
    return made(self, "duration" if kind == "time" else _own(self), self.secs - other.secs, self.nsecs - other.nsecs)


def _negative(self: Any) -> Any:
    return made(self, "duration", -self.secs, -self.nsecs)


def _absolute(self: Any) -> Any:
    return self if self.secs >= 0 else _negative(self)


# --- multiples and quotients of durations: by way of floats, where genpy goes that way -------------------------------------------


def _multiply(self: Any, factor: Any) -> Any:
    if isinstance(factor, Integral):
        return made(self, "duration", self.secs * int(factor), self.nsecs * int(factor))
    return _of_seconds(self, to_sec(self) * float(factor)) if isinstance(factor, Real) else NotImplemented


def _divide(self: Any, divisor: Any) -> Any:
    if kind_of(divisor) == "duration":
        return to_sec(self) / divisor.to_sec()
    return _of_seconds(self, to_sec(self) / float(divisor)) if isinstance(divisor, Real) else NotImplemented


def _divide_whole(self: Any, divisor: Any) -> Any:
    if kind_of(divisor) == "duration":
        return int(to_sec(self) // divisor.to_sec())
    return _of_seconds(self, to_sec(self) // float(divisor)) if isinstance(divisor, Real) else NotImplemented


def _rest(self: Any, divisor: Any) -> Any:
    return _of_seconds(self, to_sec(self) % divisor.to_sec()) if kind_of(divisor) == "duration" else NotImplemented


def _divide_with_rest(self: Any, divisor: Any) -> Any:
    return (_divide_whole(self, divisor), _rest(self, divisor)) if kind_of(divisor) == "duration" else NotImplemented


def _of_seconds(self: Any, seconds: float) -> Any:
    return made(self, "duration", *_split(seconds))


SHARED: dict[str, Any] = {
    "__init__": initialise,
    "from_sec": classmethod(from_sec),
    "to_sec": to_sec,
    "to_nsec": to_nsec,
    "set": set_both,
    "set_nsec": set_nsec,
    "canon": canon,
    "is_zero": is_zero,
    "__bool__": _is_some,
    "__float__": to_sec,
    **{f"__{each.__name__}__": _comparing(each) for each in (lt, le, gt, ge)},
    "__hash__": _hash,
    "__str__": _str,
    "__repr__": _repr,
    "__add__": _add,
    "__radd__": _add,
    "__sub__": _subtract,
}
TIME = {**SHARED, "to_time": to_sec}
DURATION: dict[str, Any] = {
    **SHARED,
    "__neg__": _negative,
    "__abs__": _absolute,
    "__mul__": _multiply,
    "__rmul__": _multiply,
    "__truediv__": _divide,
    "__floordiv__": _divide_whole,
    "__mod__": _rest,
    "__divmod__": _divide_with_rest,
}
