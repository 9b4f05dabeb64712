"""pybag-sdk: functions in Python that it writes for each definition, for ROS 1 and for ROS 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.peers.base import Peer
from bench.peers.mcap import definition

if TYPE_CHECKING:
    from bench.subjects import Subject


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding not in {"ros1", "cdr"}:
        return ()
    decode, encode = _ros1(subject) if subject.encoding == "ros1" else _ros2(subject)
    makes = "an object, anew; lists of numbers and of objects"
    if subject.encoding == "cdr":
        makes += ", bytes"
    return (Peer("pybag-sdk", makes, decode, encode),)


def _ros1(subject: Subject) -> tuple[Any, Any]:
    from pybag.encoding.rosmsg import RosMsgDecoder, RosMsgEncoder
    from pybag.mcap.records import SchemaRecord
    from pybag.schema.ros1_compiler import compile_ros1_schema, compile_ros1_serializer
    from pybag.schema.ros1msg import Ros1McapSchemaDecoder

    schema = Ros1McapSchemaDecoder().parse_schema(SchemaRecord(1, subject.type, "ros1msg", definition(subject, 1).encode()))
    read, write = compile_ros1_schema(*schema), compile_ros1_serializer(*schema)
    return _reused(RosMsgDecoder(subject.message), read), _written(RosMsgEncoder, write)


def _ros2(subject: Subject) -> tuple[Any, Any]:
    from pybag.encoding.cdr import CdrDecoder, CdrEncoder
    from pybag.mcap.records import SchemaRecord
    from pybag.schema.compiler import compile_schema, compile_serializer
    from pybag.schema.ros2msg import Ros2MsgSchemaDecoder

    schema = Ros2MsgSchemaDecoder().parse_schema(SchemaRecord(1, subject.type, "ros2msg", definition(subject, 2).encode()))
    read, write = compile_schema(*schema), compile_serializer(*schema)
    return _reused(CdrDecoder(subject.message), read), _written(CdrEncoder, write)


def _reused(decoder: Any, read: Any) -> Any:
    """As its readers do: one decoder for all messages."""
    return lambda message: read(decoder.reset(message))


def _written(encoder_type: Any, write: Any) -> Any:
    def encode(value: Any) -> bytes:
        encoder = encoder_type(little_endian=True)
        write(encoder, value)
        return encoder.save()

    return encode
