"""What somebody meant who wrote a name that there is not."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.limits import MAX_CANDIDATES, MAX_COMPARED

if TYPE_CHECKING:
    from collections.abc import Iterable


def closest(name: str, known: Iterable[str]) -> str | None:
    """The name most like the one written, in whatever case, if one is like it. However many and long they are, the work is bounded."""
    from difflib import get_close_matches  # whoever writes all names right does not import it

    written, candidates = name[:MAX_COMPARED], [each for each in islice(known, MAX_CANDIDATES) if len(each) <= MAX_COMPARED]
    folded = {each.casefold(): each for each in reversed(candidates)}
    near = get_close_matches(written, candidates, 1) or get_close_matches(written.casefold(), list(folded), 1)
    return folded.get(written.casefold()) or (folded.get(near[0].casefold()) if near else None)
