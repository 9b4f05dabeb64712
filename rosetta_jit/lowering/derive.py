"""Rules for both directions as rules for each.

`.a <-> f(.b)` unpacks as `.a = f(.b)`, and packs as `.b = f⁻¹(.a)`. A relation whose wire side has no field, or only fields that other
relations set, packs as a check. Where a loop's bounds name fields of the wire, packing has what the relations say of them. `ignore .b`
and `default .a` are each other's reverse.
"""

from __future__ import annotations

from dataclasses import field, replace
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.dataclass import dataclass
from rosetta_jit.lowering.calls import TOLD
from rosetta_jit.lowering.inverse import NoInverseError, calls_in, fields_in, reads_in_index, replaced, solve
from rosetta_jit.model.expr import Binary, Len, Path
from rosetta_jit.model.mapping import Assign, Default, For, Ignore, Reject, Relation, SameNames, SetLength, When
from rosetta_jit.model.printer import show_expr

if TYPE_CHECKING:
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.model.expr import Expr
    from rosetta_jit.model.mapping import Mapping, Rule


def derive(mapping: Mapping, problems: list[Diagnostic]) -> Mapping:
    """The mapping with each direction's rules complete, those of its own block behind those for both."""
    if mapping.rules is None:
        return mapping
    pack = _Packing(problems)
    pack.learn(mapping.rules)
    return replace(
        mapping,
        unpack_rules=(*_unpacking(mapping.rules), *(mapping.unpack_rules or ())),
        pack_rules=(*pack.rules(mapping.rules), *(mapping.pack_rules or ())),
    )


def _unpacking(rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
    return tuple(map(_unpacked, rules))


def _unpacked(rule: Rule) -> Rule:
    match rule:
        case Relation(Len(place), value, span):
            return SetLength(place, value, span)
        case Relation(Path() as place, value, span, via):
            return Assign(place, value, span, via=via)
        case For(body=body):
            return replace(rule, body=_unpacking(body))
        case _:
            return rule


@dataclass(slots=True)
class _Packing:
    """What the relations say of the wire's fields, and which relation sets each."""

    problems: list[Diagnostic]
    known: dict[Path | Len, Expr] = field(default_factory=dict["Path | Len", "Expr"])
    setters: dict[Path | Len, Relation] = field(default_factory=dict["Path | Len", "Relation"])

    def learn(self, rules: tuple[Rule, ...]) -> None:
        """A field is set by the first relation that has no other; a relation of one field is preferred to one of several."""
        for rule in rules:
            if isinstance(rule, For):
                self.learn(rule.body)
            elif isinstance(rule, Relation) and len(fields_in(rule.value)) == 1:
                self.solve(rule)

    def solve(self, rule: Relation) -> None:
        try:
            solution = solve(rule.value, rule.place)
        except NoInverseError as error:
            self.problems.append(words.no_inverse(error.part.span, str(error), rule.span))
            return
        if solution.place not in self.setters:
            self.setters[solution.place] = rule
            self.known[solution.place] = solution.value
        if isinstance(rule.place, Path) and isinstance(rule.value, Path):
            self.known.setdefault(Len(rule.value), Len(rule.place, rule.span))  # arrays that are equal have equal lengths

    def rules(self, rules: tuple[Rule, ...]) -> tuple[Rule, ...]:
        return tuple(found for rule in rules for found in self.rule(rule))

    def rule(self, rule: Rule) -> tuple[Rule, ...]:
        match rule:
            case For(start=start, stop=stop, body=body):
                bounds = {"start": replaced(start, self.known), "stop": replaced(stop, self.known)}
                missing = [found for bound in bounds.values() for found in fields_in(bound) if _side(found) == "wire"]
                if missing:
                    self.problems.append(words.unknown_bound(missing[0].span))
                    return ()
                return (replace(rule, body=self.rules(body), **bounds),)
            case Relation():
                return self.relation(rule)
            case Ignore(place, span):
                return (Default(place, span),)
            case Default(place, span):
                return (Ignore(place, span),)
            case SameNames(but, span):
                return (SameNames(tuple(replace(path, side="wire") for path in but), span),)
            case _:
                raise AssertionError(rule)

    def relation(self, rule: Relation) -> tuple[Rule, ...]:
        place = rule.place.path if isinstance(rule.place, Len) else rule.place
        fields = fields_in(rule.value)
        if (told := next((call for call in calls_in(rule.value) if call.function in TOLD), None)) is not None:
            self.problems.append(words.changes(told.span, told.function))
            return ()
        for path in (place, *(each.path if isinstance(each, Len) else each for each in fields)):
            if (read := reads_in_index(path)) is not None:
                self.problems.append(words.index_reads(read))
                return ()
        target = next((each for each in fields if self.setters.get(each) is rule), None)
        if target is not None:
            return _setting(target, self.known[target], rule)
        if len(fields) == 1 and fields[0] not in self.setters:
            return ()  # reported when it was learnt
        wanted = replaced(rule.value, self.known)
        if any(_side(each) == "wire" for each in fields_in(wanted)):
            self.problems.append(words.several_fields(rule.value.span))
            return ()
        reason = words.disagrees(show_expr(rule.place), show_expr(wanted))
        return (When(Binary("!=", rule.place, wanted, rule.span), (Reject(reason, rule.span),), (), rule.span),)


def _setting(target: Path | Len, value: Expr, rule: Relation) -> tuple[Rule, ...]:
    if isinstance(target, Len):
        return (SetLength(target.path, value, rule.span),)
    return (Assign(target, value, rule.span, fits=True, via=rule.via),)


def _side(place: Path | Len) -> str:
    return place.path.side if isinstance(place, Len) else place.side
