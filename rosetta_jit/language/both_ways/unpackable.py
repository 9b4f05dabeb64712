"""Why a relation cannot be packed."""

from __future__ import annotations

from rosetta_jit.catalogue import derive as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.both_ways.inverse import NoInverseError, solve
from rosetta_jit.language.both_ways.knowledge import Knowledge
from rosetta_jit.language.groups import group_of
from rosetta_jit.model.expr import Binary, Call, Expr, Item, Literal
from rosetta_jit.model.mapping import Relation
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.walk import Field, fields_of


def reason(rule: Relation, missing: list[Field], place: Expr, known: Knowledge, number: int) -> Diagnostic:
    """Why a relation, in which what is known of the wire has been replaced, cannot be packed."""
    shown = list(dict.fromkeys(show_expr(each) for each in missing))
    if fields_of(place, "wire"):
        return words.index_reads(fields_of(place, "wire")[0].span)
    if len(shown) > 1:
        return words.several_fields(rule.value.span, shown, known.unsolved.get(number, ""))
    try:
        solve(rule.value, rule.place, known.type_of)
    except NoInverseError as error:
        return words.no_inverse(error.part.span, str(error), rule.span, shown[0], _other_way(error.part))
    return words.index_reads(missing[0].span)


def _other_way(part: Expr) -> str:
    """How an expression that cannot be turned round is written so that it can."""
    match part:
        case Binary("==", value, Literal(1)) if type(part.right) is Literal:
            return words.bit_of(show_expr(value))
        case Item(Call() as call) if (group := group_of(call)) is not None:
            return words.all_numbers(show_expr(call), [each.names[0] for each in group.components])
        case _:
            return ""
