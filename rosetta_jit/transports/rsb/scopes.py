"""Scopes: `/`, `/arm/`, `/arm/left/`. Who listens on one gets the events of all below it."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from rosetta_jit.transports.limits import MAX_SCOPE_CHARACTERS

if TYPE_CHECKING:
    from rosetta_jit.transports.address import Address

SCOPE = re.compile(r"/(?:[-_a-zA-Z0-9]+/)*(?:[-_a-zA-Z0-9]+)?")


@lru_cache(maxsize=1024)
def normal(scope: str) -> str | None:
    """A scope with its last slash; None where it is none."""
    if len(scope) > MAX_SCOPE_CHARACTERS or not SCOPE.fullmatch(scope):
        return None
    return scope if scope.endswith("/") else f"{scope}/"


@lru_cache(maxsize=1024)
def above(scope: str) -> list[str]:
    """A scope in its normal form and all that it lies in, the root last."""
    found = [scope]
    while scope != "/":
        scope = scope[: scope.rindex("/", 0, -1) + 1]
        found.append(scope)
    return found


def scope_of(address: Address) -> str:
    """The scope that an address names.

    Raises
    ------
    AddressError
        It is none.
    """
    scope = normal(address.rest)
    if scope is None:
        raise address.wrong("a scope: `/`, then letters, digits, `-` and `_` between slashes", "rsb:/arm/left")
    return scope
