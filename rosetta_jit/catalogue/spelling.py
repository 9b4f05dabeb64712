"""What somebody meant who wrote a name that there is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def closest(name: str, known: Sequence[str]) -> str | None:
    """The name that is most like the one written, if one is like it. The work grows with their lengths: callers bound both."""
    from difflib import get_close_matches  # whoever writes all names right does not import it

    return next(iter(get_close_matches(name, known, 1)), None)
