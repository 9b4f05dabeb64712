"""Long routines that know nothing of the holder's fields are functions of their own, the same for all programs, compiled once."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from llvmlite import ir

import rosetta_jit as rj
from rosetta_jit.backends.entry import link
from rosetta_jit.backends.llvm import routines
from rosetta_jit.backends.llvm.function import emit
from rosetta_jit.backends.llvm.routines import SHORT, common_routine
from rosetta_jit.kernel.ir import Routine, Site
from rosetta_jit.kernel.nodes import Assign, Call, Capacity, Get, Let, Local, Place, Return, Var
from rosetta_jit.kernel.terms import END, add, index
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from tests.backends.kernels import kernel

SUM, GIVEN = Local("i64", "sum"), Local("i64", "given")
SITES = (Site("grow", "", ""),)

ONE = 'syntax = "proto3"; package a; message One { double x = 1; }'
OTHER = 'syntax = "proto3"; package a; message Other { double x = 1; double y = 2; int64 z = 3; }'
MANY = 'syntax = "proto3"; package a; message Many { double x = 1; repeated int64 z = 3; repeated string s = 4; }'


def decoder_kernel(name, text):
    (made,) = Build(Request("decode", type=f"a.{name}", files=(("a.proto", text),), encoding="protobuf")).kernels
    return made


def symbols(made):
    module = ir.Module("test")
    emit(module, made, "kernel", whole=False)
    return {each.name for each in module.functions if not each.blocks and each.name.startswith("rosetta_")}


def long(*first, name="long"):
    """A routine of more statements than are printed in the place of a call."""
    counted = (Var(SUM.name, index(0)), *(Assign(SUM.name, add(index(number), 1)) for number in range(SHORT)))
    return Routine(name, (), (SUM,), (*first, *counted), (), (), SITES)


def calling(*routines, strides=(8, 8)):
    """A kernel that calls the last of some routines."""
    body = (Call(routines[-1].name, (), (GIVEN,), (), ()), Return(END))
    return replace(kernel(body, strides=strides), routines=routines)


def test_programs_of_several_types_have_the_same_ones():
    one, other = (symbols(decoder_kernel(*each)) for each in (("One", ONE), ("Other", OTHER)))
    assert {re.sub("_[0-9a-f]{16}$", "", each) for each in one} == {"rosetta_read_long_varint", "rosetta_skip"}
    assert one == other
    (skip,), (varint,) = ([each for each in one if name in each] for name in ("skip", "varint"))
    assert varint in common_routine(skip).declares, "to skip a field is to read integers"
    assert link._wanted({skip, "memcpy"}) == {skip, varint}


def test_where_the_lane_for_notes_is_another_one_what_names_it_is_another():
    one, many = (symbols(decoder_kernel(*each)) for each in (("One", ONE), ("Many", MANY)))
    assert {"varint" in each for each in one & many} == {True}
    assert {"skip" in each for each in one - many} == {True}


def test_a_whole_module_has_them_inside():
    made = decoder_kernel("One", ONE)
    module = ir.Module("test")
    emit(module, made, "kernel", whole=True)
    assert not any(each.name.startswith("rosetta_") for each in module.functions)
    assert {"kernel.read_long_varint", "kernel.skip"} <= {each.name for each in module.functions if each.blocks}
    text = link.llvm_text([made], "decode", with_numba=False)
    assert not re.search("@rosetta_(skip|read)", text)


def test_what_knows_a_field_is_none_and_neither_is_what_calls_it():
    assert symbols(calling(long()))
    assert symbols(calling(long(Let("notes", Get("i64", Place(1, index(0)))))))
    assert symbols(calling(long(Let("room", Capacity(1)))))
    for knowing in (Let("field", Get("i64", Place(0, index(0)))), Let("room", Capacity(0))):
        assert not symbols(calling(long(knowing)))
        inner = Routine("inner", (), (), (knowing,), (), (), SITES)
        assert not symbols(calling(inner, long(Call("inner", (), (), (), ()))))


def test_short_ones_are_none():
    assert not symbols(calling(replace(long(), body=long().body[:SHORT])))


def test_each_text_has_a_symbol_of_its_own():
    (one,), (same,) = symbols(calling(long())), symbols(calling(long(), strides=(24, 16, 8)))
    (other,) = symbols(calling(long(Let("more", Get("i64", Place(1, index(2)))))))
    assert one == same != other
    assert f'@"{one}"' in common_routine(one).text
    assert common_routine("rosetta_is_text") is None


GROUP = b"\x7b\x08\x01\x12\x03abc\x7c"
"""An unknown field: a group of two fields."""

MESSAGE = GROUP + b"\x09" + bytes(6) + b"\xf0\x3f" + b"\xa0\x7f" + b"\xff" * 9 + b"\x01"


@pytest.mark.parametrize(("name", "text"), [("One", ONE), ("Other", OTHER), ("Many", MANY)])
def test_messages_with_unknown_fields(name, text):
    compiled, interpreted = (
        rj.Decoder.of(f"a.{name}", encoding="protobuf", schema={"a.proto": text}, backend=backend) for backend in ("llvm", "python")
    )
    assert compiled(MESSAGE).x == interpreted(MESSAGE).x == 1.0
    cut = [MESSAGE[:size] for size in range(len(MESSAGE))]
    damaged = [MESSAGE[:at] + bytes([MESSAGE[at] ^ bit]) + MESSAGE[at + 1 :] for at in range(len(MESSAGE)) for bit in (1, 7, 8, 128)]
    told = [(found_by(compiled, message), found_by(interpreted, message)) for message in (*cut, *damaged)]
    assert all(one == other for one, other in told)
    assert {"truncated", "tag"} <= {one[0] for one, _ in told if one is not None}


def found_by(decode, message):
    """The error of a message, if it has one."""
    try:
        decode(message)
    except rj.DecodeError as error:
        return error.kind, error.path, error.offset
    return None


def test_one_is_compiled_once(monkeypatch, tmp_path):
    monkeypatch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path))
    link._shared.cache_clear()
    compiled = []
    ours = link.object_of
    monkeypatch.setattr(link, "object_of", lambda texts, exported, **options: compiled.append(exported) or ours(texts, exported, **options))
    for name, text in (("One", ONE), ("Other", OTHER)):
        rj.Decoder.of(f"a.{name}", encoding="protobuf", schema={"a.proto": text})
        link._shared.cache_clear()
    routines = [name for exported in compiled for name in exported if name.startswith("rosetta_")]
    assert sorted(routines) == sorted({*routines})
    assert len(routines) == 2


def test_few_are_remembered(monkeypatch):
    """What a program has declared is known until it is linked, however many others there were."""
    monkeypatch.setattr(routines, "MAX_COMMON", 1)
    seen = [symbols(calling(long(Let("more", Get("i64", Place(1, index(row))))))) for row in range(4)]
    assert len(set().union(*seen)) == 4
    assert [common_routine(*each) is None for each in seen] == [True, True, False, False]
    assert symbols(calling(long(Let("more", Get("i64", Place(1, index(0))))))) == seen[0]
    assert common_routine(*seen[0]) is not None
