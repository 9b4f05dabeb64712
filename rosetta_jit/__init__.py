"""Declare how robot middlewares' data types relate; decode one's bytes into the other's data holders at machine speed.

import rosetta_jit as rj

decode = rj.Decoder("yarp/icub/torso_state.mapping")
angles = decode(message)                # the decoder's own holder, filled
encode = rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp4")
encode(angles)                          # bytes
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosetta_jit.errors import (
    CacheWarning,
    DecodeError,
    EncodeError,
    InUse,
    InvalidHolder,
    MappingError,
    MessageError,
    ReportError,
    RosettaError,
    SchemaError,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rosetta_jit.api.programs import Decoder, Encoder
    from rosetta_jit.pipeline.checked_mapping import CheckedMapping
    from rosetta_jit.runtime.batch import Batch
    from rosetta_jit.runtime.holder import Holder

__version__ = "0.1.0"

__all__ = [
    "Batch",
    "CacheWarning",
    "DecodeError",
    "Decoder",
    "EncodeError",
    "Encoder",
    "Holder",
    "InUse",
    "InvalidHolder",
    "MappingError",
    "MessageError",
    "ReportError",
    "RosettaError",
    "SchemaError",
    "check",
    "infer",
]

_LAZY = {
    "Decoder": "rosetta_jit.api.programs",
    "Encoder": "rosetta_jit.api.programs",
    "Batch": "rosetta_jit.runtime.batch",
    "Holder": "rosetta_jit.runtime.holder",
}
"""What needs numpy is imported when it is first used, so that `rosetta-jit --help` answers at once."""


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        from rosetta_jit.startup.garbage import imported

        return getattr(imported(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def check(mapping: str, *, search_path: Iterable[str] = (), parameters: Mapping[str, object] | None = None) -> CheckedMapping:
    """Check a mapping in both directions without compiling it; returns its ``warnings`` and ``laws``.

    Without ``parameters``, it is checked for all values that its parameters may get.

    Raises
    ------
    MappingError
        Everything that is wrong with the mapping and with what it imports.
    """
    from rosetta_jit.pipeline.build import check_mapping

    return check_mapping(mapping, search_path, parameters)


def infer(messages: Iterable[bytes], *, name: str, encoding: str = "yarp") -> str:
    """Draft a bottle schema from captured messages, as text.

    Raises
    ------
    DecodeError
        A message is no bottle.
    ReportError
        The messages cannot be described by one schema; it says which one differs, and where.
    """
    from rosetta_jit.frameworks.yarp.infer import infer as draft

    return draft(messages, name=name, encoding=encoding)
