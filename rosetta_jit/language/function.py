"""A function of the language: one record says all that is known of it.

    Function = name, signature, units, lower, inverse | why there is none, law, rows of the reference, operation, reduction

The records of the language stand in `rosetta_jit.functions`, one file a family; `rosetta_jit.language.installed` finds them by name. An
operator of texts is a record with a name that no mapping can write: `+`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING
from typing import Literal as OneOf

from rosetta_jit.language import typed
from rosetta_jit.language.scope import Scope
from rosetta_jit.language.typed import Expr
from rosetta_jit.model import expr as model
from rosetta_jit.model.types import Float, Int, Type
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.affine_steps import Value

    Solved = tuple[model.Expr, model.Expr]
    """An argument of a call, and what it must be."""

    Own = Callable[[model.Call, list[Expr], Scope], Expr | None]
    """A signature of its own: the typed call of typed arguments; None where there is none, and the problem is in the scope."""

    Inverse = Callable[[model.Call, model.Expr], Solved | None]
    Split = Callable[[model.Call, model.Expr], tuple[Solved, Solved]]
    Back = Callable[[typed.Call, typed.Call, Value], Value | None]
    """Of a call, the one behind it, and the value before both: the value behind both; None where it is not undone."""

    Undoes = Callable[[typed.Call], Expr | None]
    """Of a call, the value that comes back in it; None where its arguments are not undone."""


# --- types ---------------------------------------------------------------------------------------------------------------

Count = tuple[int, int | None]
"""How many arguments there may be: at least, and at most."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """Of numbers: all arguments and the result are of the first of the ``types`` that every argument becomes without a loss.

    ``fold`` computes integers that are known, or gives None where the function refuses them. The last argument of one that ``divides``
    must not be 0.
    """

    types: tuple[Int | Float, ...]
    count: Count = (1, 1)
    takes: str = "one value"
    fold: Callable[[list[int]], int | None] | None = None
    divides: bool = False


@dataclass(frozen=True, slots=True)
class Texts:
    """Of texts: the kinds of the arguments, of which the last ``optional`` ones may be left out. None gives what the first argument is."""

    takes: tuple[str, ...]
    gives: Type | None
    optional: int = 0


def nothing(type_: Type) -> bool | int | float:
    """False, or 0: what changes no sum, and no count."""
    match type_:
        case Float():
            return 0.0
        case Int():
            return 0
        case _:
            return False


@dataclass(frozen=True, slots=True)
class Reduction:
    """Of many values, which an expression with `[]` has: `sum(.a[] * 2)`.

    Attributes
    ----------
    signature
        The type that every value becomes; it is that of the result, too, unless ``gives`` is another. None of conditions.
    lower
        What it becomes in a kernel. It takes the elements (`rosetta_jit.lowering.reduced_elements`) and gives a kernel expression.
    of_nothing
        What is wrong with no value at all: the text of an error of kind ``range``. Empty where the function has a result for it.
    unchosen
        A value of a type that changes no result: what elements count as that ``where`` leaves out.
    """

    signature: Numbers | None
    lower: Callable[..., object]
    gives: Type | None = None
    of_nothing: str = ""
    unchosen: Callable[[Type], bool | int | float] = nothing


@dataclass(frozen=True, slots=True)
class Units:
    """What a function has to do with units.

    Attributes
    ----------
    takes
        The unit of its first argument.
    gives
        The unit of its value.
    keeps
        Whether its value is in the unit of its arguments.
    joins
        Whether all arguments must be in one unit.
    """

    takes: str | None = None
    gives: str | None = None
    keeps: bool = False
    joins: bool = False


# --- the other direction -------------------------------------------------------------------------------------------------

SEVERAL = "gives the same for several values"
"""Why most functions have no inverse."""


@dataclass(frozen=True, slots=True)
class ByType:
    """An inverse that depends on the type of the argument that has the field: `text(n)` is undone by `integer` or by `number`.

    Of a call, its value, and the type of its first argument, None where that has none.
    """

    undo: Callable[[model.Call, model.Expr, Type | None], Solved | None]


@dataclass(frozen=True, slots=True)
class Whole:
    """A function that gives one part of a value whose ``rest`` another function gives; both together say the value.

    ``below`` is the number that the rest of a call is less than: 0 where that goes without saying, None where the call is no such part.
    ``joined`` is the value whose first part a call gives, and the rest the second: of a type, None where that is unknown.
    """

    rest: str
    below: Callable[[model.Call], int | None]
    joined: Callable[[model.Call, model.Expr, model.Expr, Type | None], model.Expr]


# --- laws ----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Affine:
    """A step that scales and shifts its one unknown argument.

    ``exact`` says that each value comes from one argument alone, or the step refuses it; ``rounds``, that it rounds if computed in floats.
    """

    follow: Callable[[typed.Call, Value], Value]
    exact: bool = False
    rounds: bool = False


@dataclass(frozen=True, slots=True)
class Undone:
    """A step that others undo: ``by`` says which, and what is left; ``of_several`` is why nothing comes back of several fields.

    ``rounded`` gives, of the value before a step that gives a float64, what rounding to a float32 undoes the steps so far to, or None.
    """

    by: Mapping[str, Back]
    of_several: str | None = None
    rounded: Callable[[Value], Value | None] | None = None


@dataclass(frozen=True, slots=True)
class NotFollowed:
    """Nothing is shown of what comes back through this step."""


NOT_FOLLOWED = NotFollowed()

Law = Affine | Undone | NotFollowed


Operation = OneOf[
    "arithmetic",
    "array reorder",
    "string manipulation",
    "image compression",
    "predicate assignment",
    "subtype loops",
    "rejection",
    "generators",
    "date manipulation",
]
"""The operations of the paper's table 2, as `explain` counts them."""


