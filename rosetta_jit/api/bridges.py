"""Bridges as users make them: one program from the bytes of one wire to those of another."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, Self, TypedDict, Unpack, cast

from rosetta_jit.api.loading import answer, interpreted_kernel, library, sites_of
from rosetta_jit.api.options import Options, request_of, type_request
from rosetta_jit.model.layout import layout
from rosetta_jit.model.serial import from_plain
from rosetta_jit.pipeline.request import BridgeRequest, Request, ends
from rosetta_jit.runtime import run
from rosetta_jit.runtime.bridge import BridgeBase, LoadedBridge
from rosetta_jit.runtime.callable import callable_class, public_class
from rosetta_jit.runtime.registers import Kept
from rosetta_jit.startup.garbage import imported

if TYPE_CHECKING:
    from rosetta_jit.pipeline.bridge import BridgeBuild
    from rosetta_jit.pipeline.stages import StageName
    from rosetta_jit.pipeline.transcoding import TranscodingBuild


class BridgeOptions(TypedDict, total=False):
    """What can be said about a bridge besides its mappings.

    Attributes
    ----------
    decode, encode : dict
        The `Options` of what is read and of what is written: ``decode={"encoding": "yarp3"}``.
    decode_type, encode_type : str
        In place of a mapping, the type that is read or written: the data-holder of the other mapping, or, where that is of ROS 1 or of
        ROS 2, the type of the same name in the other one.
    """

    decode: Options
    encode: Options
    decode_type: str
    encode_type: str


class Bridge(BridgeBase):
    """Turns messages of one wire into messages of another: ``bridge(message)`` gives bytes. Nothing of Python is between them.

    The message is decoded by one mapping and encoded by the other, from the same memory; no holder comes into being. Bytes that both
    mappings only hand on, such as pixels, are copied once, from message to message.

    Parameters
    ----------
    decode_mapping : path or None
        The mapping whose wire is read. None reads the data-holder of the other one as its own framework encodes it.
    encode_mapping : path or None
        The mapping whose wire is written, with the same data-holder. None writes that data-holder as its own framework encodes it.
    **options
        See `BridgeOptions`.

    Raises
    ------
    MappingError, SchemaError
        With every mistake and its place; also where the mappings have different data-holders.

    Examples
    --------
    From a YARP bottle by way of ``rst.kinematics.JointAngles`` to its bytes, as protobuf has them:

    >>> bridge = rj.Bridge("yarp/icub/torso_state.mapping")
    """

    _request: BridgeRequest

    def __init__(
        self,
        decode_mapping: str | os.PathLike[str] | None,
        encode_mapping: str | os.PathLike[str] | None = None,
        **options: Unpack[BridgeOptions],
    ) -> None:
        sides = _sides(options)
        read, written = (None if each is None else os.fspath(each) for each in (decode_mapping, encode_mapping))
        decode = request_of("decode", sides["decode"], mapping=read, type_=options.get("decode_type"))
        encode = request_of("encode", sides["encode"], mapping=written, type_=options.get("encode_type"))
        self._make(BridgeRequest(decode, encode))

    @classmethod
    def of(
        cls, type_: str | type, encode_type: str | type | None = None, *, decode: Options | None = None, encode: Options | None = None
    ) -> Self:
        """A bridge without a mapping, between two encodings of a type.

        Parameters
        ----------
        type_
            Qualified name of the type that is read, or a message class of protobuf's Python package.
        encode_type
            The same of what is written, where another framework has a type of the same name with the same fields.
        decode, encode
            The `Options` of what is read and of what is written.
        """
        written = type_ if encode_type is None else encode_type
        request = BridgeRequest(type_request("decode", type_, decode or {}), type_request("encode", written, encode or {}))
        return _of_request(cls, request)

    @classmethod
    def between(cls, source: str, target: str) -> Self:
        """A bridge for any message that describes itself, from one encoding to another: ``Bridge.between("yarp3", "yarp4")``.

        It needs neither type nor mapping, and takes bottles with whatever is in them. What is no bottle is a `DecodeError`; so is a bottle
        with a vocab of 64 bits, which YARP 3 does not have, or with more than 256 lists within each other.
        """
        return _of_request(cls, BridgeRequest(Request("decode", encoding=source), Request("encode", encoding=target)))

    def stage(self, stage: StageName | str) -> str:
        """What the bridge became, as text: of both halves, or of the code, which is one."""
        return _build(self._request).stage(stage)

    @property
    def differences(self) -> tuple[str, ...]:
        """Where the two types are of ROS 1 and ROS 2: what becomes of fields that the other one names otherwise or does not have.

        It is made anew each time.
        """
        build = _build(self._request)
        from rosetta_jit.pipeline.bridge import BridgeBuild

        return build.differences if isinstance(build, BridgeBuild) else ()

    def announced(self, framework: str, half: Literal["decode", "encode"] = "encode") -> dict[str, str]:
        """What a publisher says of the type that this bridge writes, by the names of transports' options. It is made anew: keep it.

        Parameters
        ----------
        framework
            ``ros1``: ``type``, ``md5`` and ``definition``; ``ros2``: ``type`` and ``hash``; ``protobuf``, for events of RSB: ``type``.
        half
            ``decode`` asks for the type that the bridge reads, for a subscriber.

        Returns
        -------
        dict
            Empty where that is a type of another framework, or of none.
        """
        build = _build(self._request)
        from rosetta_jit.pipeline.bridge import BridgeBuild

        if not isinstance(build, BridgeBuild):
            return {}
        build_of = build.halves[half == "encode"]
        if build_of.wire_framework.name != framework:
            return {}
        return build_of.wire_framework.announced(build_of.types.wire, build_of.types.schema)

    def __repr__(self) -> str:
        return f"<Bridge from {ends(self._request.decode)} to {ends(self._request.encode)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are made anew from the request, by the cache of their process: they share code, and no memory."""
        return _of_request, (public_class(self), self._request)

    def _make(self, request: BridgeRequest) -> None:
        """Become the bridge that answers a request."""
        self._request = request
        self._start(cast("LoadedBridge", answer(request, request.decode.backend, _build, _linked, _interpreted)))


