"""rosbags: functions generated for each type, in Python, numpy where a field is an array of numbers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bench.peers.base import Peer

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

    from bench.subjects import Subject

TRANSFORMS = Path(__file__).resolve().parents[2] / "idl" / "ros1" / "tf2_msgs" / "TFMessage.msg"
MAKES = "a dataclass, anew; arrays are numpy views of the message, lists for the rest"


def store(encoding: str) -> Typestore:
    """The types of a ROS, as rosbags knows them, and of ROS 1 the one that it does not."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    if encoding != "ros1":
        return get_typestore(Stores.ROS2_HUMBLE)
    found = get_typestore(Stores.ROS1_NOETIC)
    found.register(get_types_from_msg(TRANSFORMS.read_text("utf-8"), "tf2_msgs/msg/TFMessage"))
    return found


def type_name(subject: Subject) -> str:
    """The name of a subject's type with `msg` in the middle."""
    package, *_, name = subject.type.split("/")
    return f"{package}/msg/{name}"


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding not in {"ros1", "cdr"}:
        return ()
    types, name = store(subject.encoding), type_name(subject)
    decode, encode = (
        (types.deserialize_ros1, types.serialize_ros1) if subject.encoding == "ros1" else (types.deserialize_cdr, types.serialize_cdr)
    )
    return (Peer("rosbags", MAKES, lambda message: decode(message, name), lambda value: encode(value, name)),)
