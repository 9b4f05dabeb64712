"""Decoders and encoders as users make them: from the cache where it has the answer, else from the compiler."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Self, Unpack

from rosetta_jit.api.loading import answer, interpreted_kernel, is_as_before, library, sites_of
from rosetta_jit.api.options import Options, request_of, type_request
from rosetta_jit.errors import SchemaError
from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Ref
from rosetta_jit.pipeline.request import Request
from rosetta_jit.runtime import run
from rosetta_jit.runtime.callable import callable_class, public_class
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.decoder import DecoderBase
from rosetta_jit.runtime.encoder import EncoderBase
from rosetta_jit.runtime.holder import Holder, holder_class_of
from rosetta_jit.runtime.holder.manners import manners_at
from rosetta_jit.runtime.looks.described import DescribedProgram
from rosetta_jit.runtime.program import Loaded
from rosetta_jit.runtime.registers import Kept
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.frameworks.definitions import Definition
    from rosetta_jit.pipeline.build import Build
    from rosetta_jit.pipeline.checked_mapping import CheckedMapping
    from rosetta_jit.pipeline.stages import StageName
    from rosetta_jit.runtime.on_demand import OnDemand


class _Made:
    """How a program is made, and what it became."""

    _request: Request
    if TYPE_CHECKING:

        @property
        def holder_type(self) -> type[Holder]: ...

    @property
    def mapping(self) -> CheckedMapping | None:
        """The mapping with its ``warnings`` and ``laws``; None of a type into its own holder. It is read anew: keep what is found."""
        from rosetta_jit.pipeline.checked_mapping import CheckedMapping

        return None if self._request.mapping is None else CheckedMapping(_build(self._request).checked)

    @property
    def definition(self) -> Definition | None:
        """The definition of the holder's type as logs carry it beside messages; None where that cannot be had. It is made anew."""
        build = _build(self._request)
        return build.holder_framework.definition_of(build.types.holder, build.types.schema)

    def _is_plain(self, encodings: frozenset[str | None]) -> bool:
        return self._request.mapping is None and self._request.encoding in encodings

    def announced(self, framework: str) -> dict[str, str]:
        """What a publisher says of the type on the wire, by the names of transports' options; as of a bridge. It is made anew."""
        build = _build(self._request)
        if build.wire_framework.name != framework:
            return {}
        return build.wire_framework.announced(build.types.wire, build.types.schema)

    def stage(self, stage: StageName | str) -> str:
        """What the program became, as text: ``model``, ``codec``, ``kernel``, ``python``, ``llvm`` or ``asm``."""
        return _build_compiled(self._request).stage(stage)

    def __repr__(self) -> str:
        request, holder = self._request, self.holder_type.family_.struct.name
        what = holder if request.mapping is None else f"{request.mapping}, {'from' if request.direction == 'encode' else 'into'} {holder}"
        wire = f", wire {request.wire}" if request.wire else ""
        return f"<{type(self).__name__} of {what}{wire}{'' if request.encoding is None else f', {request.encoding}'}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are made anew from the request, by the cache of their process: they share code, but no holder."""
        return _of_request, (public_class(self), self._request)


class Decoder(_Made, DecoderBase):
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
        return _of_request(cls, type_request("decode", type_, options))

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

        build = _build(replace(self._request, borrow=False))
        tell = self._tell if build.header["asks_host"] else None
        program = Program(sites_of(build.header, 0), build.header["limit"], tell, self._untell)
        return callable_kernel(build.kernels[0], self.holder_type.family_, program)

    def _other(self, on_demand: OnDemand) -> Loaded:
        other = None
        if is_as_before(self._request, on_demand.name, _build_compiled):
            other = _loaded(replace(self._request, byte_order=on_demand.byte_order))
        if other is None or other.holder_type is not self._loaded.holder_type:
            from rosetta_jit.catalogue.pipeline import changed_since

            raise SchemaError((changed_since(on_demand.byte_order),))
        return other

    def _make(self, request: Request, beside: Self | None = None) -> None:
        """Become the program that answers a request; ``beside`` is one for another wire of the same mapping."""
        self._request = request
        self._start(_loaded(request), beside)


class Encoder(_Made, EncoderBase):
    """Encodes holders as messages: ``encode(holder)`` gives bytes. Parameters as of `Decoder`.

    Where a framework has several dialects, ``encoding`` must say which one to write.
    """

    def __init__(self, mapping: str | os.PathLike[str], **options: Unpack[Options]) -> None:
        self._make(request_of("encode", options, mapping=os.fspath(mapping)))

    @classmethod
    def of(cls, type_: str | type, **options: Unpack[Options]) -> Self:
        """An encoder of a type from its own holder; parameters as of `Decoder.of`."""
        return _of_request(cls, type_request("encode", type_, options))

    @property
    def kernel(self) -> Any:
        """The kernel as a typed numba function, ``int64(uint8*, intp begin, intp end, int64* state, intp row)``.

        For use in ``@njit`` code: see `rosetta_jit.backends.numba.function.data_pointer`, and a holder's ``lanes_.state``. What
        `now()` and `counter()` are then stands in its words 12 and 13. ValueError where the mapping keeps state, calls functions, or
        compresses images.
        """
        self._refuse_state()
        from rosetta_jit.backends.numba.function import typed

        return typed(_build(self._request).kernels[0])

    def _make(self, request: Request, beside: Self | None = None) -> None:
        """Become the program that answers a request; ``beside`` is one for another wire of the same mapping."""
        self._request = request
        self._start(_loaded(request), beside)


