"""Cyclone DDS's Python package, its types made from the same definitions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bench.peers.base import Peer
from bench.peers.rosbags import store, type_name

if TYPE_CHECKING:
    from bench.subjects import Subject

MAKES = "a dataclass, anew; lists of numbers and of objects"


def peers(subject: Subject) -> tuple[Peer, ...]:
    if subject.encoding != "cdr":
        return ()
    from cyclonedds.idl import types

    made = _Types(store("cdr").fielddefs, types).struct(type_name(subject))
    return (Peer("cyclonedds", MAKES, made.deserialize, lambda value: value.serialize()),)


class _Types:
    """Cyclone's classes for ROS 2's types."""

    def __init__(self, definitions: Any, types: Any) -> None:
        self._definitions, self._types = definitions, types
        self._made: dict[str, Any] = {}

    def struct(self, name: str) -> Any:
        if name not in self._made:
            from cyclonedds.idl import make_idl_struct

            _, members = self._definitions[name]
            fields = {member: self._type(*type_) for member, type_ in members}
            self._made[name] = make_idl_struct(name.replace("/", "_"), name.replace("/", "::"), fields)
        return self._made[name]

    def _type(self, kind: int, described: Any) -> Any:
        match int(kind):
            case 1:
                return str if described[0] == "string" else bool if described[0] == "bool" else self._number(described[0])
            case 2:
                return self.struct(described)
            case 3:
                return self._types.array[self._type(*described[0]), described[1]]
            case _:
                return self._types.sequence[self._type(*described[0])]

    def _number(self, name: str) -> Any:
        return getattr(self._types, {"byte": "uint8", "octet": "uint8"}.get(name, name))
