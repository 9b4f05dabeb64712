"""Where members lie: our rules against compilers, and memory against numpy and ctypes."""

from __future__ import annotations

import ctypes
import random
import shutil
import subprocess

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

import rosetta_jit as rj
from rosetta_jit.frameworks.base import Choices
from rosetta_jit.frameworks.orocos import compiler
from rosetta_jit.frameworks.orocos.encoding import encode_type
from rosetta_jit.frameworks.orocos.includes import gather
from rosetta_jit.frameworks.orocos.layout import Layouts
from rosetta_jit.source import Source
from rosetta_jit.wire.size import fixed_size
from tests.frameworks.orocos.headers import SCALARS, header, nothing, structs, types

SLOW = settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.too_slow])

PINNED = """
#include <array>
#include <cstddef>
#include <string>
#include <vector>
struct Base { int number; char letter; };
struct Closed { explicit Closed(int); int first; char second; };
struct OnBase : Base { char more; };
struct OnClosed : Closed { char more; };
struct Empty {};
struct HasEmpty { Empty empty; int number; };
struct OnEmpty : Empty { double number; };
struct Several : OnClosed, OnEmpty { short last; };
struct __attribute__((packed)) Packed { char letter; double number; short last; };
struct HasPacked { char letter; Packed packed[2]; int number; };
struct alignas(32) Wide { char letter; };
struct HasWide { char first; Wide wide; char last; };
struct Containers { char a; std::string text; bool b; std::vector<bool> bits; char c; std::vector<int> numbers; std::array<short, 3> few; };
"""


def observed(text):
    """Size, alignment and offsets of each struct, as libclang sees them."""
    answer = compiler.declarations(gather(Source("test.hpp", text), nothing))
    return {each["name"]: (each["size"], each["alignment"], [member["offset"] for member in each["members"]]) for each in answer["records"]}


def computed(declared, names):
    """The same by our rules."""
    layouts = Layouts(declared)
    extents = {name: layouts.of_struct(declared[name]) for name in names}
    return {
        name: (extent.size, extent.alignment, [place.offset for place in layouts.places(declared[name])])
        for name, extent in extents.items()
    }


def by_gpp(text, names, declared, folder):
    """The same as g++ prints them."""
    numbers = []
    for name in names:
        offsets = (f"offsetof({name}, {field.name})" for field in declared[name].fields)
        numbers += [f"sizeof({name})", f"alignof({name})", *offsets]
    rows = "".join(f'std::printf("%zu ", (size_t)({number}));' for number in numbers)
    program = f"#include <cstdio>\n#include <cstddef>\n{text}\nint main() {{ {rows} }}\n"
    (folder / "layout.cpp").write_text(program)
    subprocess.run(["g++", "-std=c++17", "-w", "-o", folder / "layout", folder / "layout.cpp"], check=True)
    printed = iter(subprocess.run([folder / "layout"], check=True, capture_output=True, text=True).stdout.split())
    return {name: (int(next(printed)), int(next(printed)), [int(next(printed)) for _ in declared[name].fields]) for name in names}


@SLOW
@given(structs(containers=True))
def test_rules_agree_with_libclang(declared):
    text = header(declared)
    found = types(text)
    assert not any(field.option("offset") for name in declared for field in found[name].fields)
    assert computed(found, declared) == observed(text)


def test_what_the_rules_do_not_tell_is_pinned():
    found, seen = types(PINNED), observed(PINNED)
    assert computed(found, seen) == seen
    assert dict(found["OnClosed"].fields[-1].options) == {}
    assert dict(found["OnBase"].fields[-1].options) == {"offset": 8}
    assert dict(found["Packed"].options) == {"alignment": 1}


@pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed")
def test_agrees_with_gpp(tmp_path):
    found = types(PINNED)
    names = [name for name in observed(PINNED) if found[name].fields]
    assert computed(found, names) == by_gpp(PINNED, names, found, tmp_path)


# --- memory -------------------------------------------------------------------------------------------------------------


