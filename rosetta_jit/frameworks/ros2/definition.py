"""The definition of a message of ROS 2 as bags and MCAP files carry it: https://mcap.dev/spec/registry#ros2msg."""

from __future__ import annotations

from pathlib import PurePath

from rosetta_jit.frameworks.definitions import Definition, declared, sources
from rosetta_jit.frameworks.ros2.successors import LINE
from rosetta_jit.model.types import Schema, Struct


def definition(struct: Struct, schema: Schema) -> Definition | None:
    """The texts of its file and of those that it needs; None where some are no `.msg` files of one message each."""
    own = sources(struct, schema)
    if len(own) == 1 and own[0].name.endswith(".msg"):
        return Definition("ros2msg", own[0].text.encode())
    needed = {name: each.span.source for name, each in declared(struct, schema).items() if each.span is not None}
    if any(PurePath(source.name).name != f"{name.rpartition('/')[2]}.msg" for name, source in needed.items()):
        return None
    root, *others = needed
    parts = [needed[root].text, *(f"{LINE}\nMSG: {name.replace('/msg/', '/')}\n{needed[name].text}" for name in others)]
    return Definition("ros2msg", "\n".join(parts).encode())
