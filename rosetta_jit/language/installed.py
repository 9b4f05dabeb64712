"""Which functions the language has, by name: ours, and those of installed packages.

Ours stand in `rosetta_jit.functions`, one file a family, which is imported when a function is first looked up. An installed package offers
functions of its own by entry points of the group `rosetta_jit.functions`, a `Function` each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import cast

from rosetta_jit.language.function import Function
from rosetta_jit.startup import entry_points
from rosetta_jit.startup.garbage import imported

GROUP = "rosetta_jit.functions"
"""The entry-point group in which packages offer functions of their own: a `Function` each."""

GROUPS = ("rotations", "poses", "geodesy", "utm")
"""Those of `OURS` whose functions are components of functions of several values (`language.groups`)."""

OURS: Mapping[str, tuple[str, ...]] = {
    "angles": ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "radians", "degrees"),
    "numbers": ("sqrt", "floor", "ceil", "round", "abs", "isfinite", "isnan", "min", "max"),
    "reductions": ("sum", "mean", "any", "all", "count", "xor"),
    "sequences": ("deltas", "running_sums"),
    "runs": ("repeated", "run_values", "run_lengths"),
    "bits": ("bits", "bit_bytes"),
    "division": ("divide", "floor_divide", "modulo"),
    "counting": ("others", "align"),
    "clock": ("now", "counter"),
    "joining": ("+", "behind", "before", "part", "parts", "join", "split"),
    "texts": ("lower", "upper", "strip", "replace", "slice", "until_nul", "padded"),
    "comparing": ("len", "<=>", "starts_with", "ends_with", "contains"),
    "enum_names": ("Enum(s)",),
    "spelling": ("text", "bytes", "integer", "number"),
    "moments": ("iso8601", "timestamp", "seconds", "fraction", "nanoseconds"),
    "octets": (*(f"{kind}{bits}_at" for kind in ("int", "uint") for bits in (8, 16, 32, 64)), "float32_at", "float64_at", "byte"),
    "signals": ("signal", "signal_bytes"),
    "checksums": ("crc",),
    "images": ("decompress", "compress", "image_width", "image_height", "image_channels", "image_depth"),
    "colours": ("rgb_of", "yuv_of"),
    "reorders": ("permuted",),
    "rotations": (
        *("quaternion", "euler", "rotation_matrix", "quaternion_of_matrix"),
        *("compose_rotations", "invert_rotation", "rotate_vector"),
    ),
    "poses": ("pose", "position", "orientation", "compose_poses", "invert_pose", "transform_point"),
    "geodesy": ("enu", "geodetic"),
    "utm": ("utm", "geodetic_of_utm"),
}
"""Modules of `rosetta_jit.functions` with a tuple `FUNCTIONS`, in the order of the reference, and the names of these up to the first dot.

A module is imported when one of its functions is first asked for: few mappings call functions of several families.
"""


class _Functions(Mapping[str, Function]):
    """Every function by name: ours, and those of installed packages, which cannot take the place of ours."""

    def __getitem__(self, name: str) -> Function:
        family = family_of(name)
        found = None if family is None else _family(family).get(name)
        return found or _offered_by_name()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys([*_offered_by_name(), *(each.name for each in shipped())]))

    def __len__(self) -> int:
        return sum(1 for _ in self)


_FUNCTIONS = _Functions()


def functions() -> Mapping[str, Function]:
    """Every function by name. To go through all of them imports all of them."""
    return _FUNCTIONS


@cache
def family_of(name: str) -> str | None:
    """The module of `rosetta_jit.functions` that has a function, or a function of several values, if ours have it."""
    begin = name.partition(".")[0]
    return next((family for family, begins in OURS.items() if begin in begins), None)


@cache
def _family(name: str) -> Mapping[str, Function]:
    found = cast("tuple[Function, ...]", imported(f"rosetta_jit.functions.{name}").FUNCTIONS)
    return {each.name: each for each in found}


@cache
def _offered_by_name() -> Mapping[str, Function]:
    return {each.name: each for each in offered()}


@cache
def shipped() -> tuple[Function, ...]:
    """The functions that come with rosetta_jit, in the order of the reference."""
    return tuple(each for name in OURS for each in _family(name).values())


@cache
def offered() -> tuple[Function, ...]:
    """The functions of installed packages."""
    return cast("tuple[Function, ...]", entry_points.loaded(GROUP))


def names() -> tuple[str, ...]:
    """The functions that a mapping can call."""
    return tuple(name for name in functions() if name.isidentifier())


def written(name: str) -> Function | None:
    """The function that a mapping calls by a name; None where there is none."""
    return functions().get(name) if name.isidentifier() else None
