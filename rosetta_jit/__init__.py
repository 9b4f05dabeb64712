"""Declare how robot middlewares' data types relate; decode one's bytes into the other's data holders at machine speed.

import rosetta_jit as rj

decode = rj.Decoder("yarp/icub/torso_state.mapping")
angles = decode(message)                # the decoder's own holder, filled
encode = rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp4")
encode(angles)                          # bytes
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

from rosetta_jit.errors import (
    AddressError,
    BridgeError,
    BrokenPackage,
    CacheWarning,
    DecodeError,
    EncodeError,
    InUse,
    InvalidHolder,
    LogError,
    LogWarning,
    MappingError,
    MessageError,
    MissingPackage,
    ReportError,
    RosettaError,
    SchemaError,
    TransportError,
)
from rosetta_jit.startup import modules

if TYPE_CHECKING:
    from rosetta_jit.api.bridges import Bridge
    from rosetta_jit.api.decoder import Decoder
    from rosetta_jit.api.encoder import Encoder
    from rosetta_jit.api.options import Options
    from rosetta_jit.api.wires import Decoders, Encoders
    from rosetta_jit.diagnostics import Diagnostic
    from rosetta_jit.logs.log import Log
    from rosetta_jit.pipeline.checked_mapping import CheckedMapping
    from rosetta_jit.runtime.batches.batch import Batch
    from rosetta_jit.runtime.holder import Holder
    from rosetta_jit.transports.opening import call, publish, serve, subscribe

modules.install()

__version__ = "0.1.0"

__all__ = [
    "AddressError",
    "Batch",
    "Bridge",
    "BridgeError",
    "BrokenPackage",
    "CacheWarning",
    "DecodeError",
    "Decoder",
    "Decoders",
    "EncodeError",
    "Encoder",
    "Encoders",
    "Holder",
    "InUse",
    "InvalidHolder",
    "Log",
    "LogError",
    "LogWarning",
    "MappingError",
    "MessageError",
    "MissingPackage",
    "ReportError",
    "RosettaError",
    "SchemaError",
    "TransportError",
    "call",
    "check",
    "infer",
    "open",
    "publish",
    "serve",
    "subscribe",
]

_LAZY = {
    "Decoder": "rosetta_jit.api.decoder",
    "Encoder": "rosetta_jit.api.encoder",
    "Decoders": "rosetta_jit.api.wires",
    "Encoders": "rosetta_jit.api.wires",
    "Bridge": "rosetta_jit.api.bridges",
    "Batch": "rosetta_jit.runtime.batches.batch",
    "Holder": "rosetta_jit.runtime.holder",
    "Log": "rosetta_jit.logs.log",
    "call": "rosetta_jit.transports.opening",
    "publish": "rosetta_jit.transports.opening",
    "serve": "rosetta_jit.transports.opening",
    "subscribe": "rosetta_jit.transports.opening",
}
"""What needs numpy is imported when it is first used, so that `rosetta-jit --help` answers at once."""


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        from rosetta_jit.startup.garbage import imported

        found = globals()[name] = getattr(imported(_LAZY[name]), name)
        return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return ["__doc__", "__version__", *__all__]


def check(
    mapping: str,
    *,
    schema: Mapping[str, str] | None = None,
    search_path: Iterable[str] = (),
    parameters: Mapping[str, object] | None = None,
    encoding: str | None = None,
    framework: str | None = None,
) -> CheckedMapping:
    """Check a mapping in both directions without compiling it; returns its ``warnings`` and ``laws``.

    Parameters
    ----------
    schema
        File names and texts, as if they lay on the search path: the mapping's own, and what it imports.
    search_path
        Folders to search before all others.
    parameters
        What the mapping's parameters are; without them it is checked for all values that they may get.
    encoding, framework
        Whose an imported file is that several frameworks can read: a `.msg` file beside the mapping is one of ROS 2, if nothing says
        otherwise.

    Raises
    ------
    MappingError
        Everything that is wrong with the mapping and with what it imports.
    """
    from rosetta_jit.pipeline.checked_mapping import check_mapping

    return check_mapping(mapping, search_path, parameters, schema=schema, encoding=encoding, framework=framework)


def infer(messages: Iterable[bytes], *, name: str, encoding: str = "yarp") -> str:
    """Draft a schema from captured messages, as text: a bottle schema, or for ``encoding="protobuf"`` a `.proto` file.

    Raises
    ------
    DecodeError
        A message is no bottle, or none of protobuf.
    ReportError
        The messages cannot be described by one schema; it says which one differs, and where. Or the bytes of the encoding do not tell
        where a field begins.
    """
    from rosetta_jit.pipeline.infer import infer as draft

    return draft(messages, name=name, encoding=encoding)


def open(  # noqa: A001 - a log is opened as a file is
    path: str | os.PathLike[str],
    *,
    format: str | None = None,  # noqa: A002 - it is what the format is called
    check: bool = True,
    on_problem: Callable[[Diagnostic], object] | None = None,
    **options: Unpack[Options],
) -> Log:
    """Open a log, whatever its format. Its index is read, and nothing more; where it has none, it is gone through.

    Parameters
    ----------
    path
        A file or folder, ``-`` for standard input, or a URL that `fsspec` knows.
    format
        The name of its format, where neither its beginning nor its name tells.
    check
        Whether checksums are compared. What has another one is left out.
    on_problem
        Is told what is wrong with the file, as soon as it is noticed; by default that is a `LogWarning`. What can be read is read.
    **options
        Of all decoders: see `rosetta_jit.api.options.Options`.

    Raises
    ------
    LogError
        It cannot be read, or is no log that is known.
    """
    from rosetta_jit.logs.log import open_log

    return open_log(path, format=format, check=check, on_problem=on_problem, **options)
