"""Finding `.proto` files for tests, and asking protoc about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import grpc_tools

from rosetta_jit.source import Source

if TYPE_CHECKING:
    from rosetta_jit.parsing.idl import Load

TESTS = Path(__file__).parents[2]
IDL = TESTS.parent / "idl"
VECTORS = TESTS / "vectors" / "proto"
WRONG = TESTS / "golden" / "proto"
SHIPPED = Path(grpc_tools.__file__).parent / "_proto"


def load_from(*folders: Path) -> Load:
    def load(path: str) -> Source | None:
        found = (folder / path for folder in folders)
        return next((Source(path, file.read_text("utf-8")) for file in found if file.is_file()), None)

    return load


def names(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*.proto"))


def source(folder: Path, name: str) -> Source:
    return Source(name, (folder / name).read_text("utf-8"))


def protoc(folder: Path, name: str, out: Path) -> bytes | None:
    """The bytes of the descriptor set that protoc makes; None where it refuses the file."""
    from grpc_tools import protoc as compiler

    arguments = ["protoc", f"-I{folder}", f"-I{SHIPPED}", "--include_imports", f"--descriptor_set_out={out}", name]
    return out.read_bytes() if compiler.main(arguments) == 0 else None


def varint(value):
    """An integer as protobuf writes it, by its manual."""
    groups = []
    while value >= 0x80:
        groups.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes((*groups, value))
