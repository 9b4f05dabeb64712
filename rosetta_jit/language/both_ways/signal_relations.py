"""Relations to signals of one frame: `.speed <-> signal(.data, "7|16@0+") * 0.01` and its like together say what `.data` is.

Packing writes all bits of the frame: those of no relation are 0. It has as many bytes as its type says, or else as few as have all signals.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.both_ways.inverse import NoInverseError, Solution, fields_in, may_round, named, solve
from rosetta_jit.language.both_ways.inverse_parts import until
from rosetta_jit.language.signal_bits import MOST_BITS, Signal, signal_of
from rosetta_jit.model.expr import Call, Expr, Literal, Nearest
from rosetta_jit.model.mapping import Reject, Relation, Rule, When
from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float
from rosetta_jit.model.walk import fields_of, parts
from rosetta_jit.startup.dataclass import dataclass

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways.inverse import TypeOf
    from rosetta_jit.language.both_ways.joint_relations import Related


@dataclass(frozen=True, slots=True)
class Frame:
    """Bytes, and the relations to the signals in them."""

    whole: Expr
    relations: tuple[Related, ...]

    def solved(self, type_of: TypeOf) -> Solution:
        """The bytes that have these signals; raises NoInverseError."""
        size = self.length(type_of)
        arguments: list[Expr] = [Literal(size, self.whole.span)]
        for rule, _ in self.relations:
            call = signal_in(rule)
            assert call is not None
            arguments += [call.arguments[1], _number(rule, call, type_of)]
        return solve(self.whole, Call("signal_bytes", tuple(arguments), self.whole.span), type_of)

    def length(self, type_of: TypeOf) -> int:
        """How many bytes the frame has; raises NoInverseError."""
        type_ = type_of(self.whole)
        length = type_.length if isinstance(type_, Array | Bytes) else None
        signals = [_signal(call) for rule, _ in self.relations if (call := signal_in(rule)) is not None]
        known = [each.size for each in signals if each is not None]
        if len(known) < len(self.relations):
            raise NoInverseError(self.whole, "its signals are not known")
        return length if isinstance(length, int) else max(known)

    @property
    def refused(self) -> tuple[tuple[Expr, str], ...]:
        """None: packing gives every message back."""
        return ()


def frames_of(relations: list[Related]) -> list[Frame]:
    """The frames in which relations name signals."""
    found: dict[object, list[Related]] = {}
    for rule, loops in relations:
        call = signal_in(rule)
        if call is not None:
            found.setdefault((call.arguments[0], loops), []).append((rule, loops))
    frames: list[Frame] = []
    for related in found.values():
        call = signal_in(related[0][0])
        assert call is not None
        frames.append(Frame(call.arguments[0], tuple(related)))
    return frames


def told_in_all(rule: When[Rule, Expr], type_of: TypeOf) -> dict[Call, Expr]:
    """What the signals of a condition must be, of which each block has the same relation; one that only refuses needs none."""
    found: dict[Call, Expr] = {}
    signals = {part for part in parts(rule.condition) if isinstance(part, Call) and part.function == "signal"}
    blocks = [block for block in _blocks(rule) if not (block and all(isinstance(each, Reject) for each in block))]
    for call in signals:
        relations = [{each for each in block if isinstance(each, Relation) and signal_in(each) == call} for block in blocks]
        shared = set[Relation]().union(*relations)
        if len(shared) == 1 and all(relations):
            (relation,) = shared
            signal = signal_in(relation)
            assert signal is not None
            found[call] = until(relation.value, relation.place, signal, type_of)
    return found


def _blocks(rule: When[Rule, Expr]) -> Iterator[tuple[Rule, ...]]:
    """The blocks of a `when`, and of those that stand alone in its other one."""
    yield rule.then
    match rule.otherwise:
        case (When() as other,):
            yield from _blocks(other)
        case block:
            yield block


def signal_in(rule: Relation) -> Call | None:
    """The signal that a relation reads, where its frame is the only field."""
    if len(fields_in(rule.value)) != 1 or fields_of(rule.place, "wire"):
        return None
    found = (each for each in parts(rule.value) if isinstance(each, Call) and each.function == "signal" and len(each.arguments) == 2)
    return next((each for each in found if isinstance(each.arguments[1], Literal)), None)


def _signal(call: Call) -> Signal | None:
    described = call.arguments[1]
    found = signal_of(str(described.value)) if isinstance(described, Literal) else None
    return found if found is not None and 1 <= found.length <= MOST_BITS else None


def _number(rule: Relation, call: Call, type_of: TypeOf) -> Expr:
    """What a signal must be: the nearest integer where it is computed with floats, if the relation gives the same of it."""
    number, signal = until(rule.value, rule.place, call, type_of), _signal(call)
    type_ = type_of(number)
    if isinstance(type_, Float) and signal is not None and may_round(rule.value):
        return Nearest(number, named(rule.value, call), rule.place, signal.type, rule.span)
    return Call("int64", (number,), rule.span) if isinstance(type_, Bool | Enum) else number
