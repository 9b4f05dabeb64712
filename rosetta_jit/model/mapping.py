"""A mapping: two types and the rules between their fields, one block for each direction.

    Mapping = Import*, Function*, Parameter*, State*, holder type, wire type or Wire*, Rule* for both directions, to unpack, to pack
    Rule    = those of `model.rules`, with Path and Expr; an Assign is `by` a Via, or "checked"
            | Relation(Path | Len | List, Expr, Via) | Rest | SameNames(Renamed*, Path*) | Arranged(place, flag, {constant: Expr})
            | Several(Path*, Expr)

In a rule to unpack the place is on the holder's side, in a rule to pack on the wire's. Relations and loops of them stand in the rules for
both directions alone, with the place on the holder's side.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union
from typing import Literal as OneOf

from rosetta_jit.model.expr import Expr, Len, List, Path
from rosetta_jit.model.rules import Assign, Default, For, Ignore, Reject, SetLength, SetState, When
from rosetta_jit.startup.dataclass import dataclass, field

if TYPE_CHECKING:
    from rosetta_jit.source import Source, Span

OF_WIRES = "wires "
"""What the name of the struct begins with that has a field for each of several wires. No IDL can give it to a type."""


@dataclass(frozen=True, slots=True)
class Import:
    """``import "path"``: a file on the search path."""

    path: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """``parameter name: type = default``: said when a program is made. ``type`` is the name of a scalar; of each item, of a list."""

    name: str
    type: str
    is_list: bool
    default: Expr | None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class State:
    """``state name: type = initial``: a value that a program keeps from one message to the next. ``type`` is the name of a scalar."""

    name: str
    type: str
    initial: Expr
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Via:
    """``via "path" to depth 4``: the mapping by which a value becomes another, and how often it may be within itself."""

    mapping: str
    depth: int | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Function:
    """``function name(type, …): type``: a function of numbers that whoever makes a decoder or encoder gives."""

    name: str
    parameters: tuple[TypeName, ...]
    result: TypeName
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TypeName:
    """The name of a scalar type."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Wire:
    """``wire-schema name: type``: one of several wires, whose messages arrive one by one and are one holder together."""

    name: str
    type: str
    span: Span | None = field(default=None, compare=False, repr=False)


Way: TypeAlias = Via | OneOf["checked"]
"""How a value becomes one of a place: by another mapping; or ``checked``, so that what the place cannot hold is an error when it comes."""


@dataclass(frozen=True, slots=True)
class Relation:
    """``.place <-> value``, ``len(.place) <-> value``: what `language.both_ways.derive` makes rules for both directions of.

    A list of places is related to the numbers of a group (`language.groups`), in their order.
    """

    place: Path | Len | List
    value: Expr
    span: Span | None = field(default=None, compare=False, repr=False)
    via: Via | None = None


@dataclass(frozen=True, slots=True)
class Rest:
    """``ignore rest``: it is meant that no rule reads what none reads; ``default rest``, that no rule sets what none sets.

    One that is not ``written`` follows from the edition of the mapping.
    """

    word: OneOf["ignore", "default"]
    span: Span | None = field(default=None, compare=False, repr=False)
    written: bool = field(default=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Renamed:
    """``.new = .old``, ``.new <-> .old``: a field that is called otherwise on the other side."""

    place: Path
    value: Path
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SameNames:
    """``same names with .new = .old except .a, .b``: a field that no other rule sets has the value of the field of its name.

    ``renames`` are mapped as if they had one name. ``both`` is whether it was written for both directions.
    """

    but: tuple[Path, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)
    both: bool = False
    renames: tuple[Renamed, ...] = ()


@dataclass(frozen=True, slots=True)
class Arranged:
    """``.place by .flag = { constant = value, ... }``: what the array is where the flag has this value.

    In a rule for one direction there is one case: the flag is set with the array. For both directions there may be several, of
    which unpacking takes the first.
    """

    place: Path
    flag: Path
    cases: tuple[tuple[Expr, Expr], ...]
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Several:
    """``.a, .b, .c = value``, ``.a, .b, .c <-> value``: several places, and a value of as many numbers.

    `language.parameters.bind` makes rules of one place of it, or a `Relation` of a list.
    """

    places: tuple[Path, ...]
    value: Expr
    span: Span | None = field(default=None, compare=False, repr=False)
    is_relation: bool = False


Assignment: TypeAlias = Assign[Path, Expr, Way]
Rule: TypeAlias = Union[  # noqa: UP007 - `|` makes a union for each of its signs, which takes half a millisecond of a start
    Assignment,
    SetLength[Path, Expr],
    For["Rule", Expr],
    When["Rule", Expr],
    Reject[Expr],
    Relation,
    Ignore[Path],
    Default[Path],
    Rest,
    SameNames,
    Arranged,
    SetState[str, Expr],
    Several,
]


@dataclass(frozen=True, slots=True)
class Mapping:
    """What a mapping file says. None as rules means that the block is missing, ``()`` that it is empty.

    ``limit`` is how many bytes of a holder's lane a message may ask for whatever its own size, where the mapping says so. ``rounds`` is
    whether float64 becomes float32 without a word in each rule, ``is_old`` whether it is read as mappings of 2012 were. Where it has
    several ``wires``, ``wire_type`` is the name of a struct that has a field for each of them, by its name.
    """

    source: Source
    imports: tuple[Import, ...]
    holder_type: str
    wire_type: str
    rules: tuple[Rule, ...] | None
    unpack_rules: tuple[Rule, ...] | None
    pack_rules: tuple[Rule, ...] | None
    holder_span: Span | None = field(default=None, compare=False, repr=False)
    wire_span: Span | None = field(default=None, compare=False, repr=False)
    functions: tuple[Function, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    limit: int | None = None
    rounds: bool = False
    state: tuple[State, ...] = ()
    is_old: bool = False
    wires: tuple[Wire, ...] = ()
