"""What frameworks can describe, and what of it we can represent: the paper's table 1, found out by trying.

For each feature that a framework has, it offers a probe: a small text in its IDL that needs the feature in a type, mostly called ``Probe``.
The front end reads it, the model is asked whether the feature has arrived, and every encoding is asked for the bytes, to read and to write.
Whatever fails on that way is a gap, with what stood in the way. What the framework itself does not have has no probe.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath
from typing import Literal

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.base import Choices, Framework
from rosetta_jit.frameworks.feature_list import FEATURES
from rosetta_jit.frameworks.probe import Probe, Probes
from rosetta_jit.model.layout import layout
from rosetta_jit.model.types import Ref, Schema, Struct, name_parts
from rosetta_jit.source import Source
from rosetta_jit.startup.dataclass import dataclass

State = Literal["yes", "read", "gap", "none"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One cell of the table: ``yes`` is both ways, ``read`` is one of them. ``note`` says why it is less than yes."""

    state: State
    note: str = ""


YES, NONE = Finding("yes"), Finding("none")
BEST: tuple[State, ...] = ("yes", "read", "gap", "none")
Read = tuple[Struct, Schema, Probe] | Finding
Table = Mapping[str, Mapping[str, Finding]]


def findings(framework: Framework) -> Table:
    """For each feature, and each IDL (by suffix) and encoding (by name) of a framework, what was found."""
    probes = framework.probes()
    return {feature: _row(framework, feature, probes) for feature in FEATURES}


def _row(framework: Framework, feature: str, probes: Probes) -> dict[str, Finding]:
    """An encoding is judged by the best of what the IDLs can ask of it."""
    read = {suffix: _found(framework, feature, suffix, probes) for suffix in _distinct(framework, probes)}
    columns = {suffix: read[_twin(framework, probes, suffix)] for suffix in framework.idl}
    shown = {suffix: each if isinstance(each, Finding) else YES for suffix, each in columns.items()}
    written = {name: _best([_encoded(framework, name, each) for each in read.values()]) for name in framework.encodings}
    return shown | written


def _best(found: list[Finding]) -> Finding:
    return min(found, key=lambda each: (BEST.index(each.state), not each.note), default=NONE)


def _twin(framework: Framework, probes: Probes, suffix: str) -> str:
    """The first suffix with the same front end and probes: C++ headers have two, and are read once."""
    return next(each for each in framework.idl if framework.idl[each] == framework.idl[suffix] and probes.get(each) is probes.get(suffix))


def _distinct(framework: Framework, probes: Probes) -> tuple[str, ...]:
    return tuple(each for each in framework.idl if _twin(framework, probes, each) == each)


def _found(framework: Framework, feature: str, suffix: str, probes: Probes) -> Read:
    probe = probes.get(suffix, {}).get(feature)
    if probe is None:
        return NONE
    return _read(framework, feature, probe if isinstance(probe, Probe) else Probe(probe), suffix)


def _read(framework: Framework, feature: str, probe: Probe, suffix: str) -> Read:
    name = probe.file or f"probe/Probe{suffix}"
    if not framework.reads(name):
        return Finding("gap", f"no front end reads `{PurePosixPath(name).suffix}` files")
    files = {path: Source(path, text) for path, text in probe.files.items()}
    try:
        schema = framework.front_end(name)(Source(name, probe.text), files.get)
    except SchemaError as error:
        return Finding("gap", _why(error))
    last = probe.declares
    struct = next((each for path, each in schema.types.items() if isinstance(each, Struct) and name_parts(path)[-1] == last), None)
    if struct is None:
        why = next((each.message for path, each in schema.left_out.items() if name_parts(path)[-1] == last), "it is skipped")
        return Finding("gap", why)
    if not FEATURES[feature](struct, schema):
        return Finding("gap", "it is read, and does not reach the model")
    return struct, schema, probe


def _encoded(framework: Framework, encoding: str, read: Read) -> Finding:
    if isinstance(read, Finding):
        return read
    struct, schema, probe = read
    try:
        layout(Ref(struct.name), schema)
        made = framework.encoding(encoding)(struct, schema, encoding, Choices())
    except SchemaError as error:
        return Finding("none" if encoding in probe.without else "gap", _why(error))
    except ValueError as error:
        return Finding("gap", str(error))
    return YES if made.written is not None else Finding("read", f"{encoding} is several encodings, and does not say which to write")


def _why(error: SchemaError) -> str:
    return error.diagnostics[0].message
