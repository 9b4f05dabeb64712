"""Which API the classes have that generated C++ fills and reads: a table. What stands in the code is in the folder `manners`, in C++.

A section `KIND decode` is what a decoder writes for a field of that kind, `KIND encode` what an encoder does; in them `$object` is what has
the field, `$field` its name, `$at` the field itself, `$row` what the kernel made, or reads, of it, and `$lane` where its elements lie. A
holder without a section cannot have such fields. `laid out` is empty where a class does not show how its fields lie in memory.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

from rosetta_jit.model.types import Struct, name_parts
from rosetta_jit.startup.dataclass import dataclass

FOLDER = Path(__file__).with_name("manners")
HEAD = re.compile(r"^/\* == (.*?) == \*/\n", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Manners:
    """One kind of classes.

    Attributes
    ----------
    name
        What ``--holder`` calls it.
    summary
        One line for who chooses.
    templates
        Files of sections; later ones replace sections of earlier ones.
    type
        The class of a struct, as C++ names it; None where it is generated.
    header
        The header that declares it.
    lower
        Fields are named in lower case.
    renamed
        Fields that the classes name otherwise than the schema: by struct and field.
    byte_flags
        Arrays of bools have a byte for each, as rows have.
    reserved
        Names of fields and classes behind which the framework's generator writes an underscore.
    around
        Files of further classes around the codec, by what they are for.
    framework
        The framework that declares the types which have such classes; empty where all have.
    """

    name: str
    summary: str
    templates: tuple[str, ...]
    type: Callable[[Struct], str] | None = None
    header: Callable[[Struct], str] | None = None
    lower: bool = False
    byte_flags: bool = False
    renamed: tuple[tuple[tuple[str, str], str], ...] = ()
    reserved: frozenset[str] = frozenset()
    around: tuple[str, ...] = ()
    framework: str = ""

    def sections(self) -> Mapping[str, str]:
        """The templates by what they are for."""
        return _sections(self.templates)


@cache
def _sections(files: tuple[str, ...]) -> Mapping[str, str]:
    found: dict[str, str] = {}
    for file in files:
        _, *parts = HEAD.split((FOLDER / f"{file}.cpp").read_text("utf-8"))
        found |= {name: body.strip("\n") for name, body in zip(parts[::2], parts[1::2], strict=True)}
    return found


def _joined(struct: Struct) -> str:
    return "::" + "::".join(re.split(r"[./:]+", struct.name.strip(":./")))


def _nested(struct: Struct) -> str:
    """Messages within others: protoc joins their names by underscores, and writes one behind its keywords."""
    parts = struct.name.split(".")
    first, named = len(parts) - 1 - int(struct.option("nested") or 0), ""
    for part in parts[first:]:
        named = f"{named}_{part}" if named else part
        named = f"{named}_" if named in PROTOC else named
    return "::" + "::".join((*parts[:first], named))


def _proto_header(struct: Struct) -> str:
    """As `protoc --cpp_out` names it: below the folder that the package begins at, if the file lies in such folders."""
    source = struct.span.source.name.replace("\\", "/") if struct.span is not None else f"{struct.name.replace('.', '/')}.proto"
    folders, package = source.split("/"), struct.name.split(".")[:-1]
    first = next((number for number in range(len(folders)) if package and folders[number : number + len(package)] == package), None)
    path = "/".join(folders[first:]) if first is not None else folders[-1]
    return f"{path.removesuffix('.proto')}.pb.h"


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def _ros2_header(struct: Struct) -> str:
    package, name = name_parts(struct.name)[0], name_parts(struct.name)[-1]
    return f"{package}/msg/{_snake(name)}.hpp"


_PROTOC = """
NULL alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl const constexpr const_cast continue
decltype default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long
mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast return
short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef typeid
typename union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
PROTOC = frozenset(_PROTOC.split())
"""Its keywords (cpp/cpp_helpers.cc of protobuf 3.21; later ones have those of C++20, too)."""

TIMES = tuple(((struct, field), name) for struct in ("time", "duration") for field, name in (("secs", "sec"), ("nsecs", "nsec")))

MANNERS = (
    Manners("own", "classes that are generated, too: vectors, strings, optional, variant", ("fields", "own")),
    Manners(
        "protobuf",
        "the classes that protoc generates",
        ("fields", "protobuf"),
        _nested,
        _proto_header,
        lower=True,
        reserved=PROTOC,
        framework="protobuf",
    ),
    Manners(
        "ros1",
        "the structs of roscpp",
        ("fields",),
        _joined,
        lambda struct: f"{'/'.join(name_parts(struct.name))}.h",
        byte_flags=True,
        renamed=TIMES,
        framework="ros1",
    ),
    Manners("ros2", "the structs of rclcpp", ("fields",), _joined, _ros2_header, renamed=TIMES, framework="ros2"),
    Manners(
        "lcm",
        "the classes that lcm-gen generates",
        ("fields", "lcm"),
        _joined,
        lambda struct: f"{struct.name.replace('.', '/')}.hpp",
        byte_flags=True,
        framework="lcm",
    ),
    Manners("yarp", "own classes, with a yarp::os::Portable around them", ("fields", "own"), around=("portable",)),
    Manners(
        "rsb",
        "protoc's classes, with a converter for RSB",
        ("fields", "protobuf"),
        _nested,
        _proto_header,
        lower=True,
        reserved=PROTOC,
        around=("converter",),
        framework="protobuf",
    ),
)
"""Every kind, by the name of whose classes they are."""
