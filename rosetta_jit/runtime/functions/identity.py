"""Which function it is: its digest, or the reasons why there is none.

Code that numba has compiled for a dispatcher has the values that globals had then, and nobody can tell later which these were. So the
dispatchers that a function calls must not be compiled yet, or must have been compiled for programs of ours: `settle` notes what they were.
"""

from __future__ import annotations

from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

from rosetta_jit.catalogue import uncertain as words
from rosetta_jit.runtime.functions import environment, registered
from rosetta_jit.runtime.functions.content import Content, content_of
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256


@dataclass(frozen=True, slots=True)
class Identity:
    """Which function it is.

    Attributes
    ----------
    digest
        Changes with whatever the function computes; None where that cannot be told for certain.
    uncertain
        The reasons, then.
    objects
        What compiled code of the function may have addresses of, and that must therefore live as long.
    content
        Digest of all that was seen of it, certain or not.
    """

    digest: str | None
    uncertain: tuple[str, ...] = ()
    objects: tuple[object, ...] = ()
    content: str = ""


def identify(callee: object, name: str) -> Identity:
    """Look at a function, before it is compiled; raises TypeError where it is neither a Python function nor one of numba's njit."""
    content, around = content_of(callee, name), _around()
    before = tuple(words.compiled_before(path) for path, each in content.dispatchers if not _is_as_now(each, around))
    uncertain = tuple(dict.fromkeys((*content.uncertain, *before, *around.uncertain)))
    return Identity(None if uncertain else _digest(content, around), uncertain, content.objects, content.digest)


def settle(identity: Identity, callee: object, name: str) -> bool:
    """Look at a function again, after it was compiled: whether it is identified, and still the same. What it calls is compiled now, too."""
    content, around = content_of(callee, name), _around()
    if content.digest != identity.content:
        return False
    older = set(identity.uncertain)
    for path, each in content.dispatchers:
        digest = _digest(content_of(each, path), around)
        if digest is not None and words.compiled_before(path) not in older:
            _settled()[each] = digest, _compiled(each)
    return identity.digest is not None and _digest(content, around) == identity.digest


@dataclass(frozen=True, slots=True)
class _Around:
    """What all functions of a process depend on."""

    text: str
    uncertain: tuple[str, ...]


def _around() -> _Around:
    return _Around(environment.environment(), (*environment.doubts(), *registered.doubts()))


def _digest(content: Content, around: _Around) -> str | None:
    if content.uncertain or around.uncertain:
        return None
    return sha256(f"{around.text}\n{content.digest}".encode("utf-8", "surrogatepass")).hexdigest()


def _is_as_now(dispatcher: Any, around: _Around) -> bool:
    """Whether all code that a dispatcher has was compiled of what it reaches now."""
    if not dispatcher.overloads:
        return True
    settled = _settled().get(dispatcher)
    return settled is not None and settled == (_digest(content_of(dispatcher, ""), around), _compiled(dispatcher))


def _compiled(dispatcher: Any) -> tuple[tuple[object, int], ...]:
    return tuple((types, id(made)) for types, made in dispatcher.overloads.items())


@cache
def _settled() -> WeakKeyDictionary[Any, tuple[str, tuple[tuple[object, int], ...]]]:
    """Of each dispatcher that was compiled for a program of ours: its digest, and the code that it had then."""
    return WeakKeyDictionary()
