"""What can be said about a program, and the request that it becomes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypedDict

from rosetta_jit.pipeline.request import Backend, ByteOrder, Direction, GivenFunction, Request, plain_parameters
from rosetta_jit.startup.dataclass import replace


class Options(TypedDict, total=False):
    """What can be said about a program besides its mapping or type.

    Attributes
    ----------
    encoding : str
        How messages are encoded; the usual way of the wire's framework by default (``yarp``: any of YARP's dialects).
    framework : str
        Whose type it is, where neither its name nor its file nor ``encoding`` tells: ``sensor_msgs/Imu`` is one of ROS 1 and of ROS 2.
    imports : iterable of str
        For a type without a mapping: the files that declare it, as paths or by their names on the search path; by default those in
        ``schema``, or what the name suggests.
    schema : mapping of str to str, str, or bytes
        File names and texts, as if they lay on the search path. Without a mapping also the one text that declares the type, such as a
        bag or an MCAP file carries (``encoding`` or ``framework`` say in which language), or a serialised ``FileDescriptorSet``.
    search_path : iterable of paths
        Folders to search before all others.
    byte_order : {"little", "big"}
        Of what is written, or of what is read where messages do not tell.
    lenient : iterable of str
        What to forgive, by name: ``rosetta-jit frameworks`` lists what each encoding can be asked for.
    parameters : mapping of str to value
        What the mapping's parameters are: bools, numbers, texts, and lists of these. They are compiled into the program.
    borrow : bool
        Leave bytes fields in the message: the holder keeps it alive and shows views. Decoders only.
    functions : mapping of str to callable
        The functions that the mapping declares, by name: Python functions of numbers, or numba's. They are compiled into the kernel.
    backend : {"numba", "llvm", "python", "interpreter"} or str
        What runs the kernel, also an installed one by its name; LLVM by default. numba types it on its way to LLVM, which takes longer
        and gives the same code.
    wire : str
        The name of one wire, of a mapping that has several.
    """

    encoding: str | None
    framework: str | None
    imports: Iterable[str]
    schema: Mapping[str, str] | str | bytes | None
    search_path: Iterable[str | os.PathLike[str]]
    byte_order: ByteOrder | None
    lenient: Iterable[str]
    parameters: Mapping[str, object]
    borrow: bool
    functions: Mapping[str, Callable[..., Any]]
    backend: Backend | None
    wire: str | None


_KNOWN = {"decode": frozenset(Options.__annotations__), "encode": frozenset(Options.__annotations__) - {"borrow"}}


def request_of(direction: Direction, options: Options, *, mapping: str | None = None, type_: str | None = None) -> Request:
    """The request for a program of a mapping, or of a type; raises TypeError where there is no such option."""
    unknown = sorted(set(options) - _KNOWN[direction])
    if unknown:
        raise TypeError(f"unknown option {unknown[0]!r}; there are {', '.join(sorted(_KNOWN[direction]))}")
    schema = options.get("schema")
    return Request(
        direction,
        mapping=mapping,
        type=type_,
        encoding=options.get("encoding"),
        framework=options.get("framework"),
        imports=tuple(options.get("imports", ())),
        files=(("", schema),) if isinstance(schema, str) else () if schema is None or isinstance(schema, bytes) else tuple(schema.items()),
        folders=tuple(os.fspath(folder) for folder in options.get("search_path", ())),
        borrow=options.get("borrow", False),
        byte_order=options.get("byte_order"),
        lenient=tuple(sorted(options.get("lenient", ()))),
        parameters=plain_parameters(options.get("parameters", {})),
        functions=_identified(options.get("functions", {})),
        backend=options.get("backend"),
        wire=options.get("wire"),
    )


def _identified(functions: Mapping[str, Callable[..., Any]]) -> tuple[GivenFunction, ...]:
    if not functions:
        return ()
    from rosetta_jit.runtime.functions.identity import identify

    return tuple(GivenFunction(name, each, identify(each, name)) for name, each in sorted(functions.items()))


def is_mapping(name: str) -> bool:
    """Whether a name is that of a mapping and not of a type: names of mappings end with ``.mapping``, and files are mappings."""
    return name.endswith(".mapping") or os.path.isfile(name)  # noqa: PTH113 - to import pathlib takes a tenth of a warm start


def named_request(direction: Direction, name: str, options: Options) -> Request:
    """The request for a program of a mapping or a type, as a user names it."""
    return request_of(direction, options, mapping=name) if is_mapping(name) else type_request(direction, name, options)


def type_request(direction: Direction, type_: str | type, options: Options) -> Request:
    """The request for a program of a type into its own holder; see `rosetta_jit.Decoder.of`."""
    request = request_of(direction, options, type_=type_ if isinstance(type_, str) else None)
    schema = options.get("schema")
    if isinstance(type_, str) and not isinstance(schema, bytes):
        return request
    descriptors = _from_descriptors(type_, schema if isinstance(schema, bytes) else None)
    return replace(request, plain=descriptors, framework="protobuf")


def _from_descriptors(type_: str | type, schema: bytes | None) -> str:
    """A type that comes as protobuf's own descriptors, as text."""
    import json  # few types come so

    from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set, from_message_class
    from rosetta_jit.model.serial import to_plain
    from rosetta_jit.model.types import Ref

    if schema is not None:
        declared = from_file_descriptor_set(schema)
        name = type_ if isinstance(type_, str) else type_.__name__
    else:
        message: Any = type_
        if not hasattr(message, "DESCRIPTOR"):
            raise TypeError(f"a type is a name, or a message class of protobuf's package, not {type_!r}")
        declared, name = from_message_class(message), message.DESCRIPTOR.full_name
    if name not in declared.types:
        from rosetta_jit.catalogue.pipeline import unknown_type
        from rosetta_jit.errors import SchemaError

        raise SchemaError((unknown_type(name, tuple(declared.types)),))
    return json.dumps(to_plain(Ref(name), declared), sort_keys=True)