def numpy_type(declared, type_):
    if type_ in SCALARS:
        return np.dtype(SCALARS[type_])
    return np.dtype(
        [(name, numpy_type(declared, each), tuple(dimensions)) for name, each, dimensions in declared[type_]],
        align=True,
    )


def ctypes_type(declared, type_, made):
    if type_ in SCALARS:
        return next(each for each in CTYPES if each._type_ == SCALARS[type_])
    if type_ not in made:
        fields = []
        for name, each, dimensions in declared[type_]:
            member = ctypes_type(declared, each, made)
            for length in reversed(dimensions):
                member *= length
            fields.append((name, member))
        made[type_] = type(type_, (ctypes.Structure,), {"_fields_": fields})
    return made[type_]


CTYPES = (
    ctypes.c_bool,
    ctypes.c_byte,
    ctypes.c_ubyte,
    ctypes.c_short,
    ctypes.c_ushort,
    ctypes.c_int,
    ctypes.c_uint,
    type("Long", (ctypes._SimpleCData,), {"_type_": "q"}),
    type("Unsigned", (ctypes._SimpleCData,), {"_type_": "Q"}),
    ctypes.c_float,
    ctypes.c_double,
)


def filled(dtype, rng):
    """A value of a type whose padding is zero, from random bytes."""
    value = np.zeros((), dtype)
    for name in dtype.names:
        part = value[name]
        if dtype[name].base.names:
            value[name] = np.reshape([filled(dtype[name].base, rng) for _ in range(max(1, part.size))], part.shape)
        elif dtype[name].base == np.bool_:
            value[name] = np.reshape([rng.random() < 0.5 for _ in range(max(1, part.size))], part.shape)
        else:
            value[name] = np.frombuffer(rng.randbytes(part.nbytes), dtype[name].base).reshape(part.shape)
    return value


@SLOW
@given(structs(containers=False))
def test_native_is_memory(declared):
    name = list(declared)[-1]
    text = header(declared)
    dtype = numpy_type(declared, name)
    found = types(text)
    assert ctypes.sizeof(ctypes_type(declared, name, {})) == dtype.itemsize == Layouts(found).of_struct(found[name]).size
    options = {"schema": {"test.hpp": text}, "encoding": "native", "backend": "python"}
    value = filled(dtype, random.Random(len(text)))
    data = value.tobytes()
    shown = rj.Decoder.of(name, **options)(data)
    assert rj.Encoder.of(name, **options)(shown) == data
    for member, type_, dimensions in declared[name]:
        if type_ in SCALARS and not dimensions:
            expected = value[member].tobytes()
            assert np.asarray(getattr(shown, member), dtype[member]).tobytes() == expected
        elif type_ in SCALARS and len(dimensions) == 1 and "char" not in type_:
            assert np.asarray(getattr(shown, member)).tobytes() == value[member].tobytes()


def test_padding_is_read_whatever_it_is_and_written_as_zeros():
    options = {"schema": {"test.hpp": "struct A { char c; int i; char d; };"}, "encoding": "native", "backend": "python"}
    shown = rj.Decoder.of("A", **options)(b"\x01\xff\xff\xff\x02\x00\x00\x00\x03\xff\xff\xff")
    assert (shown.c, shown.i, shown.d) == (1, 2, 3)
    assert rj.Encoder.of("A", **options)(shown) == b"\x01\x00\x00\x00\x02\x00\x00\x00\x03\x00\x00\x00"


@SLOW
@given(structs(containers=False))
def test_sizes_of_the_encodings(declared):
    """A dump is the memory up to the last member's last byte; an archive has no padding at all."""
    found = types(header(declared))
    layouts = Layouts(found)
    schema = rj_schema(found)
    for name in declared:
        sizes = {
            each: fixed_size(encode_type(found[name], schema, each, Choices()).attempts[0]) for each in ("native", "typelib", "rtt-mqueue")
        }
        assert sizes["native"] == layouts.of_struct(found[name]).size
        assert sizes["rtt-mqueue"] <= sizes["typelib"] <= sizes["native"]


def rj_schema(found):
    from rosetta_jit.model.types import Schema

    return Schema(found)
