"""Proofs of routines that many programs share: made once a machine, then known to the cache, as code is that was proven before."""

from __future__ import annotations

from collections.abc import Callable

from rosetta_jit.runtime.cache.texts import kept


def proven(claim: str, prove: Callable[[], None]) -> None:
    """Make the proof of a claim, unless the cache knows that there is one. What ``prove`` raises is not kept."""
    kept("proof", f"proof of {claim}", lambda: prove() or b"")
