"""What rules of a mapping with several wires need: which wires each reads, and at whose messages the rules of a field run."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rosetta_jit.language.check.across_wires import (
    Wires,
    asked_for,
    runs_at,
    wire_of,
    wires_read,
)
from rosetta_jit.language.places import places_in, shown_place
from rosetta_jit.language.scope import Message
from rosetta_jit.language.typed import Assign, Default, Expr, FieldStep, For, Ignore, Place, Rule, SetLength, When
from rosetta_jit.language.walk import expressions_of
from rosetta_jit.model.expr import Side
from rosetta_jit.model.recursive_structs import recursive_structs
from rosetta_jit.model.types import Ref, Struct
from rosetta_jit.startup.dataclass import dataclass, replace

Names = tuple[str, ...]
NO_WIRE: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Needs:
    """What a rule says, with the blocks around it.

    Attributes
    ----------
    read
        The wires that it reads; of a rule to pack, the one that it sets.
    exprs
        What it computes.
    arrivals
        All wires, of a rule that asks what has arrived: it runs at messages of any.
    """

    read: Wires = NO_WIRE
    exprs: tuple[Expr, ...] = ()
    arrivals: Wires = NO_WIRE

    def within(self, rule: Rule, target: Side) -> Needs:
        """The same with one more rule."""
        places = [rule.place] if isinstance(rule, Assign | SetLength | Default | Ignore) else []
        exprs = own_expressions(rule) if target == "holder" else ()
        set_ = () if target == "wire" and isinstance(rule, Ignore) else tuple(map(wire_of, places))
        return Needs(self.read.union(wires_read(exprs), *set_), (*self.exprs, *exprs))

    @property
    def wires(self) -> Wires:
        """The wires on whose messages it depends."""
        return self.read | self.arrivals

    @property
    def runs_at(self) -> Wires:
        """The wires at whose messages the rule runs; none of one that runs at all of them, or at none."""
        return self.wires if len(self.wires) < 2 else runs_at(self.exprs, self.wires)

    @property
    def waits_for(self) -> Wires:
        """The wires that must have sent a message before the rule runs."""
        return self.read - asked_for(self.exprs)


NOTHING_AROUND = Needs()


def with_needs(rules: tuple[Rule, ...], target: Side) -> list[tuple[Rule, Needs]]:
    """Each rule that is no block, of all of a direction, with what it reads."""
    found = list(_walked(rules, target))
    every = NO_WIRE.union(*(needs.read for _, needs in found))
    return [(rule, replace(needs, arrivals=every) if asked_for(needs.exprs) else needs) for rule, needs in found]


def _walked(rules: tuple[Rule, ...], target: Side, around: Needs = NOTHING_AROUND, *, chosen: bool = False) -> Iterator[tuple[Rule, Needs]]:
    """Each rule that is no block, with what it reads; the conditions and bounds of the blocks around it count.

    Rules of one place that conditions choose among, ``chosen`` ones, are as one: each of them reads what all of them read.
    """
    for rule in rules:
        within = around.within(rule, target)
        match rule:
            case For(body=body):
                yield from _walked(body, target, within, chosen=chosen)
            case When(then=then, otherwise=otherwise):
                inner = _walked((*then, *otherwise), target, within, chosen=True)
                yield from inner if chosen else _as_one(list(inner))
            case _:
                yield rule, within


def _as_one(chosen: list[tuple[Rule, Needs]]) -> Iterator[tuple[Rule, Needs]]:
    together: dict[str, tuple[Wires, dict[int, Expr]]] = {}
    for rule, needs in chosen:
        for place in places_in((rule,)):
            wires, exprs = together.get(shown_place(place.steps), (NO_WIRE, dict[int, "Expr"]()))
            together[shown_place(place.steps)] = wires | needs.read, exprs | {id(each): each for each in needs.exprs}
    for rule, needs in chosen:
        found = [together[shown_place(place.steps)] for place in places_in((rule,))]
        yield rule, Needs(found[0][0], tuple(found[0][1].values())) if found else needs


def own_expressions(rule: Rule) -> tuple[Expr, ...]:
    """The expressions that a rule computes itself, and how many rounds of a loop are kept."""
    count = rule.kept.count if isinstance(rule, For) and rule.kept is not None else None
    return (*expressions_of(rule), *(() if count is None else (count,)))


def owners_of(rules: tuple[Rule, ...], cut: Callable[[Place], Names]) -> dict[Names, frozenset[Wires]]:
    """The wires at whose messages the rules of each field run, as far as it is no message, or one that can contain itself.

    All rules of most fields run at messages of the same wires; a field whose rules do not has several sets of wires.
    """
    found: dict[Names, frozenset[Wires]] = {}
    for rule, needs in with_needs(rules, "holder"):
        for place in places_in((rule,)):
            names = cut(place)
            found[names] = found.get(names, frozenset[Wires]()) | ({needs.runs_at} if needs.wires else frozenset[Wires]())
    return found


def cutter(holder: Message) -> Callable[[Place], Names]:
    """What gives the way to a place up to the first field that has a lane of its own, is one of several cases, or is a number."""
    recursive = recursive_structs(Ref(holder.root.name), holder.schema)

    def cut(place: Place) -> Names:
        names: list[str] = []
        for step in place.steps:
            if not isinstance(step, FieldStep):
                break
            names.append(step.field.name)
            type_ = holder.value_type(step.field.type)
            if not isinstance(type_, Struct) or type_.name in recursive:
                break
        return tuple(names)

    return cut
