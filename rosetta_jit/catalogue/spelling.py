"""Names of the user's: what somebody meant who wrote one that there is not, and how reports show them."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.limits import MAX_CANDIDATES, MAX_COMPARED

if TYPE_CHECKING:
    from collections.abc import Iterable


NEAR = 3
"""How many names that are like the one written are looked at."""


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


def shorten(name: str) -> str:
    """A name of hostile length, cut for a report."""
    return name if len(name) <= 80 else f"{name[:77]}..."
