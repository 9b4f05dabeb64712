"""Names of the user's, as reports show them."""

from __future__ import annotations


def shorten(name: str) -> str:
    """A name of hostile length, cut for a report."""
    return name if len(name) <= 80 else f"{name[:77]}..."
