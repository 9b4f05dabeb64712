"""Messages of the real peers of every framework, by type: what the other tests decode, for programs in C."""

from __future__ import annotations

import base64
import json
import lzma
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import rosetta_jit as rj
from rosetta_jit.api.options import request_of, type_request

VECTORS = Path(__file__).resolve().parents[1] / "vectors"
OPENRTM = ("openrtm/BasicDataType.idl", "openrtm/ExtendedDataTypes.idl", "openrtm/InterfaceDataTypes.idl")


@dataclass(frozen=True)
class Corpus:
    """The messages of one type, and what is said of it: for decoders ``read`` besides."""

    framework: str
    type: str
    options: dict[str, Any]
    messages: tuple[bytes, ...]
    mapping: bool = False

    @property
    def name(self) -> str:
        return f"{self.framework} {self.type} {self.options.get('byte_order', '')}".rstrip()

    @property
    def request(self):
        """For source in C."""
        return type_request("decode", self.type, self.options)

    def programs(self):
        """The library's own decoder and encoder."""
        return rj.Decoder.of(self.type, **self.options), rj.Encoder.of(self.type, **self.options)

    def of(self, count: int) -> Corpus:
        """With fewer messages."""
        return replace(self, messages=self.messages[:count])


@cache
def corpora() -> tuple[Corpus, ...]:
    """All of them."""
    return (*_lcm(), *_ros1(), *_ros2(), *_corba(), *_orocos(), *_protobuf())


def _by_type(records, bytes_of):
    found: dict[str, list[bytes]] = {}
    for record in records:
        found.setdefault(record["type"], []).append(bytes.fromhex(record[bytes_of]))
    return {name: tuple(dict.fromkeys(messages)) for name, messages in found.items()}


def _read(path):
    return json.loads((VECTORS / path).read_text())


def _lcm():
    for name, messages in _by_type(_read("lcm/records.json"), "bytes").items():
        yield Corpus("lcm", name, {"encoding": "lcm"}, messages)


def _ros1():
    known = _read("ros/ros1.json")
    schema = {f"{name.replace('/', '/msg/')}.msg": each["definition"] for name, each in known["definitions"].items()}
    for name, messages in _by_type(known["records"], "hex").items():
        yield Corpus("ros1", name, {"encoding": "ros1", "schema": schema, "framework": "ros1"}, messages)


def _ros2():
    known = json.loads(lzma.decompress((VECTORS / "ros2" / "records.json.xz").read_bytes()))
    for order in ("little", "big"):
        records = [record for record in known["records"] if order in record]
        for name, messages in _by_type(records, order).items():
            if "MultiNested" not in name:
                yield Corpus("ros2", name, {"encoding": "cdr", "schema": known["definitions"][name], "byte_order": order}, messages)


def _corba():
    known = _read("corba/records.json")
    for order in ("little", "big"):
        for name, messages in _by_type([record for record in known["records"] if order in record], order).items():
            files = {"schema": {"rj.idl": known["definitions"]["rj.idl"]}} if name.startswith("RJ::") else {"imports": OPENRTM}
            yield Corpus("corba", name, {"encoding": "cdr-giop", "byte_order": order, **files}, messages)
    wide = _read("corba/omniorb.json")
    for order in ("little", "big"):
        for name, messages in _by_type([record for record in wide["written"] if order in record], order).items():
            if name in ("RTC::TimedWString", "RTC::TimedWChar", "RTC::TimedWCharSeq"):
                yield Corpus("corba", name, {"encoding": "cdr-giop", "byte_order": order, "schema": wide["definitions"]}, messages)


def _orocos():
    known = _read("orocos/rtt-mqueue.json")
    for name, messages in _by_type(known["records"], "bytes").items():
        yield Corpus("orocos", name, {"encoding": "rtt-mqueue", "schema": known["definitions"]}, messages)


def _protobuf():
    known = _read("protobuf/peer.json")
    schema = base64.b64decode(known["file_descriptor_set_b64"])
    for name, messages in _by_type(known["records"], "hex").items():
        yield Corpus("protobuf", name, {"encoding": "protobuf", "schema": schema}, messages)


NUMBERS = {
    "a.bottle-schema": '"a" (("s" :string) ("f" :string) ("t" :string))',
    "b.proto": 'syntax = "proto3"; package b; message Number { double x = 1; float g = 2; double y = 3; }',
    "m.mapping": """import "a.bottle-schema"
import "b.proto"
data-holder: b.Number
wire-schema: a
unpack-rules:
  .x = number(.s)
  .g = float32(number(.f))
  .y = number(.t)
pack-rules:
  .s = text(.x)
  .f = text(.g)
  .t = text(.y, 3)
""",
}


def numbers_in_texts():
    """A mapping that reads and writes decimal numbers: its request, the library's programs, and messages."""
    options: Any = {"schema": NUMBERS, "encoding": "yarp3"}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    values = (0.0, -0.1, 1e22, 5e-324, 123456.789, -(2.0**-97), 1.7976931348623157e308, float("inf"), float("nan"), 1 / 3)
    messages = [
        encode({"x": value, "g": value if abs(value) < 1e38 else 0.25, "y": value if abs(value) < 1e15 else 0.0625}) for value in values
    ]
    return request_of("decode", options, mapping="m.mapping"), (decode, encode), messages
