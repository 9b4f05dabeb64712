"""mcap-ros1-support, which decodes with genpy's generated classes, and mcap-ros2-support, which walks the type for each message."""

from __future__ import annotations

from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.peers.base import Peer
from bench.peers.rosbags import store, type_name

if TYPE_CHECKING:
    from bench.subjects import Subject


def ros1_peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "ros1":
        return ()
    from mcap.records import Schema
    from mcap_ros1.decoder import DecoderFactory

    decode = DecoderFactory().decoder_for("ros1", Schema(1, definition(subject, 1).encode(), "ros1msg", subject.type))
    makes = "genpy's message class, anew; tuples, bytes and lists of objects"
    reused, viewing = decode(subject.message), decode(subject.message)
    return (
        Peer("mcap-ros1-support (genpy)", makes, decode, _serialized),
        Peer("genpy's deserialize", "the same, used again", reused.deserialize),
        # It does not write: its serialize_numpy calls what numpy has no more.
        Peer("genpy's deserialize_numpy", "the same, used again; arrays are numpy views of the message", partial(_viewed, viewing)),
    )


def ros2_peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "cdr":
        return ()
    from mcap_ros2._dynamic import generate_dynamic, serialize_dynamic

    name, text = subject.type, definition(subject, 2)
    decode, encode = generate_dynamic(name, text)[name], serialize_dynamic(name, text)[name]
    return (Peer("mcap-ros2-support", "a class with slots, anew; lists of numbers and of objects", decode, encode),)


def definition(subject: Subject, version: int) -> str:
    """The concatenated definitions that a bag carries."""
    text, _ = store(subject.encoding).generate_msgdef(type_name(subject), ros_version=version)
    return text


def _viewed(value: Any, message: bytes) -> Any:
    return value.deserialize_numpy(message, np)


def _serialized(value: Any) -> bytes:
    buffer = BytesIO()
    value.serialize(buffer)
    return buffer.getvalue()
