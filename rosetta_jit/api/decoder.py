"""Decoders as users make them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Self, Unpack

from rosetta_jit.api import programs
from rosetta_jit.api.loading import is_as_before, sites_of
from rosetta_jit.api.options import Options, request_of, type_request
from rosetta_jit.errors import SchemaError
from rosetta_jit.runtime.callable import callable_class
from rosetta_jit.runtime.decoder import DecoderBase
from rosetta_jit.runtime.looks.described import DescribedProgram
from rosetta_jit.runtime.program import Loaded
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.runtime.on_demand import OnDemand


class Decoder(programs.Made, DecoderBase):
    """Decodes messages into holders: ``decode(message)`` fills and returns the decoder's own holder.

    Parameters
    ----------
    mapping : path
        A mapping, by its path or by its name on the search path: the folders given, those of ROSETTA_JIT_PATH, what is shipped.
    **options
        See `Options`.

    Raises
    ------
    MappingError, SchemaError
        With every mistake and its place.
    """

    def __init__(self, mapping: str | os.PathLike[str], **options: Unpack[Options]) -> None:
        self._make(request_of("decode", options, mapping=os.fspath(mapping)))

    @classmethod
    def of(cls, type_: str | type, **options: Unpack[Options]) -> Self:
        """A decoder of a type into its own holder, without a mapping.

        Parameters
        ----------
        type_
            Qualified name, or a message class of protobuf's Python package.
        **options
            See `Options`.
        """
        return programs.of_request(cls, type_request("decode", type_, options))

    @cached_property
    def kernel(self) -> Any:
        """The decoder as a function for compiled code, ``kernel(message, holder, begin=0, end=None)``, to be called in ``@njit`` functions.

        It fills a holder, one of `new()` that the function was given, from bytes ``begin`` to ``end`` of a bytes object or an array of
        uint8. Fields are read by name there: numbers and arrays as in Python, texts and bytes as arrays of uint8, arrays of messages with
        ``len``, index and iteration, ``holder.has("name")`` where a field may be absent. Lanes grow as they must. A broken message raises
        `DecodeError`. Bytes fields are copied, whatever ``borrow`` says.

        Raises
        ------
        ValueError
            The mapping keeps state, calls functions, or compresses images.
        """
        self._refuse_state()
        imported("rosetta_jit.in_numba.calling")
        from rosetta_jit.in_numba.calling import callable_kernel
        from rosetta_jit.in_numba.ownership import Program

        build = programs.build_of(replace(self._request, borrow=False))
        tell = self._tell if build.header["asks_host"] else None
        program = Program(sites_of(build.header, 0), build.header["limit"], tell, self._untell)
        return callable_kernel(build.kernels[0], self.holder_type.family_, program)

    def _other(self, on_demand: OnDemand) -> Loaded:
        other = None
        if is_as_before(self._request, on_demand.name, programs.compiled_build):
            other = programs.loaded_of(replace(self._request, byte_order=on_demand.byte_order))
        if other is None or other.holder_type is not self._loaded.holder_type:
            from rosetta_jit.catalogue.pipeline import changed_since

            raise SchemaError((changed_since(on_demand.byte_order),))
        return other


if not TYPE_CHECKING:
    Decoder.__doc__ = DescribedProgram(Decoder.__doc__)
    Decoder = callable_class(Decoder)
