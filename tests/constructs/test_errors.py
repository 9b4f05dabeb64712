"""Every construct has at least three mistakes whose reports are golden."""

from __future__ import annotations

from collections import defaultdict

from tests.constructs.reported import EVERY_GROUP, reported
from tests.language.test_check_reports import WRONG

LEAST = 3


def test_every_construct_has_mistakes_with_reports():
    found: dict[str, set[str]] = defaultdict(set)
    for path in WRONG:
        for construct, report in reported(path):
            found[construct].add(report)
    assert {construct: sorted(found[construct]) for construct in EVERY_GROUP if len(found[construct]) < LEAST} == {}
