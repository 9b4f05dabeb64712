"""Names that a mistake may have meant: the nearest of those that there are, and all of them where they are few."""

from __future__ import annotations

from collections.abc import Collection

from rosetta_jit.catalogue.limits import MAX_NAMES
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.spelling import closest, most_like


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
