"""How many rules of the shipped mappings a draft gets right: the same places with the same conversion, in either direction."""

from __future__ import annotations

from pathlib import Path

import pytest

from rosetta_jit.draft.draft import draft
from rosetta_jit.frameworks.installed import Readers, installed
from rosetta_jit.language.check.mapping import check
from rosetta_jit.language.parse.mapping import parse
from rosetta_jit.parsing.search import SearchPath
from rosetta_jit.source import Source
from tests.draft.meanings import meanings

MAPPINGS = Path(__file__).resolve().parents[2] / "mappings"
SHIPPED = [
    path.relative_to(MAPPINGS).as_posix() for path in sorted(MAPPINGS.rglob("*.mapping")) if path.parent.name not in ("joined", "packed")
]
"""But for those of several wires: a draft is between two types."""
SEARCH, READERS = SearchPath.of(), Readers(installed())
ENOUGH = 0.6


@pytest.fixture(scope="module")
def found():
    """For each shipped mapping its rules, those of the draft, and what the checker says of the draft."""
    compared = {}
    for name in SHIPPED:
        shipped = check(parse(SEARCH.open(name)), READERS, SEARCH)
        imports = [each.path for each in shipped.mapping.imports if not each.path.endswith((".mapping", ".units"))]
        text, problems = draft(shipped.mapping.holder_type, shipped.mapping.wire_type, imports=imports)
        wrong = [each for each in problems if each.severity == "error"]
        drafted = set() if wrong else meanings(check(parse(Source("draft.mapping", text)), READERS, SEARCH))
        compared[name] = (meanings(shipped), drafted, wrong)
    return compared


def test_every_draft_passes_the_checker(found):
    assert {name: wrong for name, (_, _, wrong) in found.items() if wrong} == {}


def test_most_rules_are_right(found):
    """All rules that set something count, also those that no draft can know: tables, constants, padded rows."""
    rows = [(name, len(rules & drafted), len(rules), len(drafted)) for name, (rules, drafted, _) in found.items()]
    right, all_rules, proposed = (sum(row[number] for row in rows) for number in (1, 2, 3))
    reading = [(rule in drafted) for rules, drafted, _ in found.values() for rule in rules if rule.reads]
    each = sum(row[1] / row[2] for row in rows) / len(rows)
    for name, count, of, made in rows:
        print(f"{name:45} {count:3} of {of:3}, {made - count} wrong")
    print(f"{right} of {all_rules} rules are right: {right / all_rules:.1%}; {each:.1%} of those of a mapping, on average")
    print(f"of those that read the other side: {sum(reading) / len(reading):.1%}; of those proposed: {right / proposed:.1%}")
    assert right / all_rules >= ENOUGH
    assert each >= ENOUGH
    assert right / proposed >= 0.85
