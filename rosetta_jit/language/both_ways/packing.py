"""The rules to pack that follow from rules for both directions.

A relation sets the one field of the wire that it has and that no relation before it sets; one whose fields are all known is a check: a
holder that nothing could have been unpacked to is rejected. Loops and conditions that read the wire have what is known of it. Where a
condition cannot be known, its two blocks are told apart by constants (`language.both_ways.branches`). What `pack-rules:` sets is left to
them.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import derive as words
from rosetta_jit.catalogue import groups, layouts
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.language.both_ways.array_relations import with_layouts
from rosetta_jit.language.both_ways.branches import asked_of_holder, facts_of, test_between
from rosetta_jit.language.both_ways.checks import agreement, checks_of, guard
from rosetta_jit.language.both_ways.inverse import condition_in, fields_in
from rosetta_jit.language.both_ways.knowledge import Knowledge, Loop, Loops, key_of
from rosetta_jit.language.both_ways.learning import learn
from rosetta_jit.language.both_ways.named_fields import fields_in_rules, is_among, set_by
from rosetta_jit.language.both_ways.presence import asks_presence, flag_of, presence_between, told_by_setting
from rosetta_jit.language.folding import folded
from rosetta_jit.language.groups import group_of
from rosetta_jit.language.installed import written
from rosetta_jit.language.limits import MAX_BLOCKS
from rosetta_jit.model.element_rules import ignored_elements, ignoring
from rosetta_jit.model.expr import Binary, Call, Coerced, Expr, Len, List, Literal, Path
from rosetta_jit.model.mapping import (
    Arranged,
    Assign,
    Default,
    For,
    Ignore,
    Reject,
    Relation,
    Rest,
    Rule,
    SameNames,
    SetLength,
    SetState,
    Several,
    Way,
    When,
)
from rosetta_jit.model.printer import show_expr
from rosetta_jit.model.types import Float
from rosetta_jit.model.walk import Field, fields_of, parts, path_of
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import dataclass, field, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language.both_ways import unpackable
    from rosetta_jit.language.both_ways.inverse import TypeOf
else:
    unpackable = Late("rosetta_jit.language.both_ways.unpackable")


NOTHING: Mapping[Field, Expr] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class _Owed:
    """That the condition of a `when` holds of the message that a block packs, or that it does not."""

    rule: When[Rule, Expr]
    holds: bool


@dataclass(frozen=True, slots=True)
class _Block:
    """The rules of a block, and the conditions that it could not check."""

    rules: tuple[Rule, ...]
    owed: tuple[_Owed, ...]


@dataclass(slots=True)
class Packing:
    """Turns one block round after another, each with what is known around it."""

    problems: list[Diagnostic]
    known: Knowledge
    completed: frozenset[tuple[str, ...]]
    assigned: frozenset[tuple[str, ...]]
    owed: tuple[_Owed, ...] = ()
    is_chained: bool = False
    """Whether the block is all that a `when` leaves whose blocks are told apart by what is there."""
    blocks: list[Relation] = field(default_factory=list["Relation"])
    written: Mapping[Field, Expr] = field(default_factory=lambda: NOTHING)
    is_outermost: bool = True
    """Whether the block is in no `when`."""

    @classmethod
    def of(cls, pack_rules: tuple[Rule, ...], type_of: TypeOf, problems: list[Diagnostic]) -> Packing:
        """``pack_rules`` are those of the direction's own block."""
        written: dict[Field, Expr] = {rule.place: rule.value for rule in pack_rules if isinstance(rule, Assign)}
        completed, assigned = (frozenset(set_by(pack_rules, lengths=lengths)) for lengths in (True, False))
        return cls(problems, Knowledge(type_of), completed, assigned, written=written)

    def block(self, rules: tuple[Rule, ...], loops: Loops) -> tuple[Rule, ...]:
        """The rules of a block, when all of its relations are known."""
        learn(self.known, rules, loops, self.is_assigned)
        found = self.rules(rules, loops)
        if self.known.budget.parts < 0:
            self.problems.append(words.too_complex(rules[0].span))
            return ()  # what was found is too large to be looked at, too
        return found

    # --- rules ---------------------------------------------------------------------------------------------------------

    def rules(self, rules: tuple[Rule, ...], loops: Loops) -> tuple[Rule, ...]:
        return tuple(found for rule in rules for found in self.rule(rule, loops))

    def rule(self, rule: Rule, loops: Loops) -> tuple[Rule, ...]:
        match rule:
            case For():
                return self.loop(rule, loops)
            case Relation():
                return self.relation(rule, loops)
            case When(condition, (Reject() as refusal,), ()):
                known, then = self.known.replaced(condition, loops), (self.refusal(refusal, loops),)
                return () if self.is_unknown(known, rule.condition) else (replace(rule, condition=known, then=then),)
            case When():
                return self.when(rule, loops)
            case Reject():
                return (self.refusal(rule, loops),)
            case Ignore(place, span):
                return (Default(place, span),)
            case Default(place, span):
                return (ignoring(place, span),)
            case Arranged():
                return self.arranged(rule, loops)
            case Rest(word, span):
                return (Rest("default" if word == "ignore" else "ignore", span),)
            case SameNames(but, span, renames=renames):
                turned = tuple(replace(each, place=each.value, value=each.place) for each in renames)
                return (SameNames(tuple(replace(path, side="wire") for path in but), span, both=True, renames=turned),)
            case Assign() | SetLength() | SetState() | Several():
                raise AssertionError(rule)

    def loop(self, rule: For[Rule, Expr], loops: Loops) -> tuple[Rule, ...]:
        start, stop = (self.known.replaced(bound, loops) for bound in (rule.start, rule.stop))
        missing = [*fields_of(start, "wire"), *fields_of(stop, "wire")]
        if missing:
            if self.is_outermost and not loops and (place := ignored_elements(rule)) is not None:
                return (Default(place, rule.span),)
            if not all(self.is_completed(place) for place in fields_in_rules(rule.body)):
                self.problems.append(words.unknown_bound(missing[0].span))
            return ()
        body = self.rules(rule.body, (*loops, Loop(rule.variable, rule.start, rule.stop)))
        return (replace(rule, start=start, stop=stop, body=body),) if body else ()

    def relation(self, rule: Relation, loops: Loops) -> tuple[Rule, ...]:
        changing = next((part for part in parts(rule.value) if isinstance(part, Call) and _changes(part)), None)
        if changing is not None:
            self.problems.append(words.changes(changing.span, changing.function))
            return ()
        place = with_known_indices(rule.place, self.known, loops)
        if isinstance(flag := flag_of(rule), tuple) and self.known.flag(flag[1], loops) is not None:
            is_there = told_by_setting(rule.value, self.known, (), loops)
            return agreement(place, is_there, rule) if isinstance(is_there, Literal) else ()
        fields = fields_in(rule.value)
        targets = [each for each in fields if self.known.setters.get(key_of(each, loops)[0], (None,))[0] is rule]
        beside = self.known.beside.get(id(rule))
        checks = () if beside is None or (targets and beside.side == "wire") else checks_of(beside)
        if beside is not None and beside.is_asked:
            checks = (*checks, *agreement(place, self.known.replaced(rule.value, loops), rule))
        if targets:
            return (*checks, *(found for target in targets for found in self.setting(target, loops, rule)))
        if beside is not None:
            return checks
        wanted = self.known.replaced(rule.value, loops)
        missing = [*fields_of(wanted, "wire"), *fields_of(place, "wire")]
        if not missing and group_of(wanted) is not None:
            self.problems.append(groups.compared(rule.span))
            return ()
        if not missing:
            return agreement(place, wanted, rule)
        conditional = condition_in(rule.value)
        if conditional is not None and not fields_of(place, "wire"):
            return self.split(rule, conditional, loops)
        if not all(map(self.is_completed, missing)):
            self.problems.append(unpackable.reason(replace(rule, value=wanted), missing, place, self.known, id(rule)))
        return ()

    def setting(self, target: Field, loops: Loops, rule: Relation) -> tuple[Rule, ...]:
        """The rule that sets a field of the wire, at a place that packing can find."""
        place = self.known.placed(path_of(target), loops)
        missing = fields_of(place, "wire")[1:]
        if missing:
            self.problems.append(words.index_reads(missing[0].span))
            return ()
        return self.set_to(place, target, self.known.setters[key_of(target, loops)[0]][1], rule)

    def set_to(self, place: Path, target: Field, value: Expr, rule: Relation) -> tuple[Rule, ...]:
        value = with_layouts(value, self.written)
        unknown = fields_of(value, "wire")
        if unknown:
            self.problems.append(words.unknown_layout(unknown[0].span or rule.span, show_expr(unknown[0])))
            return ()
        return (_setting(place, value, rule.span, length=isinstance(target, Len), way=rule.via or "checked"),)

    def arranged(self, rule: Arranged, loops: Loops) -> tuple[Rule, ...]:
        """The flag says which of the layouts the holder has."""
        for column, repeated in zip(zip(*rule.cases, strict=True), (layouts.same_flag, layouts.same_order), strict=True):
            self.problems.extend(repeated(each.span) for number, each in enumerate(column) if each in column[:number])
        rest: tuple[Rule, ...] = (Reject(layouts.UNKNOWN_FLAG, rule.span),)
        for flag, value in reversed(rule.cases):
            inner = replace(self, known=self.known.inside())
            relation = Relation(rule.place, value, rule.span)
            inner.known.forget(fields_in(value), loops)
            learn(inner.known, (relation,), loops, self.is_assigned)
            rest = (When(Binary("==", rule.flag, flag, rule.span), inner.relation(relation, loops), rest, rule.span),)
        return rest

    def split(self, rule: Relation, ways: tuple[Expr, Expr, Expr], loops: Loops) -> tuple[Rule, ...]:
        """`.a <-> x if condition else y` as `when condition .a <-> x else .a <-> y end`."""
        self.blocks.append(rule)
        if len(self.blocks) > MAX_BLOCKS:
            self.problems.extend([words.too_many_blocks(rule.span, MAX_BLOCKS)] if len(self.blocks) == MAX_BLOCKS + 1 else [])
            return ()
        condition, *values = ways
        then, other = (replace(rule, value=value) for value in values)
        return self.when(When(condition, (then,), (other,), rule.span), loops)

    # --- conditions ----------------------------------------------------------------------------------------------------

    def when(self, rule: When[Rule, Expr], loops: Loops) -> tuple[Rule, ...]:
        question = asked_of_holder(rule, self.known.type_of)
        condition = self.known.replaced(question, loops)
        if not fields_of(condition, "wire"):
            by_flag = asks_presence(question, "wire")
            then, other = (
                self.branch(rule, loops, holds=holds) if by_flag and not _rejects(block) else self.enter(block, loops)
                for holds, block in ((True, rule.then), (False, rule.otherwise))
            )
            self.owe(then, other)
            return (When(condition, then.rules, other.rules, rule.span),)
        test = test_between(rule.then, rule.otherwise, self.known.type_of)
        is_chained = test is not None and asks_presence(test, "holder")
        then, other = (self.branch(rule, loops, holds=holds, is_chained=is_chained) for holds in (True, False))
        self.owe(then, other)
        if _rejects(rule.otherwise) or _rejects(rule.then):
            return self.unrefused(rule, other.rules if _rejects(rule.then) else then.rules, loops)
        if not then.rules and not other.rules:
            return ()
        if test is None:
            self.problems.append(words.alike_blocks(rule.condition.span, show_expr(fields_of(rule.condition, "wire")[0])))
            return ()
        return (When(test, tuple(each for each in then.rules if not _is_tested(each, test)), other.rules, rule.span),)

    def unrefused(self, rule: When[Rule, Expr], packed: tuple[Rule, ...], loops: Loops) -> tuple[Rule, ...]:
        """The block of a `when` whose other one rejects; behind blocks that were told apart by what is there, if it is of this one."""
        block, refusals = (rule.otherwise, rule.then) if _rejects(rule.then) else (rule.then, rule.otherwise)
        test = presence_between(block, (), self.known.type_of) if self.is_chained else None
        if test is None:
            return packed
        return (When(test, packed, tuple(self.refusal(each, loops) for each in refusals if isinstance(each, Reject)), rule.span),)

    def branch(self, rule: When[Rule, Expr], loops: Loops, *, holds: bool, is_chained: bool = False) -> _Block:
        """One block with what its condition says of the wire, where it cannot be known before the block is."""
        block = rule.then if holds else rule.otherwise
        if _rejects(block):
            return _Block((), ())
        owed = _Owed(rule, holds)
        facts = facts_of(rule.condition, self.known.type_of, holds=holds)
        found = replace(self, is_chained=is_chained and len(block) == 1).enter(block, loops, facts, owed)
        if any(each is owed for each in found.owed):
            missing = [each for each in fields_in(rule.condition) if self.known.value(each, loops) is None]
            if not all(map(self.is_completed, missing)):
                report = words.unsettled_presence if asks_presence(rule.condition, "wire") else words.undetermined
                self.problems.append(report(missing[0].span, show_expr(missing[0]), holds=holds))
        return found

    def enter(self, block: tuple[Rule, ...], loops: Loops, facts: Mapping[Field, Expr] = NOTHING, owed: _Owed | None = None) -> _Block:
        """A block, with the facts that it has set and the conditions that it is owed checked."""
        inner = replace(self, is_outermost=False, known=self.known.inside(), owed=self.owed if owed is None else (*self.owed, owed))
        learn(inner.known, block, loops, self.is_assigned)
        settings = [inner.fact(place, value, loops) for place, value in facts.items()]
        guards = inner.settle(block, loops)
        rules = inner.rules(block, loops)
        return _Block((*(each for each in settings if each is not None), *guards, *rules), inner.owed)

    def fact(self, place: Field, value: Expr, loops: Loops) -> Rule | None:
        """A field that a condition fixes, set unless something else does."""
        if self.known.value(place, loops) is not None or self.is_completed(place):
            return None
        self.known.learn(place, value, loops)
        return _setting(self.known.placed(path_of(place), loops), value, value.span, length=isinstance(place, Len))

    def settle(self, block: tuple[Rule, ...], loops: Loops) -> list[Rule]:
        """Checks that unpacking is going to take the blocks that this one is in, as far as that is known by now."""
        guards: list[Rule] = []
        left: list[_Owed] = []
        for owed in self.owed:
            other = owed.rule.otherwise if owed.holds else owed.rule.then
            settled = folded(told_by_setting(owed.rule.condition, self.known, block, loops, other=other))
            condition = folded(self.known.replaced(settled, loops))
            is_other_way = isinstance(settled, Literal) and settled.value is not owed.holds
            if fields_of(condition, "wire") or is_other_way:
                left.append(owed)
            else:
                guards += guard(condition, owed.rule, holds=owed.holds)
        self.owed = tuple(left)
        return guards

    def owe(self, *blocks: _Block) -> None:
        """What is left to check behind a `when`: what one of its blocks could not."""
        self.owed = tuple(owed for owed in self.owed if any(owed is each for block in blocks for each in block.owed))

    # --- what is missing -----------------------------------------------------------------------------------------------

    def refusal(self, rule: Reject[Expr], loops: Loops) -> Reject[Expr]:
        """A rejection with what is known of the values that its text shows; with the text alone, where that is not all."""
        pieces = tuple(self.known.replaced(piece, loops) for piece in rule.pieces)
        return replace(rule, pieces=() if any(fields_of(piece, "wire") for piece in pieces) else pieces)

    def is_unknown(self, known: Expr, written: Expr) -> bool:
        missing = fields_of(known, "wire")
        unknown = next((each for each in missing if not self.is_completed(each)), None)
        if unknown is not None:
            is_float = isinstance(self.known.type_of(unknown), Float)
            self.problems.append(words.unknown_condition(written.span, show_expr(unknown), is_float=is_float))
        return bool(missing)

    def is_completed(self, place: Field) -> bool:
        """Whether the rules to pack alone set a field, or something in it or around it."""
        return is_among(place, self.completed)

    def is_assigned(self, place: Field) -> bool:
        """The same, where a length alone does not count."""
        return is_among(place, self.assigned)


