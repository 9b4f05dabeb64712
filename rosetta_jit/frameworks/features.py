"""What frameworks can describe, and what of it we can represent: the paper's table 1, found out by trying.

For each feature a framework has a probe: a small text in its IDL that needs the feature in a type named ``Probe``. The front end reads it,
the model is asked whether the feature arrived, and every encoding is asked for the bytes. Whatever fails on that way is a gap.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.model.layout import layout, recursive_structs
from rosetta_jit.model.types import (
    Array,
    Bool,
    Bytes,
    Enum,
    Float,
    Int,
    Map,
    Optional,
    Ref,
    Schema,
    String,
    Struct,
    Type,
    Union,
    name_parts,
)
from rosetta_jit.source import Source

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosetta_jit.frameworks.base import Framework

State = Literal["yes", "gap", "none"]
Asked = Callable[[Struct, Schema], bool]


@dataclass(frozen=True, slots=True)
class Probe:
    """A text in some IDL. ``files`` are what it imports; ``file`` is what it is called."""

    text: str
    files: Mapping[str, str] = field(default_factory=dict[str, str])
    file: str = ""


Probes = Mapping[str, Mapping[str, str | Probe]]
"""For each suffix of an IDL, and each of its features, a probe."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One cell of the table. ``note`` says why it is a gap."""

    state: State
    note: str = ""


NONE = Finding("none")


def _reached(struct: Struct, schema: Schema) -> Iterator[Type]:
    """Every type that a struct mentions, each declaration once."""
    pending: list[Type] = [struct]
    seen: set[str] = set()
    while pending:
        type_ = pending.pop()
        yield type_
        match type_:
            case Struct(_, fields) | Union(_, fields):
                pending += [each.type for each in fields]
            case Array(element) | Optional(element):
                pending.append(element)
            case Map(key, value):
                pending += [key, value]
            case Ref(name) if name not in seen:
                seen.add(name)
                pending.append(schema.types[name])
            case _:
                pass


def _mentions(wanted: Callable[[Type], bool]) -> Asked:
    return lambda struct, schema: any(wanted(each) for each in _reached(struct, schema))


def _integer(bits: int, *, signed: bool) -> Asked:
    return _mentions(lambda each: isinstance(each, Int) and (each.bits, each.signed) == (bits, signed))


def _text(encoding: str) -> Asked:
    return _mentions(lambda each: isinstance(each, String) and each.encoding == encoding)


def _array(wanted: Callable[[Array], bool]) -> Asked:
    return _mentions(lambda each: isinstance(each, Array) and wanted(each))


def _bytes(wanted: Callable[[Bytes], bool]) -> Asked:
    return _mentions(lambda each: isinstance(each, Bytes) and wanted(each))


def _bare(type_: Type) -> Type:
    return type_.value if isinstance(type_, Optional) else type_


def _never(struct: Struct, schema: Schema) -> bool:
    """The meta-model has nothing of the kind."""
    del struct, schema
    return False


