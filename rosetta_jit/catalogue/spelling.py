"""Names of the user's: what somebody meant who wrote one that there is not, and how reports show them."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

from rosetta_jit.catalogue.limits import MAX_CANDIDATES, MAX_COMPARED

NEAR = 3
"""How many names that are like the one written are looked at."""


FEW = 5
"""How many names are shown where none is like the one written."""

LIKE = 0.6
"""From how much on a name is like another one, of 1 for the same."""


def closest(name: str, known: Iterable[str]) -> str | None:
    """The name most like the one written, in whatever case, if one is like it. However many and long they are, the work is bounded.

    Whoever misspells a name has its first letter right more often than not: of names that are like it, those that begin as it does come
    first, so that `nsecs` is `nanosec` and not `sec`.
    """
    from difflib import get_close_matches  # whoever writes all names right does not import it

    written, candidates = name[:MAX_COMPARED], [each for each in islice(known, MAX_CANDIDATES) if len(each) <= MAX_COMPARED]
    folded = {each.casefold(): each for each in reversed(candidates)}
    near = get_close_matches(written, candidates, NEAR) or get_close_matches(written.casefold(), list(folded), NEAR)
    near.sort(key=lambda each: each[:1].casefold() != written[:1].casefold())
    return folded.get(written.casefold()) or (folded.get(near[0].casefold()) if near else None)


def most_like(name: str, known: list[str], most: int) -> list[str]:
    """Of names those that are like the one written, as a whole or in their last part, the likest first; where none is, the shortest."""
    from difflib import SequenceMatcher

    candidates = [each for each in islice(known, MAX_CANDIDATES) if len(each) <= MAX_COMPARED]
    matcher = SequenceMatcher(a="", b=name[:MAX_COMPARED].casefold(), autojunk=False)

    def likeness(each: str) -> float:
        found = 0.0
        for part in (each, each.rpartition(".")[2]):
            matcher.set_seq1(part.casefold())
            found = max(found, matcher.ratio())
        return found

    alike = sorted((-likeness(each), each) for each in candidates)
    near = [each for much, each in alike if -much >= LIKE]
    return near[:most] or sorted(candidates, key=lambda each: (len(each), each))[:FEW]


def shorten(name: str) -> str:
    """A name of hostile length, cut for a report."""
    return name if len(name) <= 80 else f"{name[:77]}..."