def _sides(options: BridgeOptions) -> dict[str, Options]:
    unknown = sorted(set(options) - BridgeOptions.__annotations__.keys())
    if unknown:
        raise TypeError(f"unknown option {unknown[0]!r}; a bridge has options of two halves: decode={{…}} and encode={{…}}")
    return {"decode": options.get("decode", {}), "encode": options.get("encode", {})}


def _of_request(program: Any, request: BridgeRequest) -> Any:
    made = program.__new__(program)
    made._make(request)
    return made


def _build(request: BridgeRequest) -> BridgeBuild | TranscodingBuild:
    imported("rosetta_jit.pipeline.bridge")
    from rosetta_jit.pipeline.bridge import BridgeBuild, is_open

    if is_open(request.decode) and is_open(request.encode) and request.decode.encoding and request.encode.encoding:
        from rosetta_jit.pipeline.transcoding import TranscodingBuild

        return TranscodingBuild(request)
    return BridgeBuild(request)


def _linked(header: Mapping[str, Any], image: bytes) -> LoadedBridge:
    """A bridge from its object code."""
    code = library(image, header)
    kernels = run.native_run(code["kernel"]), run.native_run(code["size"]), run.native_run(code["write"])
    return _loaded(header, kernels, code)


def _interpreted(build: BridgeBuild | TranscodingBuild) -> LoadedBridge:
    """A bridge that runs in Python."""
    decode, size, write = (interpreted_kernel(build, number) for number in range(3))
    return _loaded(build.header, (decode, size, write), None)


def _loaded(header: Mapping[str, Any], kernels: tuple[run.Run, run.Run, run.Run], code: Any) -> LoadedBridge:
    return LoadedBridge(
        layout=layout(*from_plain(header["type"])),
        kernels=kernels,
        sites=tuple(sites_of(header, number) for number in range(3)),
        references=tuple(header["references"]),
        library=code,
        asks_host=header["asks_host"],
        limit=header["limit"],
        state=Kept.of(header["state"]),
    )


if not TYPE_CHECKING:
    Bridge = callable_class(Bridge)
