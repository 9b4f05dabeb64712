"""One direction after the other: what each rule of the second gives, as expressions of what the first one read.

The first direction is followed along each of its execution paths. Its rules say what the places between have; what it rejects, and the
conditions of the path, are known. The second direction then decides its own conditions, as far as they follow.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rosetta_jit.language.algebra.equality import (
    Ranges,
    has_local,
    own_part,
    reads_other,
    same_number,
    same_place,
    same_ranges,
    unify,
)
from rosetta_jit.language.laws.byte_views import byte_of, number_of
from rosetta_jit.language.laws.key_lookup import number_found
from rosetta_jit.language.laws.loop_orders import round_of
from rosetta_jit.language.laws.refusals import may_refuse
from rosetta_jit.language.laws.simplest import simplest
from rosetta_jit.language.laws.truths import Truths
from rosetta_jit.language.laws.whole_texts import whole_text
from rosetta_jit.language.laws.writes import Write, changed, is_left_absent, is_part_of, is_within, union_depths, writes_of
from rosetta_jit.language.limits import MAX_LOOKED, MAX_ORDERED
from rosetta_jit.language.places import field_names
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import (
    BOOL,
    Access,
    Assign,
    Call,
    Const,
    Default,
    Expr,
    FieldStep,
    For,
    Has,
    IndexStep,
    LenOf,
    Local,
    Place,
    Reject,
    Rule,
    Search,
    SetLength,
    When,
)
from rosetta_jit.language.walk import indices, placed, rebuilt, renamed
from rosetta_jit.model.expr import Literal, Side
from rosetta_jit.model.rules import Kept
from rosetta_jit.model.types import Array, Map, Struct, Union
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, replace

if TYPE_CHECKING:
    from rosetta_jit.language.laws.execution_paths import ExecutionPath


@dataclass(frozen=True, slots=True)
class Result:
    """What a place has when both directions are done, in loops over ``ranges``; None where that does not follow.

    ``may_be_refused`` is whether a conversion within the rule is not known to take all that came through the first direction.
    """

    place: Place
    is_length: bool
    value: Expr | None
    span: Span | None
    ranges: Ranges
    may_be_refused: bool = False


class Trip:
    """The second direction, run on what one execution path of the first one leaves.

    ``known`` is what its conditions say, ``by_round`` whether rounds of loops take different ways, ``left`` how many more rules are
    compared with other loops. ``refusals`` are the rejections of the text for which nothing shows that what came through the first
    direction passes them.
    """

    def __init__(self, path: ExecutionPath) -> None:
        self.writes: dict[tuple[str, ...], list[Write]] = {}
        self.rules = path.rules
        for write in writes_of(path.rules, ()):
            self.writes.setdefault(field_names(write.place), []).append(write)
        places = [found[0].place for found in self.writes.values()]
        self.origin: Side = "holder" if places and places[0].side == "wire" else "wire"
        self.known = Truths(self.origin)
        for condition, holds, ranges in path.known:
            self.known.know(condition, ranges, holds=holds)
        self.refused = False
        self.refusals: list[Reject[Expr]] = []
        self.by_round = any(has_local(condition) for condition, _, _ in path.known)
        self.left = MAX_ORDERED

    def run(self, rules: tuple[Rule, ...]) -> Iterator[Result]:
        for rule in rules:
            match rule:
                case Assign(place, value) | SetLength(place, value):
                    where = placed(place, self.of)
                    made = self.known.narrowed(self.of(changed(rule, value)))
                    yield Result(where, isinstance(rule, SetLength), made, rule.span, self.known.ranges, may_refuse(value, self.of))
                case Default(place):
                    yield Result(place, is_length=False, value=None, span=rule.span, ranges=self.known.ranges)
                case For(body=body, kept=Kept()):
                    for write in writes_of((rule,), self.known.ranges):
                        yield Result(write.place, write.is_length, write.value, rule.span, write.ranges)
                case For(_, start, stop, body):
                    around, self.known.ranges = self.known.ranges, (*self.known.ranges, (self.of(start), self.of(stop)))
                    yield from self.run(body)
                    self.known.ranges = around
                case When(condition, then, otherwise):
                    yield from self.when(self.of(condition), then, otherwise)
                case Reject():
                    self.refused = True
                case _:
                    pass

    def when(self, condition: Expr, then: tuple[Rule, ...], otherwise: tuple[Rule, ...]) -> Iterator[Result]:
        match condition:
            case Const(bool(holds)):
                yield from self.run(then if holds else otherwise)
            case _ if all(isinstance(rule, Reject) for rule in then):
                self.refusals += [rule for rule in then if isinstance(rule, Reject) and rule.written]
                self.known.know(condition, self.known.ranges, holds=False)
                yield from self.run(otherwise)
            case _ if otherwise and all(isinstance(rule, Reject) for rule in otherwise):
                self.refusals += [rule for rule in otherwise if isinstance(rule, Reject) and rule.written]
                self.known.know(condition, self.known.ranges, holds=True)
                yield from self.run(then)
            case Has(place) if not otherwise and all(is_part_of(write.place, place) for write in writes_of(then, ())):
                known = dict(self.known.truths)
                self.known.know(condition, self.known.ranges, holds=True)  # where it is not there, nothing is set, and nothing lost
                yield from self.run(then)
                self.known.truths = known
            case _:
                for write in writes_of((*then, *otherwise), ()):
                    yield Result(write.place, is_length=False, value=Local("?"), span=None, ranges=self.known.ranges)

    # --- expressions ---------------------------------------------------------------------------------------------------

    def of(self, expr: Expr) -> Expr:
        """An expression of the places between, as one of what the first direction read."""
        match expr:
            case Access(place):
                return self.read(replace(expr, place=placed(place, self.of)), length=False)
            case LenOf(place):
                return self.read(replace(expr, place=placed(place, self.of)), length=True)
            case Has(place) if (is_there := self.is_there(placed(place, self.of))) is not None:
                return Const(is_there, BOOL)
            case Search(place) if (number := number_found(expr, self.of(LenOf(place)), self.of, self.setters)) is not None:
                return number
            case Call() if (number := number_of(expr, self.of, lambda byte: self.read(byte, length=False))) is not None:
                return number
            case _:
                return self.simple(rebuilt(expr, self.of))

    def read(self, expr: Access | LenOf, *, length: bool) -> Expr:
        """What the first direction gave a place."""
        place = expr.place
        last = place.steps[-1] if place.steps else None
        if isinstance(last, FieldStep) and isinstance(last.field.constant, Literal):
            return Const(last.field.constant.value, place.type)
        names = field_names(place)
        found = list(self.matching(names, place, length=length)) or list(self.ordered(names, place, length=length))
        if len(found) == 1:
            return self.simple(found[0])
        for count in range(len(names) if not found else 0, 0, -1):
            around = [self.around(place, write) for write in self.writes.get(names[:count], []) if not write.is_length]
            inner = [each for each in around if each is not None]
            if len(inner) == 1:
                return LenOf(inner[0]) if length else Access(inner[0], place.type)
        return expr

    def setters(self, place: Place) -> int:
        """How many rules of the first direction set a field, in whichever elements."""
        return sum(not write.is_length for write in self.writes.get(field_names(place), []))

    def is_there(self, place: Place) -> bool | None:
        """Whether the first direction sets a place, or a number or text in it, or leaves it absent; None where that does not follow."""
        names = field_names(place)
        if not isinstance(place.type, Array | Struct | Union | Map) and list(self.matching(names, place, length=False)):
            return True
        if any(is_within(write, place) for found in self.writes.values() for write in found):
            return True
        return False if place.side != self.origin and is_left_absent(place, self.rules) else None

    def is_absent(self, names: tuple[str, ...], message: Message, *, in_rounds: bool = False) -> bool:
        """Whether a place is known not to be there, or another case of its union is; or that of an element, in some rounds of loops."""
        for condition, (holds, ranges) in self.known.truths.items():
            if isinstance(condition, Has) and bool(ranges) == in_rounds and condition.place.side == self.origin:
                subject = field_names(condition.place)
                unions = union_depths(condition.place, message)
                if not holds and names[: len(subject)] == subject:
                    return True
                if holds and any(subject[:size] == names[:size] and subject[size : size + 1] != names[size : size + 1] for size in unions):
                    return True
        return False

    def matching(self, names: tuple[str, ...], place: Place, *, length: bool) -> Iterator[Expr]:
        alike: list[tuple[Write, Expr]] = []
        for write in self.writes.get(names, [])[:MAX_LOOKED]:
            bound: dict[str, Expr] = {}
            if write.is_length == length and (unify(write.place.steps, place.steps, bound) or self.alike(write.place, place, bound)):
                alike.append((write, renamed(write.value, bound)))
        # Where several loops set such an element, it is the one over the same numbers that sets this.
        mine = [each for each in alike if same_ranges(each[0].ranges, self.known.ranges)] if len(alike) > 1 else alike
        yield from (value for _, value in mine)

    def ordered(self, names: tuple[str, ...], place: Place, *, length: bool) -> Iterator[Expr]:
        """What loops that run in another order set an element to."""
        side: Side = "wire" if place.side == "holder" else "holder"
        bounds = [each for bounds in self.known.ranges for each in bounds]
        if self.by_round or any(reads_other(each, side) for each in (*indices(place), *bounds)):
            return
        facts = self.known.facts(side)
        for write in self.writes.get(names, []):
            if write.is_length == length and self.left > 0:
                self.left -= 1
                bound = round_of(write.place, write.ranges, place, self.known.ranges, facts)
                if bound is not None:
                    yield renamed(write.value, bound)

    def is_same(self, value: Expr, goal: Access | LenOf) -> bool:
        """Whether a value is what lies at a place, whatever its indices look like."""
        side = goal.place.side
        if reads_other(value, side):
            return False
        facts = self.known.facts(side)
        return same_place(value, goal, facts) or same_number(value, goal, facts)

    def towards(self, value: Expr, goal: Access | LenOf) -> Expr:
        """A value, with the place that it is to come back to named as there."""
        if isinstance(value, Access):
            return goal if self.is_same(value, goal) else value
        return rebuilt(value, lambda part: self.towards(part, goal))

    @staticmethod
    def alike(write: Place, place: Place, bound: dict[str, Expr]) -> bool:
        """Whether a place is the one that a rule sets in the round of the same number, whatever their indices look like."""
        side: Side = "wire" if write.side == "holder" else "holder"
        pairs = [
            (a.index, b.index)
            for a, b in zip(write.steps, place.steps, strict=False)
            if isinstance(a, IndexStep) and isinstance(b, IndexStep)
        ]
        bound.clear()
        return len(write.steps) == len(place.steps) and all(same_number(a, b) and not reads_other(b, side) for a, b in pairs)

    def around(self, place: Place, write: Write) -> Place | None:
        """A place within one that was assigned as a whole, where it came from."""
        bound: dict[str, Expr] = {}
        size = len(write.place.steps)
        if not isinstance(write.value, Access) or size > len(place.steps) or not unify(write.place.steps, place.steps[:size], bound):
            return None
        source = renamed(write.value, bound)
        assert isinstance(source, Access)
        type_ = place.type if place.steps[size:] else source.place.type  # its own: types of two frameworks are spelled differently
        return replace(source.place, steps=(*source.place.steps, *place.steps[size:]), type=type_)

    def simple(self, expr: Expr) -> Expr:
        """An expression in place of which something simpler can stand."""
        if (known := self.known.truth(expr)) is not None:
            return Const(known, BOOL)
        found = simplest(expr, self.own_part)
        if isinstance(found, Call):
            return byte_of(found) or (found.function == "+" and whole_text(found, self.known.equal_to)) or found
        return found

    def own_part(self, expr: Expr) -> Expr | None:
        """The part of an integer that it is the same as."""
        return None if reads_other(expr, self.origin) else own_part(expr, lambda: self.known.facts(self.origin))
