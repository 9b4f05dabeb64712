"""Random mappings between random types of all frameworks, against what plain Python makes of the same values."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rosetta_jit as rj
from tests.random_mappings.fields import plain, written
from tests.random_mappings.meaning import LEAVES, Refused
from tests.random_mappings.message_types import CONSTANTS, Array, Enum, Kind, Message, Scalar, leaves, presences, seen, some
from tests.random_mappings.rules import Filler, Rules
from tests.random_mappings.values import Made, Maker
from tests.random_mappings.wires import WIRES, Wire

if TYPE_CHECKING:
    from collections.abc import Callable

MESSAGES = 20
POINT = {"x": Scalar("float64"), "n": Scalar("int32"), "s": Scalar("string")}
ALWAYS = ("s", "i64", "f32", "f64", "b")
"""The leaves that are always there, at the top."""


@dataclass
class Side:
    """A type on one side of a mapping."""

    wire: Wire
    message: Message

    @property
    def files(self) -> dict[str, str]:
        return self.wire.files(self.message)

    @property
    def type_name(self) -> str:
        return self.wire.type_name(self.message)

    def constant(self, name: str) -> str:
        return self.wire.constant_name(self.message, name)


def source(rng: random.Random, wire: Wire) -> Side:
    """A type to read: the fields that expressions know, some of them elsewhere, and arrays."""
    known = {name: type_ for name, type_ in LEAVES.items() if type_ in wire.scalars}
    more: dict[str, Kind] = {
        **{name: Scalar(known.pop(name)) for name in ALWAYS},
        "xs": Array(Scalar("float64")),
        "ks": Array(Scalar("int32")),
        "ps": Array(Message("SrcPt", POINT)),
        **({"q": Array(Scalar("int16"), 4)} if wire.has_fixed and "int16" in wire.scalars else {}),
        **({"m": Enum()} if wire.constant else {}),
    }
    return Side(wire, wire.types(rng).message("Src", known, more))


def aim(rng: random.Random, wire: Wire) -> Side:
    """A type to set, without arrays."""
    types = [rng.choice([*(each for each in wire.scalars), *ALWAYS_TYPES]) for _ in range(8)]
    more: dict[str, Kind] = {"m": Enum()} if wire.constant and rng.random() < 0.5 else {}
    return Side(wire, wire.types(rng).message("Dst", {f"o{number}": type_ for number, type_ in enumerate(types)}, more))


ALWAYS_TYPES = ("int64", "float32", "float64", "bool", "string")


def maker(rng: random.Random, side: Side) -> Maker:
    """Makes expressions of the fields of a type."""
    atoms = [presence(path) for path in presences(side.message)]
    if side.wire.constant:
        atoms += [enum_number(), enum_compared(rng, side)]
    arrays = (("ks", "int32"), ("q", "int16")) if "q" in side.message.fields else (("ks", "int32"),)
    return Maker(rng, dict(leaves(side.message)), atoms=tuple(atoms), arrays=arrays)


def presence(path: str) -> Made:
    return Made(f"has(.{path})", "bool", lambda fields: fields[f"has {path}"])


def enum_number() -> Made:
    return Made("int32(.m)", "int32", lambda fields: CONSTANTS.index(fields["m"]))


def enum_compared(rng: random.Random, side: Side) -> Made:
    name, operator = rng.choice(CONSTANTS), rng.choice(["==", "!="])
    return Made(f"(.m {operator} {side.constant(name)})", "bool", lambda fields: (fields["m"] == name) == (operator == "=="))


def mapping(src: Side, dst: Side, rules: str, direction: str) -> dict[str, str]:
    holder, wire, block = (dst, src, "unpack") if direction == "decode" else (src, dst, "pack")
    files = {**src.files, **dst.files}
    imports = "".join(f'import "{name}"\n' for name in files)
    return {
        **files,
        "m.mapping": f'{imports}data-holder: "{holder.type_name}"\nwire-schema: "{wire.type_name}"\n{block}-rules:\n{rules}\n',
    }


def counted(side: Side, values: dict[str, Any]) -> dict[str, Any]:
    """LCM's arrays have their lengths in fields."""
    if side.wire.options["encoding"] != "lcm":
        return values
    arrays = [name for name, kind in side.message.fields.items() if isinstance(kind, Array) and kind.size is None]
    return {**values, **{f"n_{name}": len(values[name]) for name in arrays}}


def runner(files: dict[str, str], src: Side, dst: Side, direction: str, backend: str) -> Callable[[dict[str, Any]], dict[str, Any]]:
    """``run(fields)``: what rules make of the fields of the source, as a dict."""
    if direction == "decode":
        write = rj.Encoder.of(
            src.type_name, schema=files, imports=list(src.files), backend="interpreter", **src.wire.options, **src.wire.written
        )
        decode = rj.Decoder("m.mapping", schema=files, backend=backend, **src.wire.options)
        return lambda fields: decode(write(write.holder_type.from_dict(fields))).to_dict()
    encode = rj.Encoder("m.mapping", schema=files, backend=backend, **dst.wire.options, **dst.wire.written)
    read = rj.Decoder.of(dst.type_name, schema=files, imports=list(dst.files), backend="interpreter", **dst.wire.options)
    return lambda fields: read(written(encode, fields)).to_dict()


def outcome(run: Callable[[dict[str, Any]], dict[str, Any]], fields: dict[str, Any]) -> Any:
    try:
        return plain(without_cases(run(fields)))
    except rj.MessageError as error:
        return error.kind, error.path


def without_cases(value: Any) -> Any:
    """Without the discriminators of unions."""
    if isinstance(value, dict):
        return {name: without_cases(each) for name, each in value.items() if name != "_d"}
    return [without_cases(each) for each in value] if isinstance(value, list) else value


def wanted(rules: Rules, fields: dict[str, Any]) -> Any:
    try:
        with np.errstate(all="ignore"):
            return plain(rules.run(fields))
    except Refused as refused:
        return refused.kind, refused.place


def check_wires(seed: int, names: tuple[str, str], direction: str, backends: list[str]) -> None:
    rng = random.Random(seed)
    src, dst = source(rng, WIRES[names[0]]), aim(rng, WIRES[names[1]])
    rules = Filler(maker(rng, src), dst.constant).message(dst.message)
    files = mapping(src, dst, rules.text, direction)
    runs = {backend: runner(files, src, dst, direction, backend) for backend in backends}
    for _ in range(MESSAGES):
        values = some(rng, src.message, rng.choice([0, 1, 3, 4, 6]))
        expected = wanted(rules, seen(src.message, values, requires=src.wire.requires))
        for backend, run in runs.items():
            found = outcome(run, counted(src, values))
            assert found == expected, (seed, names, direction, backend, files, values)


def pair_of(seed: int) -> tuple[tuple[str, str], str]:
    """The two wires and the direction of a seed."""
    rng = random.Random(f"wires {seed}")
    return (rng.choice(list(WIRES)), rng.choice(list(WIRES))), rng.choice(["decode", "encode"])


@pytest.mark.parametrize("seed", range(3))
def test_wires(seed):
    check_wires(seed, *pair_of(seed), ["python", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check_wires(seed, *pair_of(seed), ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