def _build(request: Request) -> Build:
    imported("rosetta_jit.pipeline.build")
    from rosetta_jit.pipeline.build import Build

    return Build(request)


def _build_compiled(request: Request) -> Build:
    """The same as it is compiled: messages that hardly ever come are left to another program."""
    imported("rosetta_jit.pipeline.build")
    from rosetta_jit.pipeline.build import Build

    return Build(request, leaves_rare=True)


def _loaded(request: Request) -> Loaded:
    """The program that answers a request."""
    return answer(request, request.backend, _build_compiled, _linked, _interpreted)


def _linked(header: Mapping[str, Any], image: bytes) -> Loaded:
    """A program from its object code."""
    holder_type = _holder_type(header)
    code = library(image, header)
    size = run.native_run(code["size"]) if header["entry"] == "encode" else None
    return Loaded(
        holder_type=holder_type,
        sites=sites_of(header, 0),
        kernel=run.native_run(code["kernel"]),
        size=size,
        size_sites=sites_of(header, 1),
        library=code,
        borrow=header["entry"] == "borrow",
        asks_host=header["asks_host"],
        limit=header["limit"],
        state=Kept.of(header["state"]),
        on_demand=_on_demand(header, code),
        **_wires(header),
    )


def _on_demand(header: Mapping[str, Any], code: Library) -> OnDemand | None:
    """A program's knowledge of another one to which it leaves messages that hardly ever come; None where it leaves none."""
    if header["rare"] is None:
        return None
    from rosetta_jit.runtime.on_demand import OnDemand

    return OnDemand.of(header, code)


def _interpreted(build: Build) -> Loaded:
    """A program that runs in Python: slowly, but anywhere."""
    kernels = [interpreted_kernel(build, number) for number in range(len(build.kernels))]
    return Loaded(
        holder_type=_holder_type(build.header),
        sites=sites_of(build.header, 0),
        kernel=kernels[0],
        size=kernels[1] if len(kernels) > 1 else None,
        size_sites=sites_of(build.header, 1),
        borrow=build.request.borrow,
        asks_host=build.header["asks_host"],
        limit=build.header["limit"],
        state=Kept.of(build.header["state"]),
        **_wires(build.header),
    )


def _wires(header: Mapping[str, Any]) -> dict[str, Any]:
    """The wires of a mapping that has several, and of a decoder which of them it reads."""
    return {"wires": tuple(header["wires"]), "wire": header["wire"]}


def _holder_type(header: Mapping[str, Any]) -> type[Holder]:
    """The holder class, whose messages can serialise themselves if their manners have it."""
    manners = manners_at(header["manners"])
    base: Any = manners.base
    if manners.serialising is not None and vars(base)["programs_"] is None:
        base.programs_ = Serialising(*manners.serialising)
    return holder_class_of(header["type"], manners)


def holder_type_of(request: Request) -> type[Holder]:
    """The holder class of the program that would answer a request; nothing is compiled."""
    build = _build(request)
    return _holder_type({"type": to_plain(Ref(build.types.holder.name), build.types.schema), "manners": build.manners})


def wires_of(request: Request) -> list[str]:
    """The names of the mapping's wires, where a request is for one that has several; nothing is compiled."""
    return _build(request).wires


class Serialising:
    """The programs behind ``SerializeToString`` and its like: of each holder class its own, compiled when first used."""

    def __init__(self, framework: str, encoding: str) -> None:
        self._framework, self._encoding = framework, encoding

    def __get__(self, holder: Holder | None, holder_type: type[Holder]) -> OwnPrograms:
        family = holder_type.family_
        if family.programs is None:
            family.programs = OwnPrograms(Request("decode", encoding=self._encoding, plain=family.text, framework=self._framework))
            setattr(family.holder, "programs_", family.programs)  # noqa: B010  where it is found sooner; not every holder has it
        return family.programs


class OwnPrograms:
    """Decoder and encoder of a message class into itself."""

    def __init__(self, request: Request) -> None:
        self._request = request

    @cached_property
    def encode(self) -> Any:
        """The encoder: the bytes of a holder."""
        return _of_request(Encoder, replace(self._request, direction="encode"))

    @cached_property
    def decode(self) -> Any:
        """The decoder: it is given bytes, and the holder to fill."""
        return _of_request(Decoder, self._request)

    def size(self, holder: Any) -> int:
        """How many bytes a holder takes."""
        return self.encode.size(holder)

    def new(self) -> Any:
        """A holder with room for what has been decoded until now."""
        return self.decode.new()


def program_of(request: Request, beside: Any = None) -> Any:
    """The decoder or encoder that answers a request; ``beside`` is one for another wire, with which it shares its holder and state."""
    return _of_request(Decoder if request.direction == "decode" else Encoder, request, beside)


def _of_request(program: Any, request: Request, beside: Any = None) -> Any:
    made = program.__new__(program)
    made._make(request, beside)
    return made


if not TYPE_CHECKING:
    Decoder.__doc__, Encoder.__doc__ = DescribedProgram(Decoder.__doc__), DescribedProgram(Encoder.__doc__)
    Decoder, Encoder = callable_class(Decoder), callable_class(Encoder)