FEATURES: Mapping[str, Asked] = {
    "boolean": _mentions(lambda each: isinstance(each, Bool)),
    **{f"int{bits}": _integer(bits, signed=True) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": _integer(bits, signed=False) for bits in (8, 16, 32, 64)},
    "float32": _mentions(lambda each: isinstance(each, Float) and each.bits == 32),
    "float64": _mentions(lambda each: isinstance(each, Float) and each.bits == 64),
    "long double": _never,
    "character": _mentions(lambda each: isinstance(each, Int) and each.spelling == "char"),
    "wide character": _mentions(lambda each: isinstance(each, Int) and each.spelling == "wchar"),
    "string, UTF-8": _text("utf-8"),
    "string, unchecked": _text("octets"),
    "string, UTF-16": _text("utf-16"),
    "string, bounded": _mentions(lambda each: isinstance(each, String) and each.maximum is not None),
    "blob": _bytes(lambda each: each.length is None and each.maximum is None),
    "blob, fixed": _bytes(lambda each: isinstance(each.length, int)),
    "blob, bounded": _bytes(lambda each: each.maximum is not None),
    "array, fixed": _array(lambda each: each.fixed is not None),
    "array, variable": _array(lambda each: each.length is None and each.maximum is None),
    "array, bounded": _array(lambda each: each.maximum is not None),
    "array, sized by a field": _array(lambda each: each.length is not None and each.fixed is None),
    "array, multi-dimensional": _array(lambda each: each.fixed is not None and isinstance(each.element, Array)),
    "array of arrays": _array(lambda each: each.fixed is None and isinstance(each.element, Array)),
    "struct": lambda struct, schema: any(isinstance(schema.resolve(_bare(each.type)), Struct) for each in struct.fields),
    "oneof": _mentions(lambda each: isinstance(each, Union) and not each.discriminator),
    "union with a discriminator": _mentions(lambda each: isinstance(each, Union) and bool(each.discriminator)),
    "enum": _mentions(lambda each: isinstance(each, Enum)),
    "optional": _mentions(lambda each: isinstance(each, Optional)),
    "required": lambda struct, _: any(each.required for each in struct.fields),
    "default": lambda struct, _: any(each.default is not None for each in struct.fields),
    "map": _mentions(lambda each: isinstance(each, Map)),
    "set": lambda struct, _: any(each.option("set") for each in struct.fields),
    "constant": lambda struct, schema: bool(struct.constants or schema.constants or any(each.constant for each in struct.fields)),
    "recursion": lambda struct, schema: bool(recursive_structs(Ref(struct.name), schema)),
    "inheritance": lambda struct, _: len(struct.fields) > 1,
    "namespace": lambda struct, _: len(name_parts(struct.name)) > 1,
    "import": lambda struct, schema: (
        len({each.span.source.name for each in schema.types.values() if each.span}) > 1 and bool(struct.fields)
    ),
    "extension": lambda struct, _: len(struct.fields) > 1,
    "time": _mentions(lambda each: isinstance(each, Struct) and name_parts(each.name)[-1].lower() in ("time", "timestamp", "stamp")),
    "unit": lambda struct, _: any(each.unit is not None for each in struct.fields),
    "service": lambda _, schema: any(name_parts(name)[-1] in ("request", "reply") for name in schema.types),
}
"""Every feature, and how the model shows that it arrived."""


def findings(framework: Framework, probes: Probes) -> dict[str, dict[str, Finding]]:
    """For each feature, and each IDL (by suffix) and encoding (by name) of a framework, what was found."""
    columns = {suffix: probes.get(suffix, {}) for suffix in framework.idl}
    return {feature: _row(framework, feature, columns) for feature in FEATURES}


def _row(framework: Framework, feature: str, columns: Mapping[str, Mapping[str, str | Probe]]) -> dict[str, Finding]:
    row: dict[str, Finding] = {}
    written: dict[str, Finding] = dict.fromkeys(framework.encodings, NONE)
    for suffix, probes in columns.items():
        probe = probes.get(feature)
        read = NONE if probe is None else _read(framework, feature, probe if isinstance(probe, Probe) else Probe(probe), suffix)
        row[suffix] = read if isinstance(read, Finding) else Finding("yes")
        if not isinstance(read, Finding):
            written |= {name: _encoded(framework, name, *read) for name in framework.encodings if written[name].state != "yes"}
        elif read.state == "gap":
            written |= {name: read for name in framework.encodings if written[name].state == "none"}
    return row | written


def _read(framework: Framework, feature: str, probe: Probe, suffix: str) -> tuple[Struct, Schema] | Finding:
    name = probe.file or f"probe/Probe{suffix}"
    files = {path: Source(path, text) for path, text in probe.files.items()}
    try:
        schema = framework.front_end(name)(Source(name, probe.text), files.get)
    except SchemaError as error:
        return Finding("gap", _why(error))
    struct = next((each for path, each in schema.types.items() if isinstance(each, Struct) and name_parts(path)[-1] == "Probe"), None)
    if struct is None:
        why = next((each.message for path, each in schema.left_out.items() if name_parts(path)[-1] == "Probe"), "no type was read")
        return Finding("gap", why)
    if not FEATURES[feature](struct, schema):
        return Finding("gap", "the meta-model has no place for it")
    return struct, schema


def _encoded(framework: Framework, encoding: str, struct: Struct, schema: Schema) -> Finding:
    try:
        layout(Ref(struct.name), schema)
        framework.encoding(encoding)(struct, schema, encoding, Choices())
    except SchemaError as error:
        return Finding("gap", _why(error))
    except ValueError as error:
        return Finding("gap", str(error))
    return Finding("yes")


def _why(error: SchemaError) -> str:
    return error.diagnostics[0].message
