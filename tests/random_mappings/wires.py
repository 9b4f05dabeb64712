"""The IDLs in which random types are declared, and their encodings."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, assert_never

from tests.random_mappings.message_types import CONSTANTS, OCTETS, Array, Choice, Enum, Kind, Map, Maybe, Message, Scalar, Types

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Iterator, Mapping

INTEGERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
ROS = {each: each for each in (*INTEGERS, "float32", "float64", "bool", "string")}
IDL = {
    "uint8": "octet",
    "int16": "short",
    "uint16": "unsigned short",
    "int32": "long",
    "uint32": "unsigned long",
    "int64": "long long",
    "uint64": "unsigned long long",
    "float32": "float",
    "float64": "double",
    "bool": "boolean",
    "string": "string",
}
PROTO = {"int32": "int32", "uint32": "fixed32", "int64": "sint64", "uint64": "uint64", "float32": "float", "float64": "double"}
LCM = {f"int{bits}": f"int{bits}_t" for bits in (8, 16, 32, 64)}
BOTTLE = {"int8": ":int8", "int16": ":int16", "int32": ":int", "int64": ":int64", "float32": ":float32", "float64": ":double"}


@dataclass(frozen=True)
class Wire:
    """An IDL with an encoding: what its types are called, and how a message is declared."""

    scalars: Mapping[str, str]
    path: str
    """How a type is named, from its name."""
    declare: Callable[[Message, Mapping[str, str]], dict[str, str]]
    options: Mapping[str, Any]
    written: Mapping[str, Any] = field(default_factory=dict)
    """More options of encoders."""
    has_optional: bool = False
    has_unions: bool = False
    has_named_unions: bool = True
    has_fixed: bool = True
    requires: bool = False
    """Whether what is not optional must be there."""
    map_keys: tuple[str, ...] = ()
    """The types of the keys that maps may have."""
    constant: str = ""
    """How a constant of an enum is named, from its name; empty where there are none."""

    def types(self, rng: random.Random) -> Types:
        return Types(rng, tuple(self.scalars), self.has_optional, self.has_unions, self.has_named_unions)

    def files(self, message: Message) -> dict[str, str]:
        return self.declare(message, self.scalars)

    def type_name(self, message: Message) -> str:
        return self.path.format(name=message.name, package=package(message))

    def constant_name(self, message: Message, constant: str) -> str:
        return self.constant.format(package=package(message), constant=constant)


def package(message: Message) -> str:
    """The module of what a message declares, in the IDLs that have modules."""
    return f"{message.name.lower()}_types"


def inner(message: Message) -> Iterator[Message | Choice | Enum]:
    """All that a message declares, what is used before what uses it."""
    for kind in message.fields.values():
        match kind:
            case Message():
                yield from inner(kind)
            case Array(Message() as element, _) | Maybe(Message() as element):
                yield from inner(element)
            case Choice() | Enum():
                yield kind
            case Scalar() | Array() | Maybe() | Map():
                pass
            case _:
                assert_never(kind)
    yield message


# --- ROS -----------------------------------------------------------------------------------------------------------------


def ros_type(kind: Kind, scalars: Mapping[str, str]) -> str:
    match kind:
        case Scalar(type_):
            return scalars[type_]
        case Array(element, size):
            return f"{ros_type(element, scalars)}[{'' if size is None else size}]"
        case Message(name, _):
            return name
        case Maybe(each):
            return f"@optional {ros_type(each, scalars)}"
        case Choice() | Enum() | Map():
            raise AssertionError(kind)
        case _:
            assert_never(kind)


def ros(folder: str) -> Callable[[Message, Mapping[str, str]], dict[str, str]]:
    def declare(message: Message, scalars: Mapping[str, str]) -> dict[str, str]:
        return {
            f"{folder}/{each.name}.msg": "".join(f"{ros_type(kind, scalars)} {name}\n" for name, kind in each.fields.items())
            for each in inner(message)
            if isinstance(each, Message)
        }

    return declare


# --- OMG IDL -------------------------------------------------------------------------------------------------------------


def idl_field(kind: Kind, name: str, scalars: Mapping[str, str]) -> str:
    match kind:
        case Scalar(type_):
            return f"{scalars[type_]} {name};"
        case Array(element, size):
            base = idl_field(element, "", scalars)[:-2]
            return f"sequence<{base}> {name};" if size is None else f"{base} {name}[{size}];"
        case Enum():
            return f"Mode {name};"
        case Message(type_, _) | Choice(type_, _, _):
            return f"{type_} {name};"
        case Maybe(each):
            return f"@optional {idl_field(each, name, scalars)}"
        case Map():
            raise AssertionError(kind)
        case _:
            assert_never(kind)


def idl(extensibility: str) -> Callable[[Message, Mapping[str, str]], dict[str, str]]:
    def declare(message: Message, scalars: Mapping[str, str]) -> dict[str, str]:
        parts = [f"enum Mode {{ {', '.join(CONSTANTS)} }};"]
        for each in inner(message):
            match each:
                case Message(name, fields):
                    shown = " ".join(idl_field(kind, at, scalars) for at, kind in fields.items())
                    parts.append(f"{extensibility} struct {name} {{ {shown} }};")
                case Choice(name, cases, _):
                    shown = " ".join(
                        f"case {number + 1}: {idl_field(kind, at, scalars)}" for number, (at, kind) in enumerate(cases.items())
                    )
                    parts.append(f"{extensibility.replace('@mutable', '')} union {name} switch (long) {{ {shown} }};")
                case Enum():
                    pass
                case _:
                    assert_never(each)
        return {f"{message.name}.idl": f"module {package(message)} {{\n" + "\n".join(parts) + "\n};\n"}

    return declare


# --- protobuf ------------------------------------------------------------------------------------------------------------


def proto_field(kind: Kind, name: str, number: int, scalars: Mapping[str, str], label: str) -> str:
    match kind:
        case Scalar(type_):
            return f"{label}{scalars[type_]} {name} = {number};"
        case Array() if kind == OCTETS:
            return f"{label}bytes {name} = {number};"
        case Array(element, _):
            return f"repeated {proto_field(element, name, number, scalars, '')}"
        case Enum():
            return f"{label}Mode {name} = {number};"
        case Message(type_, _):
            return f"{label}{type_} {name} = {number};"
        case Maybe(each):
            return proto_field(each, name, number, scalars, "optional ")
        case Choice(_, cases, _):
            shown = " ".join(proto_field(each, at, number + extra, scalars, "") for extra, (at, each) in enumerate(cases.items()))
            return f"oneof {name}_of {{ {shown} }}"
        case Map(key, value):
            return f"map<{scalars[key]}, {scalars[value]}> {name} = {number};"
        case _:
            assert_never(kind)


def proto(syntax: str) -> Callable[[Message, Mapping[str, str]], dict[str, str]]:
    label = "required " if syntax == "proto2" else ""

    def declare(message: Message, scalars: Mapping[str, str]) -> dict[str, str]:
        parts = [f'syntax = "{syntax}"; package {package(message)};']
        parts.append(f"enum Mode {{ {' '.join(f'{name} = {number};' for number, name in enumerate(CONSTANTS))} }}")
        for each in inner(message):
            if isinstance(each, Message):
                fields = each.fields.items()
                shown = "\n  ".join(proto_field(kind, name, 3 * at + 1, scalars, label) for at, (name, kind) in enumerate(fields))
                parts.append(f"message {each.name} {{\n  {shown}\n}}")
        return {f"{message.name}.proto": "\n".join(parts)}

    return declare


# --- LCM and YARP --------------------------------------------------------------------------------------------------------


def lcm_field(kind: Kind, name: str, scalars: Mapping[str, str]) -> str:
    match kind:
        case Scalar(type_):
            return f"{scalars[type_]} {name};"
        case Array(element, size):
            base = lcm_field(element, "", scalars)[:-2]
            return f"{base} {name}[{size}];" if size is not None else f"int32_t n_{name}; {base} {name}[n_{name}];"
        case Message(type_, _):
            return f"{type_} {name};"
        case Maybe() | Choice() | Enum() | Map():
            raise AssertionError(kind)
        case _:
            assert_never(kind)


def lcm(message: Message, scalars: Mapping[str, str]) -> dict[str, str]:
    parts = [
        f"struct {each.name} {{ {' '.join(lcm_field(kind, name, scalars) for name, kind in each.fields.items())} }}"
        for each in inner(message)
        if isinstance(each, Message)
    ]
    return {f"{message.name}.lcm": f"package {package(message)};\n" + "\n".join(parts)}


def bottle_type(kind: Kind, scalars: Mapping[str, str]) -> str:
    match kind:
        case Scalar(type_):
            return scalars[type_]
        case Array() if kind == OCTETS:
            return ":blob"
        case Array(element, size):
            return f"(:list {bottle_type(element, scalars)}{'' if size is None else f' (:length {size})'})"
        case Message(_, fields):
            return f"(:bottle {bottle_fields(fields, scalars)})"
        case Map(_, value):
            return f"(:dict {scalars[value]})"
        case Maybe() | Choice() | Enum():
            raise AssertionError(kind)
        case _:
            assert_never(kind)


def bottle_fields(fields: Mapping[str, Kind], scalars: Mapping[str, str]) -> str:
    return " ".join(f'("{name}" {bottle_type(kind, scalars)})' for name, kind in fields.items())


def bottle(message: Message, scalars: Mapping[str, str]) -> dict[str, str]:
    return {f"{message.name}.bottle-schema": f'"{message.name}" ({bottle_fields(message.fields, scalars)})'}


# --- all of them ---------------------------------------------------------------------------------------------------------

WORDS = {"bool": "bool", "string": "string"}
DDS: dict[str, Any] = {
    "scalars": {**IDL, "int8": "int8"},
    "path": "{package}::{name}",
    "constant": "{package}::Mode::{constant}",
    "has_optional": True,
    "has_unions": True,
}
PROTOBUF: dict[str, Any] = {
    "scalars": {**PROTO, **WORDS},
    "path": "{package}.{name}",
    "constant": "{package}.Mode.{constant}",
    "options": {"encoding": "protobuf"},
    "has_optional": True,
    "has_unions": True,
    "has_named_unions": False,
    "has_fixed": False,
    "map_keys": ("string", "int32", "int64"),
}
BIG = {"byte_order": "big"}
LITTLE = {"byte_order": "little"}

WIRES: dict[str, Wire] = {
    "ros1": Wire(ROS, "lab/{name}", ros("lab"), {"encoding": "ros1"}),
    "ros2": Wire(ROS, "lab/msg/{name}", ros("lab/msg"), {"encoding": "cdr"}, LITTLE),
    "ros2-big": Wire(ROS, "lab/msg/{name}", ros("lab/msg"), {"encoding": "cdr"}, BIG),
    "cdr": Wire(declare=idl("@final"), options={"encoding": "cdr"}, written=LITTLE, **DDS),
    "cdr-mutable": Wire(declare=idl("@mutable"), options={"encoding": "cdr"}, written=BIG, **DDS),
    "cdr2-final": Wire(declare=idl("@final"), options={"encoding": "cdr2"}, written=BIG, **DDS),
    "cdr2-appendable": Wire(declare=idl("@appendable"), options={"encoding": "cdr2"}, written=LITTLE, **DDS),
    "cdr2-mutable": Wire(declare=idl("@mutable"), options={"encoding": "cdr2"}, written=LITTLE, **DDS),
    "corba": Wire(**{**DDS, "scalars": IDL, "has_optional": False}, declare=idl(""), options={"encoding": "cdr-giop", "byte_order": "big"}),
    "lcm": Wire(
        {**LCM, "uint8": "byte", "float32": "float", "float64": "double", "bool": "boolean", "string": "string"},
        "{package}.{name}",
        lcm,
        {"encoding": "lcm"},
    ),
    "yarp3": Wire({**BOTTLE, "bool": ":bool", "string": ":string"}, "{name}", bottle, {"encoding": "yarp3"}, map_keys=("string",)),
    "yarp4": Wire({**BOTTLE, "bool": ":bool", "string": ":string"}, "{name}", bottle, {"encoding": "yarp4"}, map_keys=("string",)),
    "proto2": Wire(declare=proto("proto2"), requires=True, **PROTOBUF),
    "proto3": Wire(declare=proto("proto3"), **PROTOBUF),
}
