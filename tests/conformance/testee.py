"""The program that protobuf's conformance_test_runner talks to: binary in, binary out, through our decoders and encoders.

    conformance_test_runner tests/conformance/testee.py

The schemas of the runner's messages are found in the folder that CONFORMANCE_PROTOS names: the `src` of protobuf's sources. With
CONFORMANCE_RECORD each request and its answer are appended to that file, as lines of hexadecimal digits.
"""

from __future__ import annotations

import os
import struct
import sys
from functools import cache
from pathlib import Path

import rosetta_jit as rj

BACKEND = os.environ.get("CONFORMANCE_BACKEND", "numba")
FILES = {
    "protobuf_test_messages.proto2.TestAllTypesProto2": "google/protobuf/test_messages_proto2.proto",
    "protobuf_test_messages.proto3.TestAllTypesProto3": "google/protobuf/test_messages_proto3.proto",
}
PROTOBUF = 1
PARSE_ERROR, RUNTIME_ERROR, PAYLOAD, SKIPPED, SERIALIZE_ERROR = 1, 2, 3, 5, 6
"""Numbers of fields of ConformanceResponse."""


@cache
def programs(name):
    options = {"imports": [FILES[name]], "search_path": [os.environ.get("CONFORMANCE_PROTOS", ".")], "backend": BACKEND}
    return rj.Decoder.of(name, **options), rj.Encoder.of(name, **options)


def answer(request):
    """The field of the response, and its content."""
    if request.protobuf is None or request.output != PROTOBUF:
        return SKIPPED, b"only binary messages"
    if request.type not in FILES:
        return SKIPPED, b"another message"
    decode, encode = programs(request.type)
    try:
        holder = decode(request.protobuf)
    except rj.DecodeError as error:
        return PARSE_ERROR, str(error).encode()
    try:
        return PAYLOAD, encode(holder)
    except rj.EncodeError as error:
        return SERIALIZE_ERROR, str(error).encode()


class Request:
    """A ConformanceRequest, read by hand: the fields that matter are all of a length or a varint."""

    def __init__(self, data):
        self.protobuf, self.output, self.type = None, 0, ""
        at = 0
        while at < len(data):
            tag, at = varint(data, at)
            if tag & 7 == 0:
                value, at = varint(data, at)
            else:
                size, at = varint(data, at)
                value, at = data[at : at + size], at + size
            match tag >> 3:
                case 1:
                    self.protobuf = value
                case 3:
                    self.output = value
                case 4:
                    self.type = value.decode()


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return value, at


def coded(number):
    """A number as a varint."""
    found = b""
    while number > 127:
        found, number = found + bytes([number & 127 | 128]), number >> 7
    return found + bytes([number])


def main():
    record = os.environ.get("CONFORMANCE_RECORD")
    while head := sys.stdin.buffer.read(4):
        data = sys.stdin.buffer.read(struct.unpack("<I", head)[0])
        field, content = answer(Request(data))
        response = coded(field << 3 | 2) + coded(len(content)) + content
        sys.stdout.buffer.write(struct.pack("<I", len(response)) + response)
        sys.stdout.buffer.flush()
        if record:
            with Path(record).open("a", encoding="ascii") as file:
                file.write(f"{data.hex()} {response.hex()}\n")


if __name__ == "__main__":
    main()
