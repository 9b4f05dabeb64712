"""Messages of omniORB and Cyclone DDS: each decodes to its value and encodes to the same bytes, in both byte orders, in every backend."""

from __future__ import annotations

import json
import lzma
import struct
from functools import cache
from math import isnan
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.frameworks.ros2.idl import DUMMY
from rosetta_jit.runtime.holder import values

VECTORS = Path(__file__).resolve().parents[2] / "vectors"
SLOW = {"test_interface_files/MultiNested"}
"""Hundreds of arrays: compiling it takes half a minute."""


@cache
def vectors(framework):
    if framework == "ros2":
        return json.loads(lzma.decompress((VECTORS / "ros2" / "records.json.xz").read_bytes()))
    return json.loads((VECTORS / "corba" / "records.json").read_text())


def records(framework):
    by_type = {}
    for record in vectors(framework)["records"]:
        by_type.setdefault(record["type"], []).append(record)
    return by_type


def options(framework, name):
    known = vectors(framework)["definitions"]
    if framework == "ros2":
        return {"encoding": "cdr", "schema": known[name]}
    files = ("openrtm/BasicDataType.idl", "openrtm/ExtendedDataTypes.idl", "openrtm/InterfaceDataTypes.idl")
    if name.startswith("RJ::"):
        return {"encoding": "cdr-giop", "schema": {"rj.idl": known["rj.idl"]}}
    return {"encoding": "cdr-giop", "imports": files}


def check(framework, name, order, backend):
    given = options(framework, name)
    read = {} if framework == "ros2" else {"byte_order": order}
    decode = rj.Decoder.of(name, backend=backend, **given, **read)
    encode = rj.Encoder.of(name, backend=backend, byte_order=order, **given)
    for record in records(framework)[name]:
        if order in record:
            data = bytes.fromhex(record[order])
            holder = decode(data)
            assert same(numbers(holder), record["value"])
            assert encode(holder) == data


def numbers(holder):
    """The values of a holder, enumerators as numbers."""
    return values.read_record(holder.access_.record, holder.lanes_, 0, values.Form.RAW)


def same(ours, known):
    """Equal down to the sign of a zero; NaNs have no payload in the values, but their bytes are compared, too."""
    match known:
        case {"hex": digits}:
            return bytes(ours) == bytes.fromhex(digits)
        case {"_d": label, "_u": case}:
            return same(ours, {"_d": label, **case})
        case dict():
            return ours.keys() - {DUMMY} == known.keys() - {DUMMY} and all(same(ours[name], each) for name, each in known.items())
        case list():
            return len(ours) == len(known) and all(map(same, ours, known))
        case "nan" | "inf" | "-inf" if not isinstance(ours, str):
            return same(float(ours), float(known))
        case float():
            return (isnan(ours) and isnan(known)) or struct.pack("<d", ours) == struct.pack("<d", known)
        case _:
            return ours == known


def each_order():
    """Backend and byte order: the compiler makes the same of both, with other loads and stores."""
    return [("llvm", "little"), ("python", "big"), ("interpreter", "little")]


@pytest.mark.parametrize(("backend", "order"), each_order())
@pytest.mark.parametrize("name", sorted(records("corba")))
def test_omniorb(name, backend, order):
    check("corba", name, order, backend)


@pytest.mark.parametrize(("backend", "order"), each_order())
@pytest.mark.parametrize("name", sorted(set(records("ros2")) - SLOW))
def test_cyclone_dds(name, backend, order):
    check("ros2", name, order, backend)


@pytest.mark.parametrize("name", ["RJ::Arrays", "RJ::WithUnions", "RTC::TimedPoseVel3D"])
def test_big_endian_kernels(name):
    check("corba", name, "big", "llvm")


@pytest.mark.campaign
@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("backend", ["llvm", "numba", "python", "interpreter"])
@pytest.mark.parametrize(
    ("framework", "name"), [(framework, name) for framework in ("corba", "ros2") for name in sorted(records(framework))]
)
def test_all_of_both(framework, name, backend, order):
    check(framework, name, order, backend)
