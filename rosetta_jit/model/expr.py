"""One expression language: mapping rules, counts, and constants that are computed.

    Expr = Literal | Name | Path | Len | Unary | Binary | Call | Choice | List | Item | Given | Coerced | Nearest
    Path = Root, Step*         Step = Member(name) | Index(Expr) | Keyed(name*, Expr, name*) | Slice(Expr, Expr, Expr) | Pick(int*) | Each

A `Path` starts at one of the two sides of a mapping; which one is `side`. Inside a wire schema's own expressions (a computed
constant) the side is always ``wire``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Literal as OneOf

from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.model.scalars import Int, Scalar
    from rosetta_jit.source import Span

Side = OneOf["holder", "wire"]
Operator = OneOf["+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "==", "!=", "<", "<=", ">", ">=", "differs", "and", "or"]
"""`/` and `%` of two integers truncate toward zero, as in C; of anything else they are floating. No text has `differs`: `!=` to the bit."""

COMPARISONS: frozenset[str] = frozenset(("==", "!=", "<", "<=", ">", ">=", "differs"))
LOGIC: frozenset[str] = frozenset(("and", "or"))
BITWISE: frozenset[str] = frozenset(("&", "|", "^", "<<", ">>"))


@dataclass(frozen=True, slots=True)
class Literal:
    """A number, a string, or a boolean written in the text, or the value of a parameter, whose ``type`` it has."""

    value: bool | int | float | str
    span: Span | None = field(default=None, compare=False, repr=False)
    type: Scalar | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class Name:
    """A loop variable (``i``), an enum constant by qualified name, a parameter, a state variable, a constant of the language (``pi``)."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Member:
    """``.name``"""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Index:
    """``[index]``, counted from 0."""

    index: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Keyed:
    """``[.key = value]``: the one element whose field has this value; ``names`` are those on the way to the field.

    ``[.keys[].key = value]`` is the element of the same number as the one of ``beside`` has: of an array that lies in the same message.
    """

    names: tuple[str, ...]
    value: Expr
    span: Span | None = field(default=None, compare=False, repr=False)
    beside: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Slice:
    """``[start to stop by step]``: these elements, as an array; to the last one where ``stop`` is None."""

    start: Expr
    stop: Expr | None
    step: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Pick:
    """``[[2, 0, 1]]``: the elements of these numbers, in this order."""

    indices: tuple[int, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Each:
    """``[]``: every element; a rule with it holds for all of them."""

    span: Span | None = field(default=None, compare=False, repr=False)


Step = Member | Index | Keyed | Slice | Pick | Each


@dataclass(frozen=True, slots=True)
class Path:
    """A place on one side: ``.joints[i].name``."""

    side: Side
    steps: tuple[Step, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Len:
    """``len(.path)``: number of elements, or of bytes of a string or blob."""

    path: Path
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Unary:
    """``-operand``, ``not operand``"""

    operator: OneOf["-", "not"]
    operand: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Binary:
    """``left operator right``"""

    operator: Operator
    left: Expr
    right: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Call:
    """``function(argument, ...)``: a conversion (``float32(x)``) or a function of the language (``radians(x)``).

    ``where`` is the condition by which a reduction takes elements: ``mean(.a[] where .a[] > 0)``.
    """

    function: str
    arguments: tuple[Expr, ...]
    span: Span | None = field(default=None, compare=False, repr=False)
    where: Expr | None = None


@dataclass(frozen=True, slots=True)
class Choice:
    """The value of the first case whose condition holds, else ``otherwise``; None rejects the message, with ``reason``, or with
    what its ``pieces`` say, texts and values by turns.

    ``a if condition else b`` is one; so is ``table(subject) { key = value, … }``, whose conditions compare the subject with the keys.
    """

    cases: tuple[tuple[Expr, Expr], ...]
    otherwise: Expr | None
    reason: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
    pieces: tuple[Expr, ...] = ()


@dataclass(frozen=True, slots=True)
class List:
    """``[a, b, c]``"""

    items: tuple[Expr, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Item:
    """``names[index]``, ``[a, b, c][index]``: an item of a list of the text, or of a parameter.

    ``euler(.q).yaw``: one number of a group (`language.groups`), whose name is a literal as the index.
    """

    items: Expr
    index: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Given:
    """A parameter whose value is not known yet, an item or the length of one. What reads mappings before they are used has them.

    ``type`` is that of each item, where it is a list.
    """

    name: str
    arguments: tuple[Expr, ...]
    type: Scalar
    span: Span | None = field(default=None, compare=False, repr=False)
    is_list: bool = False


@dataclass(frozen=True, slots=True)
class Coerced:
    """A value converted to the unit and the type of a place. No text has one; rules for both directions are made of them."""

    place: Path
    value: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


NEAREST = "(nearest)"
"""The name of the integer that a `Nearest` gives, within what computes its relation again. No mapping can write it."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """A relation solved for an integer: the one of this ``type`` nearest to ``value``, a float, if the relation gives its place back.

    ``again`` is the relation's expression with `NEAREST` for the field, ``place`` what that must be. No text has one; rules for both
    directions are made of them.
    """

    value: Expr
    again: Expr
    place: Expr
    type: Int
    span: Span | None = field(default=None, compare=False, repr=False)


Expr = Literal | Name | Path | Len | Unary | Binary | Call | Choice | List | Item | Given | Coerced | Nearest
