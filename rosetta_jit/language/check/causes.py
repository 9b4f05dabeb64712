"""Reports in the order of causes: what follows from another mistake is left out."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator

from rosetta_jit.catalogue import fields as words
from rosetta_jit.diagnostics import Diagnostic
from rosetta_jit.model.mapping import Relation, Rule
from rosetta_jit.model.walk import every_rule
from rosetta_jit.source import Span
from rosetta_jit.startup.dataclass import replace

OF_NAMES = frozenset(("unknown-function", "unknown-name", "unknown-field"))
"""Mistakes that leave open what a rule means."""

UNDECLARED = frozenset(("unknown-state", "parameter-type"))
"""Mistakes in what a name is declared as: rules that use it have no further mistake."""

UNUSED = frozenset(("parameter-unused",))
"""Warnings about a name that a rule may have meant."""

OF_CALLS = frozenset(("arguments", "group-arguments", "signal"))
"""Mistakes in what a function is given, which leave open what undoes it."""

OF_GROUPS = frozenset(("no-group",))
"""Mistakes that leave open what several places are set to."""

OF_CONDITIONS = frozenset(("undetermined-field", "alike-blocks", "unknown-condition"))
"""Mistakes of packing about what a condition reads."""

CLASHES = frozenset(("type-clash",))
"""Mistakes after which another field is probably meant."""

OF_TYPES = frozenset(("type-clash", "lossy-conversion", "unit", "operand", "text-needed", "not-comparable"))
"""Mistakes that each direction of a relation reports in its own words."""

OF_OPERANDS = frozenset(("operand", "text-needed"))
"""Mistakes of an operator, which a relation of one field repeats at the place of another one that it checks."""

OF_WHOLE = frozenset(("never-set",))
"""Mistakes of a direction as a whole, which may follow from a mistake in a rule."""

DERIVED = frozenset(("not-comparable",))
"""Mistakes of the checks that relations of one field make of each other."""

OF_OTHERS = frozenset(("several-fields",))
"""Mistakes of packing that another relation would mend: one whose names are wrong may be the one that is missed."""

OF_INVERSES = frozenset(("no-inverse", "several-fields"))
"""Mistakes of packing alone."""


def relations_of(rules: tuple[Rule, ...]) -> list[Span]:
    """Where relations stand, those in blocks included, in the order of the text."""
    return [rule.span for rule in every_rule(rules) if isinstance(rule, Relation) and rule.span is not None]


def unclear(problems: Iterable[Diagnostic], relations: list[Span]) -> bool:
    """Whether a relation names what there is not, or what does not fit: then it is open which field it packs."""
    named = (each for each in problems if each.code in OF_NAMES | CLASHES | OF_GROUPS)
    return any(each.code in OF_GROUPS or _relation(each, relations) is not None for each in named)


def causes(problems: list[Diagnostic], relations: list[Span]) -> list[Diagnostic]:
    """The reports without those that follow from others, in their order; ``relations`` are in the order of the text.

    A function that there is not, or that is given what it does not take, has no inverse either, and what has the wrong type for one
    direction of a relation has it for the other.
    """
    named = {_relation(each, relations) for each in problems if each.code in OF_NAMES | OF_CALLS}
    misread = {_relation(each, relations) for each in problems if each.code in OF_NAMES}
    clashes = unclear(problems, relations)
    undeclared = {_quoted(each) for each in problems if each.code in UNDECLARED}
    misnamed = {_written(each) for each in problems if each.code in OF_NAMES}
    names = [each.span for each in problems if each.code in OF_NAMES and each.span is not None]
    found: list[Diagnostic] = []
    wrong: set[int] = set()
    said: set[tuple[str, str]] = set()
    for each in _once(problems, relations):
        if (each.code == "unknown-name" and _quoted(each) in undeclared) or (each.code in UNUSED and _quoted(each) in misnamed):
            continue
        relation = _relation(each, relations)
        if each.code in OF_CONDITIONS and (relation in misread - {None} or any(_is_within(name, each.span) for name in names)):
            continue
        if relation is not None and each.severity == "error":
            if (each.code in OF_INVERSES and relation in named) or (each.code in OF_TYPES and relation in wrong):
                continue
            if clashes and each.code in DERIVED and each.span == relations[relation]:
                continue
            if each.code in OF_OTHERS and any(other is not None for other in misread):
                continue
            if each.code in OF_OPERANDS and _is_place(each, relations[relation]) and (each.code, each.message) in said:
                continue
            if each.code not in OF_INVERSES:
                wrong.add(relation)
            said.add((each.code, each.message))
        found.append(each)
    return found


def rules_first(problems: list[Diagnostic], relations: list[Span]) -> list[Diagnostic]:
    """Without the fields of the wire that a wrong relation would set if it were right: those called as the place to its left."""
    wrong = {_relation(each, relations) for each in problems if each.severity == "error" and each.code not in OF_WHOLE}
    meant = {place for number in wrong if number is not None for place in _places(relations[number])}
    return [each for each in problems if each.code not in OF_WHOLE or "of the wire" not in each.message or _quoted(each) not in meant]


def _places(relation: Span) -> list[str]:
    """What stands to the left of a relation."""
    return [each.strip() for each in relation.source.text[relation.start : relation.end].partition("<->")[0].split(",")]


def _is_place(problem: Diagnostic, relation: Span) -> bool:
    """Whether a report is about what stands to the left of a relation."""
    return problem.span is not None and problem.span.start == relation.start


def _once(problems: list[Diagnostic], relations: list[Span]) -> Iterator[Diagnostic]:
    """The reports, of names one a place, and of relations whose sides stand in each other's place one for both."""
    said: set[object] = set()
    swapped: dict[int, set[int]] = {}
    for each in problems:
        relation = _relation(each, relations)
        if relation is not None and each.span is not None and words.is_elsewhere(each):
            swapped.setdefault(relation, set()).add(each.span.start)
    for each in problems:
        relation = _relation(each, relations)
        of_sides = relation is not None and words.is_elsewhere(each) and len(swapped[relation]) > 1
        key = ("sides", relation) if of_sides else (each.code, each.span) if each.code in OF_NAMES else None
        if key is None or key not in said:
            yield replace(each, help=words.TURNED) if of_sides else each
        said.add(key)


def _is_within(span: Span, around: Span | None) -> bool:
    return around is not None and span.source is around.source and around.start <= span.start and span.end <= around.end


def _written(problem: Diagnostic) -> str:
    """What is written where a name is wrong, without its dot."""
    span = problem.span
    return "" if span is None else span.source.text[span.start : span.end].lstrip(".")


def _quoted(problem: Diagnostic) -> str:
    """The name that a report is about."""
    return problem.message.partition("`")[2].partition("`")[0]


def _relation(problem: Diagnostic, relations: list[Span]) -> int | None:
    """The number of the relation that a report is about."""
    span = problem.span
    if span is None:
        return None
    number = bisect_right(relations, span.start, key=_start) - 1
    around = relations[number] if number >= 0 else None
    return number if around is not None and around.source is span.source and span.end <= around.end else None


def _start(span: Span) -> int:
    return span.start