def _changes(call: Call) -> bool:
    """Whether a call gives another value for each message."""
    known = written(call.function)
    return known is not None and known.changes


def with_known_indices(place: Field | List, known: Knowledge, loops: Loops) -> Field | List:
    """A place of the holder, or several, whose indices packing can compute."""
    match place:
        case Len(path):
            return Len(known.placed(path, loops), place.span)
        case List(items):
            return replace(place, items=tuple(known.placed(each, loops) for each in items if isinstance(each, Path)))
        case Path():
            return known.placed(place, loops)


def _setting(place: Path, value: Expr, span: Span | None, *, length: bool, way: Way = "checked") -> Rule:
    return SetLength(place, value, span) if length else Assign(place, value, span, way)


def _is_tested(rule: Rule, test: Expr) -> bool:
    """Whether a check asks again what the `when` around it has asked."""
    match rule, test:
        case When(Binary("differs", place, Coerced(value=wanted)), (Reject(),), ()), Binary("==", tested, constant):
            return place == tested and folded(wanted) == constant and not _is_zero(constant)
        case _:
            return False


def _is_zero(constant: Expr) -> bool:
    """Whether it may be compared with a float that is -0, which equals it."""
    return isinstance(constant, Literal) and constant.value is not False and constant.value == 0


def _rejects(rules: tuple[Rule, ...]) -> bool:
    """Whether a block does nothing but reject."""
    return bool(rules) and all(isinstance(rule, Reject) for rule in rules)
