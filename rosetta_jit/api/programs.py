"""How decoders and encoders are made: from the cache where it has the answer, else from the compiler."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rosetta_jit.api.loading import answer, interpreted_kernel, library, sites_of
from rosetta_jit.model.serial import to_plain
from rosetta_jit.model.types import Ref
from rosetta_jit.pipeline.request import Request
from rosetta_jit.runtime import run
from rosetta_jit.runtime.callable import public_class
from rosetta_jit.runtime.code.native import Library
from rosetta_jit.runtime.holder import Holder, holder_class_of
from rosetta_jit.runtime.holder.manners import manners_at
from rosetta_jit.runtime.program import Loaded
from rosetta_jit.runtime.registers import Kept
from rosetta_jit.startup.cached import cached_property
from rosetta_jit.startup.dataclass import replace
from rosetta_jit.startup.garbage import imported, object_at

if TYPE_CHECKING:
    from rosetta_jit.frameworks.definitions import Definition
    from rosetta_jit.pipeline.build import Build
    from rosetta_jit.pipeline.checked_mapping import CheckedMapping
    from rosetta_jit.pipeline.stages import StageName
    from rosetta_jit.runtime.on_demand import OnDemand

_CLASSES = {"decode": "rosetta_jit.api.decoder:Decoder", "encode": "rosetta_jit.api.encoder:Encoder"}
"""Where the classes of programs are, by direction: most processes need one of them."""


class Made:
    """How a program is made, and what it became."""

    _request: Request
    if TYPE_CHECKING:

        @property
        def holder_type(self) -> type[Holder]: ...
        def _start(self, loaded: Loaded, beside: Any = None) -> None: ...

    @property
    def mapping(self) -> CheckedMapping | None:
        """The mapping with its ``warnings`` and ``laws``; None of a type into its own holder. It is read anew: keep what is found."""
        from rosetta_jit.pipeline.checked_mapping import CheckedMapping

        return None if self._request.mapping is None else CheckedMapping(build_of(self._request).checked)

    @property
    def definition(self) -> Definition | None:
        """The definition of the holder's type as logs carry it beside messages; None where that cannot be had. It is made anew."""
        build = build_of(self._request)
        return build.holder_framework.definition_of(build.types.holder, build.types.schema)

    def _make(self, request: Request, beside: Any = None) -> None:
        """Become the program that answers a request; ``beside`` is one for another wire of the same mapping."""
        self._request = request
        self._start(loaded_of(request), beside)

    def _is_plain(self, encodings: frozenset[str | None]) -> bool:
        return self._request.mapping is None and self._request.encoding in encodings

    def announced(self, framework: str) -> dict[str, str]:
        """What a publisher says of the type on the wire, by the names of transports' options; as of a bridge. It is made anew."""
        build = build_of(self._request)
        if build.wire_framework.name != framework:
            return {}
        return build.wire_framework.announced(build.types.wire, build.types.schema)

    def stage(self, stage: StageName | str) -> str:
        """What the program became, as text: ``model``, ``codec``, ``kernel``, ``python``, ``llvm`` or ``asm``."""
        return compiled_build(self._request).stage(stage)

    def __repr__(self) -> str:
        request, holder = self._request, self.holder_type.family_.struct.name
        what = holder if request.mapping is None else f"{request.mapping}, {'from' if request.direction == 'encode' else 'into'} {holder}"
        wire = f", wire {request.wire}" if request.wire else ""
        return f"<{type(self).__name__} of {what}{wire}{'' if request.encoding is None else f', {request.encoding}'}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are made anew from the request, by the cache of their process: they share code, but no holder."""
        return of_request, (public_class(self), self._request)


def build_of(request: Request) -> Build:
    """What is compiled for a request, stage by stage."""
    imported("rosetta_jit.pipeline.build")
    from rosetta_jit.pipeline.build import Build

    return Build(request)


def compiled_build(request: Request) -> Build:
    """The same as it is compiled: messages that hardly ever come are left to another program."""
    imported("rosetta_jit.pipeline.build")
    from rosetta_jit.pipeline.build import Build

    return Build(request, leaves_rare=True)


def loaded_of(request: Request) -> Loaded:
    """The program that answers a request."""
    return answer(request, request.backend, compiled_build, _linked, _interpreted)


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
    build = build_of(request)
    return _holder_type({"type": to_plain(Ref(build.types.holder.name), build.types.schema), "manners": build.manners})


def wires_of(request: Request) -> list[str]:
    """The names of the mapping's wires, where a request is for one that has several; nothing is compiled."""
    return build_of(request).wires


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
        return program_of(replace(self._request, direction="encode"))

    @cached_property
    def decode(self) -> Any:
        """The decoder: it is given bytes, and the holder to fill."""
        return program_of(self._request)

    def size(self, holder: Any) -> int:
        """How many bytes a holder takes."""
        return self.encode.size(holder)

    def new(self) -> Any:
        """A holder with room for what has been decoded until now."""
        return self.decode.new()


def program_of(request: Request, beside: Any = None) -> Any:
    """The decoder or encoder that answers a request; ``beside`` is one for another wire, with which it shares its holder and state."""
    return of_request(object_at(_CLASSES[request.direction]), request, beside)


def of_request(program: Any, request: Request, beside: Any = None) -> Any:
    """A program of a class, which answers a request; pickles name this function."""
    made = program.__new__(program)
    made._make(request, beside)
    return made
