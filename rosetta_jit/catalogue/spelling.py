"""What somebody meant who wrote a name that there is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def closest(name: str, known: Sequence[str]) -> str | None:
    """The name most like the one written, in whatever case, if one is like it. The work grows with their lengths: callers bound both."""
    from difflib import get_close_matches  # whoever writes all names right does not import it

    folded = {each.casefold(): each for each in reversed(known)}
    near = get_close_matches(name, known, 1) or get_close_matches(name.casefold(), list(folded), 1)
    return folded.get(name.casefold()) or (folded.get(near[0].casefold()) if near else None)
