"""Rules and expressions whose names are resolved and whose types are known: what `lower` consumes.

    Expr = Const | Local | Access | LenOf | Unary | Binary | Convert | Nearest | IsText | Has | Search | Reduce | Call | HostCall | Choice
         | Listed | Given | StateVariable                            each with `type`
    Place = side, Step*, type        Step = FieldStep(Field) | IndexStep(Expr of int64)
    Change = Rescale | EachElement | EachMember
    Rule = those of `model.rules`, with Place and Expr: of int64 in a SetLength, of bool in a When; an Assign is `by` a Change

Every change of a scalar type is a `Convert`; both operands of a `Binary` have one type, which is its own unless it compares.
Numbers of different units are converted by a `Binary` of `*`, and of `+` where their scales have different origins; within a whole value,
by the `Change` of its `Assign`.
Only an `Assign` of a whole array, struct, string or blob (`Access` as the value) may have two types: elements are then widened,
text is checked, and a length that the target fixes is checked.
"""

from __future__ import annotations

from typing import Literal as OneOf
from typing import TypeAlias, Union

from rosetta_jit.model.expr import Operator, Side
from rosetta_jit.model.rules import Assign, Default, For, Ignore, Reject, SetLength, SetState, When
from rosetta_jit.model.types import Bool, Field, Int, Type
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field

INT64 = Int(64)
BOOL = Bool()
UINT16 = Int(16, signed=False)
"""A unit of a text that is kept in such units."""

ConversionRule = OneOf["widen", "exact", "saturate", "wrap", "round", "truncate", "nearest"]
"""``widen`` cannot fail; ``exact``, ``round`` (half to even) and ``truncate`` (toward zero) are a range error where the
target cannot hold the result; ``saturate`` and ``wrap`` always give one; ``nearest`` is IEEE rounding to a float."""


@dataclass(frozen=True, slots=True)
class FieldStep:
    """A member of a struct or a case of a union."""

    field: Field


@dataclass(frozen=True, slots=True)
class IndexStep:
    """An element, counted from 0; outside the array it is an error of kind ``index``."""

    index: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


Step = FieldStep | IndexStep


@dataclass(frozen=True, slots=True)
class Place:
    """A place on one side. ``type`` is that of the last step, without Optional and with references resolved."""

    side: Side
    steps: tuple[Step, ...]
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Const:
    """A number, text or enum value that is known; floats that a float32 cannot hold exactly are rounded when used.

    A parameter's is ``declared``: in arithmetic it is of the type that the mapping says, whatever else may hold it.
    """

    value: bool | int | float | str
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)
    declared: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Local:
    """A loop variable, int64; ``counts`` where the loop begins at a small constant, so that its rounds tell how large it can become."""

    name: str
    type: Type = INT64
    span: Span | None = field(default=None, compare=False, repr=False)
    counts: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Access:
    """The value at a place."""

    place: Place
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class LenOf:
    """The number of elements, or of bytes, at a place; int64."""

    place: Place
    type: Type = INT64
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Unary:
    """``-operand``, of int64 or a float; ``not operand``, of a bool."""

    operator: OneOf["-", "not"]
    operand: Expr
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Binary:
    """Arithmetic of two int64, or of two floats of one size; comparisons of two scalars of one type; logic of two bools."""

    operator: Operator
    left: Expr
    right: Expr
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Convert:
    """A scalar as another type."""

    operand: Expr
    type: Type
    rule: ConversionRule
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Nearest:
    """The integer nearest to a float, for which ``check`` must hold, where ``variable`` is it: else an error of kind ``range``.

    It packs what a relation computes in floats from an integer: ``check`` says that the relation gives the same of it.
    """

    operand: Expr
    variable: Local
    check: Binary
    type: Int
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Call:
    """A function of the language, by the name of its record (`language.function`): `+` and `<=>` are operators of texts."""

    function: str
    arguments: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class IsText:
    """Whether a string or bytes field holds a text that the mapping writes down."""

    place: Place
    text: str
    type: Type = BOOL
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Has:
    """Whether something that can be absent is there: an optional field, a case of a union, and all on the way to it."""

    place: Place
    type: Type = BOOL
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Search:
    """The number of the one element of an array for which a condition on it, by the number ``variable``, holds; int64.

    None, or several, are an error of kind ``index``, whose text is ``wanted``; unless it is ``required``, none give -1 and several -2.
    """

    place: Place
    variable: Local
    condition: Expr
    wanted: str
    required: bool
    type: Type = INT64
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Reduce:
    """What a function makes of the values that ``value`` has for each ``variable`` from 0 to before ``count``, in this order.

    Where a condition of ``refused`` holds the message is rejected, with the text beside it. Of no values some functions have no result,
    which is an error of kind ``range``, unless this is not ``required``: then it is any number. ``chosen`` is how many of the values are
    taken; those that are not are what adds nothing to the others.
    """

    function: str
    variable: Local
    count: Expr
    value: Expr
    type: Type
    refused: tuple[tuple[Expr, str], ...] = ()
    required: bool = True
    chosen: Reduce | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class HostCall:
    """A function that the mapping declares and its user gives; the arguments have the types that it declares."""

    function: str
    arguments: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Choice:
    """The value of the first case whose condition holds, else ``otherwise``; without that the message is rejected, with ``reason``.

    All values have ``type``. A choice among texts stands only as the whole value of an `Assign`.
    """

    cases: tuple[tuple[Expr, Expr], ...]
    otherwise: Expr | None
    reason: str
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)
    pieces: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class Listed:
    """One of several values of ``type``, by its number from 0; outside of them it is an error of kind ``index``.

    One among texts stands only as the whole value of an `Assign`.
    """

    items: tuple[Expr, ...]
    index: Expr
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Given:
    """A parameter, an item or the length of one, in a mapping that is checked before they are given; it is never lowered."""

    name: str
    arguments: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StateVariable:
    """What a state variable is while a message is read: what the messages before it have left. ``number`` is its place among all.

    Each direction has its own variables: they are those of the rules that fill ``target``.
    """

    name: str
    number: int
    target: Side
    type: Type
    span: Span | None = field(default=None, compare=False, repr=False)


Expr = (
    Const
    | Local
    | Access
    | LenOf
    | Unary
    | Binary
    | Convert
    | Nearest
    | IsText
    | Has
    | Search
    | Reduce
    | Call
    | HostCall
    | Choice
    | Listed
    | Given
    | StateVariable
)


@dataclass(frozen=True, slots=True)
class Rescale:
    """A number in another unit: times the factor, plus the offset."""

    source: str
    target: str
    factor: float
    offset: float


@dataclass(frozen=True, slots=True)
class EachElement:
    """What changes in the elements of an array or the values of a map; ``numbered`` are those that are not like the rest."""

    rest: Change | None
    numbered: tuple[tuple[int, Change | None], ...] = ()


@dataclass(frozen=True, slots=True)
class EachMember:
    """What changes in the members of a struct or union, by name."""

    members: tuple[tuple[str, Change], ...]


Change = Rescale | EachElement | EachMember


Assignment: TypeAlias = Assign[Place, Expr, Change]
Rule: TypeAlias = Union[  # noqa: UP007 - as of rules that have no types yet
    Assignment,
    SetLength[Place, Expr],
    For["Rule", Expr],
    When["Rule", Expr],
    Reject[Expr],
    Ignore[Place],
    Default[Place],
    SetState[StateVariable, Expr],
]
