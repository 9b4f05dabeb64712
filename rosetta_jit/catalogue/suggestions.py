"""Names that a mistake may have meant ("did you mean"): the nearest of those that there are, and all of them where they are few."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from itertools import islice

from rosetta_jit.catalogue.limits import MAX_CANDIDATES, MAX_COMPARED, MAX_NAMES

NEAR = 3
"""How many names that are like the one written are looked at."""

FEW = 5
"""How many names are shown where none is like the one written."""

LIKE = 0.6
"""From how much on a name is like another one, of 1 for the same."""


def nearest(name: str, known: Collection[str]) -> str | None:
    """The known name that somebody who wrote ``name`` may have meant."""
    return closest(name, sorted(known))


def did_you_mean(name: str, known: Collection[str]) -> str:
    """The known name that may be meant, as a help; empty where none is near."""
    found = nearest(name, known)
    return f"did you mean `{found}`?" if found else ""


def there_are(what: str, known: Collection[str], name: str = "") -> tuple[str, ...]:
    """What there is to choose from, as a note; where it is too much, what is like a name that was written."""
    shown = sorted(known)
    if name and len(shown) > MAX_NAMES:
        shown = sorted(most_like(name, shown, MAX_NAMES))
    names = [shorten(each) for each in shown[:MAX_NAMES]]
    more = ", ..." if len(known) > MAX_NAMES else ""
    return (f"{what}: {', '.join(names)}{more}",) if names else (f"{what}: none",)


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