# --- the record ----------------------------------------------------------------------------------------------------------

Table = OneOf["numbers", "groups", "elements", "arrays", "texts", "bytes", "images"]
"""The tables of the reference."""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the reference: how calls are written, and the two cells behind that, as the heads of its table say."""

    table: Table
    forms: str
    cells: tuple[str, str]


@dataclass(frozen=True, slots=True)
class Function:
    """All that is known of a function.

    Attributes
    ----------
    signature
        The types of its arguments and of its value.
    lower
        What a call becomes in a kernel. It takes the typed call and the evaluation around it (`rosetta_jit.lowering.evaluation`); it gives
        a kernel expression, or of a text the place of its bytes.
    inverse
        Of a call and its value: the argument that holds the field, and what that must be; None where such a call has no inverse. As a text:
        why there is none.
    law
        What comes back of its argument.
    undoes
        What a call comes to whose arguments are calls that it undoes, where one value becomes several or several one:
        `seconds(iso8601(n, i))` is n.
    rows
        Its rows in the reference; functions that share a row share the record of it.
    operation
        What `explain` counts it as.
    units
        The units that it takes and gives.
    split
        Of a call with two arguments and its value: both, and what each of them must be.
    whole
        Which function gives what this one leaves.
    remark
        What it does to a value that a reader should know, for `explain`.
    kept
        Whether a value that is computed once may serve several rules: not if the host is asked, or a text is made.
    changes
        Whether its value is another one for each message, so that none could be compared with it.
    reduction
        What a call of one expression with `[]` comes to; None where such a call is meant for each element.
    """

    name: str
    signature: Numbers | Texts | Own
    lower: Callable[..., object]
    inverse: Inverse | ByType | str
    law: Law
    rows: tuple[Row, ...]
    operation: Operation = "arithmetic"
    units: Units = Units()
    undoes: Undoes | None = None
    split: Split | None = None
    whole: Whole | None = None
    remark: str = ""
    kept: bool = True
    changes: bool = False
    reduction: Reduction | None = None
