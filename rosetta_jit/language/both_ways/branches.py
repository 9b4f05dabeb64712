"""The two blocks of a `when` in rules for both directions: what its condition says of the wire, and how a holder tells them apart.

In the block where `.kind == 2` holds, the message has a `.kind` of 2. A holder is of the block that relates its field to the constant
that it has, where the other block relates it to other constants; or of the one that sets what it has (`language.both_ways.presence`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import NoInverseError, condition_in, fields_in, solved, subject_of
from rosetta_jit.language.both_ways.presence import may_be_absent, presence_between
from rosetta_jit.language.folding import folded, is_constant
from rosetta_jit.language.limits import MAX_TESTED
from rosetta_jit.model.expr import Binary, Call, Choice, Expr, Len, Literal, Name, Path, Unary
from rosetta_jit.model.mapping import Reject, Relation, Rule, When
from rosetta_jit.model.walk import Field, fields_of, rebuilt
from rosetta_jit.startup.dataclass import replace

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf


Constants = frozenset["Literal | Name"]


def facts_of(condition: Expr, type_of: TypeOf, *, holds: bool) -> dict[Field, Expr]:
    """The fields of the wire that a condition fixes where it holds, or where it does not."""
    match condition:
        case Unary("not", operand):
            return facts_of(operand, type_of, holds=not holds)
        case Binary("and" | "or" as operator, left, right):
            both = (operator == "and") == holds
            return {**facts_of(right, type_of, holds=holds), **facts_of(left, type_of, holds=holds)} if both else {}
        case Binary("==" | "!=" as operator, left, right) if (operator == "==") == holds:
            expr, constant = (left, right) if is_constant(right) else (right, left)
            return _equal(expr, constant, type_of) if is_constant(constant) else {}
        case Path(side="wire"):
            return {condition: Literal(holds, condition.span)}
        case _:
            return {}


def _equal(expr: Expr, constant: Expr, type_of: TypeOf) -> dict[Field, Expr]:
    if len(fields_in(expr)) != 1 or condition_in(expr):
        return {}
    try:
        solution = solved(expr, folded(constant), type_of)
    except NoInverseError:
        return {}
    return {solution.place: solution.value}


def asked_of_holder(rule: When[Rule, Expr], type_of: TypeOf) -> Expr:
    """A condition that asks of the holder what is there on the wire: the one block has a relation between the two, the other has none."""
    pairs: dict[Expr, Path] = {}
    for block, other in ((rule.then, rule.otherwise), (rule.otherwise, rule.then)):
        taken = _places(other)
        for each in block:
            match each:
                case Relation(Path() as place, value) if place not in taken and not fields_of(place, "wire"):
                    fields = fields_of(value, "wire")
                    pairs |= {fields[0]: place} if len(fields) == 1 and may_be_absent(place, type_of) else {}
                case _:
                    pass
    return _in_holder(rule.condition, pairs)


def _in_holder(expr: Expr, pairs: dict[Expr, Path]) -> Expr:
    match expr:
        case Call("has", (path,)) if path in pairs:
            return replace(expr, arguments=(pairs[path],))
        case Call("has"):
            return expr
        case _:
            return rebuilt(expr, lambda part: _in_holder(part, pairs))


def test_between(then: tuple[Rule, ...], otherwise: tuple[Rule, ...], type_of: TypeOf) -> Expr | None:
    """What holds of a holder of the first block and of none of the second; None where nothing does."""
    return _by_constants(then, otherwise) or presence_between(then, otherwise, type_of)


def _by_constants(then: tuple[Rule, ...], otherwise: tuple[Rule, ...]) -> Expr | None:
    for place in _places(then):
        of_then, of_otherwise = _constants(then, place), _constants(otherwise, place)
        if of_then is None or of_otherwise is None or not _differ(of_then, of_otherwise):
            continue
        fewer, is_of_then = (of_then, True) if len(of_then) <= len(of_otherwise) else (of_otherwise, False)
        if 0 < len(fewer) <= MAX_TESTED:
            test = _one_of(place, sorted(fewer, key=repr))
            return test if is_of_then else Unary("not", test, test.span)
    return None


def _one_of(place: Field, constants: list[Literal | Name]) -> Expr:
    first, *others = (Binary("==", place, constant, constant.span) for constant in constants)
    test: Expr = first
    for other in others:
        test = Binary("or", test, other, other.span)
    return test


def _places(rules: tuple[Rule, ...]) -> list[Field]:
    """The places of the holder that relations of a block name, once each."""
    found: list[Field] = []
    for rule in rules:
        match rule:
            case Relation((Path() | Len()) as place) if not fields_of(place, "wire"):
                found.append(place)
            case When(_, then, otherwise):
                found += _places((*then, *otherwise))
            case _:
                pass
    return list(dict.fromkeys(found))


def _constants(rules: tuple[Rule, ...], place: Field) -> Constants | None:
    """The constants that a block gives a place; None where it may give it anything else."""
    for rule in rules:
        match rule:
            case Relation(found, value) if found == place:
                return _values(value)
            case When(_, then, otherwise):
                parts = [_constants(block, place) for block in (then, otherwise)]
                known = [part for part in parts if part is not None]
                if len(known) == 2:
                    return known[0] | known[1]
            case Reject():
                return frozenset()
            case _:
                pass
    return None


def _values(value: Expr) -> Constants | None:
    """The constants that an expression is one of."""
    known = folded(value)
    if isinstance(known, Literal | Name):
        return frozenset((known,))
    if not isinstance(value, Choice):
        return None
    if subject_of(value) is None and condition_in(value) is None:
        return None
    parts = [_values(chosen) for _, chosen in value.cases] + ([] if value.otherwise is None else [_values(value.otherwise)])
    known_parts = [part for part in parts if part is not None]
    return frozenset[Literal | Name]().union(*known_parts) if len(known_parts) == len(parts) else None


def _differ(left: Constants, right: Constants) -> bool:
    """Whether no constant is in both: names with other names alone, and values with other values."""
    both = left | right
    alike = all(isinstance(each, Name) for each in both) or all(isinstance(each, Literal) for each in both)
    last = [{each.name.rpartition(".")[2] if isinstance(each, Name) else each.value for each in part} for part in (left, right)]
    return alike and not (last[0] & last[1])
