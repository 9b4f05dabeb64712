"""protobuf's Python package, which is upb in C, its classes made by protoc's descriptors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.peers.base import Peer

if TYPE_CHECKING:
    from bench.subjects import Subject

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (ROOT / "bench" / "native", ROOT / "idl")
FILES = ("angles.proto", "rst/vision/Image.proto")


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "protobuf":
        return ()
    made = _message_class(subject.type)
    from google.protobuf.internal import api_implementation

    who = f"protobuf ({api_implementation.Type()})"
    return (
        Peer(who, "a message, anew; fields are read through it", made.FromString, made.SerializeToString),
        # A message that is used again keeps all that it ever held, so that its memory grows.
        Peer(f"{who}, ParseFromString", "the same, used again", made().ParseFromString),
        *((Peer(f"{who}, as an array", "the numbers alone, a numpy array, anew", _array_of(made)),) if "Angles" in subject.type else ()),
    )


def _array_of(made: Any) -> Any:
    """What it takes to have what our holders have."""
    return lambda message: np.array(made.FromString(message).angles)


def _message_class(name: str) -> Any:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    pool, files = descriptor_pool.DescriptorPool(), descriptor_pb2.FileDescriptorSet()
    with TemporaryDirectory() as folder:
        target = Path(folder) / "set"
        # In a process of its own: it brings another libprotobuf than the C++ peer, and a process bears but one.
        protoc = [sys.executable, "-m", "grpc_tools.protoc", *(f"-I{each}" for each in FOLDERS)]
        subprocess.run([*protoc, f"--descriptor_set_out={target}", *FILES], check=True)
        files.ParseFromString(target.read_bytes())
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
