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

IDL = Path(__file__).resolve().parents[2] / "idl"


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "protobuf":
        return ()
    made = message_class(subject)
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


def message_class(subject: Subject) -> Any:
    """The class of a subject's type, from the schema that it brings or the file that has the type's name."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    pool, found = descriptor_pool.DescriptorPool(), descriptor_pb2.FileDescriptorSet()
    schema: dict[str, str] = subject.options.get("schema", {})
    files = [*schema] or [subject.type.replace(".", "/") + ".proto"]
    with TemporaryDirectory() as folder:
        target = Path(folder) / "set"
        for name, text in schema.items():
            (Path(folder) / name).write_text(text, "utf-8")
        # In a process of its own: it brings another libprotobuf than the C++ peer, and a process bears but one.
        protoc = [sys.executable, "-m", "grpc_tools.protoc", f"-I{folder}", f"-I{IDL}"]
        subprocess.run([*protoc, "--include_imports", f"--descriptor_set_out={target}", *files], check=True)
        found.ParseFromString(target.read_bytes())
    for file in found.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(subject.type))
