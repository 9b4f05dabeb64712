"""Remembers what was read and checked for the last requests, so that the encoder of a mapping need not do it again after the decoder."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeVar, cast

from rosetta_jit.frameworks.installed import installed
from rosetta_jit.pipeline.limits import MAX_RECENT, MAX_RECENT_BYTES
from rosetta_jit.pipeline.request import Request, here
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.frameworks.base import Framework
    from rosetta_jit.language import installed as functions
    from rosetta_jit.language.function import Function
    from rosetta_jit.pipeline.declared import Files
else:
    functions = Late("rosetta_jit.language.installed")

_Said = TypeVar("_Said")


@dataclass(frozen=True, slots=True)
class _Recent:
    """What was made of some files, by which frameworks and, of a mapping, functions of installed packages."""

    said: object
    files: Files
    frameworks: Mapping[str, Framework]
    functions: tuple[Function, ...] | None

    def holds(self) -> bool:
        """Whether the same would be made of the files as they are now."""
        is_extended_as_before = self.functions is None or self.functions is functions.offered()
        return self.frameworks is installed() and is_extended_as_before and self.files.are_unchanged()


_recent: OrderedDict[Hashable, _Recent] = OrderedDict()
"""The last one is the youngest. Threads share it: each step is one that Python does not interrupt."""


def recently(request: Request, files: Files, say: Callable[[], _Said]) -> _Said:
    """What ``say`` makes of a request's ``files``, or made of the same ones a moment ago.

    ``say`` must depend on nothing of the request that `_texts` leaves out. What it raises is not remembered.
    """
    question = (_texts(request), files.search, here())
    known = _recent.get(question)
    if known is not None and known.holds():
        files.reading.take(known.files.reading)
        with suppress(KeyError):  # another thread has removed it
            _recent.move_to_end(question)
        return cast("_Said", known.said)
    said = say()
    if files.reading.size_bytes <= MAX_RECENT_BYTES:
        _recent[question] = _Recent(said, files, installed(), None if request.mapping is None else functions.offered())
        _recent.move_to_end(question)
        while len(_recent) > MAX_RECENT:
            _recent.popitem(last=False)
    return said


def _texts(request: Request) -> Request:
    """A request as far as it says what is read, and how it is checked: the same for both directions, and for every backend."""
    wire: dict[str, Any] = {} if request.mapping is None else {"wire": None}
    return replace(request, direction="decode", borrow=False, byte_order=None, functions=(), backend=None, **wire)
