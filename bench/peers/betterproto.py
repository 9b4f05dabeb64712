"""betterproto2: protobuf in Python alone, a dataclass a message. It writes repeated numbers packed, whatever the schema says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.peers.base import Peer

if TYPE_CHECKING:
    from bench.subjects import Subject


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "protobuf":
        return ()
    made = _image() if subject.type == "rst.vision.Image" else _angles()
    encode = None if subject.type == "rj.JointAngles" else bytes
    return (Peer("betterproto2", "a dataclass, anew; a list of numbers, bytes", made.parse, encode),)


def _angles() -> Any:
    import betterproto2

    @dataclass(eq=False, repr=False)
    class JointAngles(betterproto2.Message):
        angles: list[float] = betterproto2.field(1, betterproto2.TYPE_DOUBLE, repeated=True)  # noqa: RUF009 - its way to declare one

    return JointAngles


def _image() -> Any:
    """The fields that are measured."""
    import betterproto2

    @dataclass(eq=False, repr=False)
    class Image(betterproto2.Message):
        data: bytes = betterproto2.field(1, betterproto2.TYPE_BYTES)
        width: int = betterproto2.field(2, betterproto2.TYPE_UINT32)
        height: int = betterproto2.field(3, betterproto2.TYPE_UINT32)

    return Image
