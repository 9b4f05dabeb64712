"""Examples of mappings in documents: schemas, a mapping, and what comes of messages and holders.

    ```mapping
    --- lab/msg/Tick.msg                        the wire's schema
    uint32 count
    --- tick.proto                              the holder's
    syntax = "proto2"; message Tick { required double turns = 1; }
    --- tick.mapping                            imports and the two types are added, where it does not have them
    rules:
      .turns <-> .count / 360.0
    --- values
    {"count": 540} <-> {"turns": 1.5}           unpacks to, and packs as
    range .count <- {"turns": 0.0001}           is refused with this kind and path; so with `->` to unpack
    ```

A line of `values` may begin with `parameters {...}`, which are those of the program.
"""

from __future__ import annotations

import ast
import math
import re
from dataclasses import dataclass, field
from typing import Any

import rosetta_jit as rj

START = re.compile(r"^--- (\S+)\n", re.MULTILINE)
SIGN = re.compile(r" (<->|<-|->) ")


@dataclass
class Example:
    """The files of an example, the mapping among them that is meant, and the lines of its values."""

    files: dict[str, str]
    mapping: str
    encoding: str | None
    values: list[str]
    parameters: dict[str, Any] = field(default_factory=dict[str, Any])


def example(text: str) -> Example:
    """An example as its block in a document has it."""
    _, *pieces = START.split(text)
    files = dict(zip(pieces[::2], pieces[1::2], strict=True))
    lines = [line for line in files.pop("values").splitlines() if line]
    wire, holder, *_ = files
    mapping = list(files)[-1]
    if "data-holder:" not in files[mapping]:
        imports = "".join(f'import "{name}"\n' for name in (wire, holder))
        files[mapping] = (
            f"{imports}data-holder: {type_of(holder, files[holder])}\nwire-schema: {type_of(wire, files[wire])}\n{files[mapping]}"
        )
    given = ast.literal_eval(lines.pop(0).removeprefix("parameters ")) if lines[0].startswith("parameters ") else {}
    of_ros = wire.endswith(".msg") and "/msg/" in wire
    return Example(files, mapping, None if of_ros else "yarp4", lines, given)


def type_of(name: str, text: str) -> str:
    """The type that a file is about: of several messages the last one that no other one holds."""
    if name.endswith(".msg"):
        return name.removesuffix(".msg")
    if name.endswith(".bottle-schema"):
        return re.findall(r'"([^"]+)"', text)[0]
    package = "".join(f"{each}." for each in re.findall(r"\bpackage ([\w.]+);", text))
    return package + re.findall(r"(?m)(?:^|; *|\} *)message (\w+)", text)[-1]


def run(text: str) -> None:
    """Every line of an example's values holds."""
    made = example(text)
    signs = {match[1] for line in made.values if (match := SIGN.search(line))}
    options = {"schema": made.files, "encoding": made.encoding, "parameters": made.parameters}
    decode = rj.Decoder(made.mapping, **options) if signs & {"<->", "->"} else None
    encode = rj.Encoder(made.mapping, **options) if signs & {"<->", "<-"} else None
    wire = type_of(next(iter(made.files)), next(iter(made.files.values())))
    plain = {"schema": made.files, "imports": [next(iter(made.files))], "encoding": made.encoding}
    write, read = rj.Encoder.of(wire, **plain), rj.Decoder.of(wire, **plain)
    for line in made.values:
        left, sign, right = SIGN.split(line, maxsplit=1)
        if sign in ("<->", "->"):
            assert decode is not None
            same(outcome(lambda decode=decode, left=left: decode(write(filled(write, left)))), right)
        if sign in ("<->", "<-"):
            assert encode is not None
            same(outcome(lambda encode=encode, right=right: read(encode(filled(encode, right)))), left)


def filled(program: Any, text: str) -> Any:
    return program.holder_type.from_dict(ast.literal_eval(text))


def outcome(call: Any) -> Any:
    """What a call gives, as plain values, or with what it is refused."""
    try:
        return call().to_dict()
    except (rj.DecodeError, rj.EncodeError) as error:
        return f"{error.kind} {error.path}".strip()


def same(found: Any, wanted: str) -> None:
    """Whether values are those that a document shows, floats up to the digits that it shows."""
    expected = ast.literal_eval(wanted) if wanted.startswith("{") else wanted
    assert alike(found, expected), (found, expected)


def alike(found: Any, wanted: Any) -> bool:
    match found, wanted:
        case dict(), dict():
            return all(name in found and alike(found[name], each) for name, each in wanted.items())
        case list(), list():
            return len(found) == len(wanted) and all(map(alike, found, wanted))
        case float(), float():
            return math.isclose(found, wanted, rel_tol=1e-6, abs_tol=1e-9) or (math.isnan(found) and math.isnan(wanted))
        case _:
            return found == wanted
