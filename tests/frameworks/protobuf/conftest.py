"""The same schema twice: as protobuf's own classes, in a pool of their own, and as ours."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from grpc_tools import protoc

from rosetta_jit.frameworks.protobuf.descriptors import from_message_class
from rosetta_jit.frameworks.protobuf.manners import PROTOBUF
from rosetta_jit.model.types import Ref
from rosetta_jit.runtime.holder import holder_class

PROTO = Path(__file__).resolve().parents[2] / "vectors" / "manners"


@pytest.fixture(scope="session")
def pool(tmp_path_factory):
    out = tmp_path_factory.mktemp("protoc") / "set"
    assert protoc.main(["protoc", f"-I{PROTO}", f"--descriptor_set_out={out}", "second.proto", "third.proto"]) == 0
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes()).file:
        pool.AddSerializedFile(file.SerializeToString())
    return pool


@pytest.fixture(scope="session")
def native(pool):
    return cache(lambda name: message_factory.GetMessageClass(pool.FindMessageTypeByName(name)))


@pytest.fixture(scope="session")
def ours(native):
    return cache(lambda name: holder_class(Ref(name), from_message_class(native(name)), PROTOBUF))


@pytest.fixture(params=["native", "ours"])
def message_class(request):
    """A function from the name of a message type to its class."""
    return request.getfixturevalue(request.param)


@pytest.fixture
def everything(message_class):
    return message_class("second.All")


@pytest.fixture
def plain(message_class):
    return message_class("third.Plain")
