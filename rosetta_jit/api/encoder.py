"""Encoders as users make them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Self, Unpack

from rosetta_jit.api import programs
from rosetta_jit.api.options import Options, request_of, type_request
from rosetta_jit.runtime.callable import callable_class
from rosetta_jit.runtime.encoder import EncoderBase
from rosetta_jit.runtime.looks.described import DescribedProgram


class Encoder(programs.Made, EncoderBase):
    """Encodes holders as messages: ``encode(holder)`` gives bytes. Parameters as of `Decoder`.

    Where a framework has several dialects, ``encoding`` must say which one to write.
    """

    def __init__(self, mapping: str | os.PathLike[str], **options: Unpack[Options]) -> None:
        self._make(request_of("encode", options, mapping=os.fspath(mapping)))

    @classmethod
    def of(cls, type_: str | type, **options: Unpack[Options]) -> Self:
        """An encoder of a type from its own holder; parameters as of `Decoder.of`."""
        return programs.of_request(cls, type_request("encode", type_, options))

    @property
    def kernel(self) -> Any:
        """The kernel as a typed numba function, ``int64(uint8*, intp begin, intp end, int64* state, intp row)``.

        For use in ``@njit`` code: see `rosetta_jit.backends.numba.function.data_pointer`, and a holder's ``lanes_.state``. What
        `now()` and `counter()` are then stands in its words 12 and 13. ValueError where the mapping keeps state, calls functions, or
        compresses images.
        """
        self._refuse_state()
        from rosetta_jit.backends.numba.function import typed

        return typed(programs.build_of(self._request).kernels[0])


if not TYPE_CHECKING:
    Encoder.__doc__ = DescribedProgram(Encoder.__doc__)
    Encoder = callable_class(Encoder)
