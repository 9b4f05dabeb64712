"""Vast programs become code part by part: the same program, of which LLVM holds less at a time."""

from __future__ import annotations

import pytest
from llvmlite import binding, ir

import rosetta_jit as rj
from rosetta_jit.backends.entry import link, program
from rosetta_jit.backends.llvm import printing
from rosetta_jit.backends.llvm.lines import Lines
from rosetta_jit.backends.llvm.tables import table
from rosetta_jit.backends.llvm.values import I64
from rosetta_jit.runtime.code.prelink import is_prelinking
from tests.backends.test_series import tree, within_itself


def calling():
    """A module of three functions: the last one calls the first, and two of them look into a table."""
    module = ir.Module("calling")
    functions = [ir.Function(module, ir.FunctionType(I64, []), name) for name in ("first", "second", "third")]
    builders = [Lines(each.append_basic_block("entry")) for each in functions]
    for builder in builders[:2]:
        builder.ret(builder.load(table(module, (3, 5)), typ=I64))
    builders[2].ret(builders[2].call(functions[0], []))
    functions[0].linkage = "internal"
    return module


def test_a_module_is_let_go_of_as_it_is_printed():
    module = calling()
    text = printing.taken_text(module)
    assert [each.name for each in binding.parse_assembly(text).functions if not each.is_declaration] == ["first", "second", "third"]
    assert not any(each.blocks for each in module.functions)


def test_each_part_declares_what_it_calls_and_has_the_tables_that_it_reads(monkeypatch):
    monkeypatch.setattr(printing, "PART", 1)
    first, second, third = (binding.parse_assembly(part) for part in printing.taken_parts(calling()))
    assert [(each.name, each.is_declaration) for each in third.functions] == [("first", True), ("third", False)]
    assert [len(list(each.global_variables)) for each in (first, second, third)] == [1, 1, 0]
    assert first.get_function("first").linkage.name == "external"


def test_parts_are_of_several_functions_where_these_are_short():
    (text,) = printing.taken_parts(calling())
    assert [each.name for each in binding.parse_assembly(text).functions] == ["first", "second", "third"]


@pytest.fixture
def images(monkeypatch):
    """Makes each program vast from here on; gives the object files of which each has been made."""
    made = list[list[bytes]]()
    own_images = link._own_images

    def noted(of):
        images, declared = own_images(of)
        made.append(images)
        return images, declared

    monkeypatch.setattr(program, "VAST", 0)
    monkeypatch.setattr(printing, "PART", 1)
    monkeypatch.setattr(link, "_own_images", noted)
    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    return made


@pytest.mark.skipif(not is_prelinking(), reason="a linker takes whole programs")
def test_vast_programs_of_parts_do_what_the_interpreter_does(images):
    type_, options = within_itself(60)
    encode, reference = (rj.Encoder.of(type_, **options, backend=backend) for backend in ("llvm", "interpreter"))
    message = bytes(encode(tree(encode.new(), 3)))
    assert message == bytes(reference(tree(reference.new(), 3)))
    decode, reference = (rj.Decoder.of(type_, **options, backend=backend) for backend in ("llvm", "interpreter"))
    assert bytes(encode(decode(message))) == message
    for size in range(0, len(message), 61):
        told = []
        for each in (decode, reference):
            with pytest.raises(rj.DecodeError) as error:
                each(message[:size])
            told.append(str(error.value))
        assert told[0] == told[1]
    assert all(len(each) > 2 for each in images)


@pytest.mark.skipif(not is_prelinking(), reason="a linker takes whole programs")
def test_parts_call_functions_of_users_and_of_the_host(images):
    mapping = 'import "r.proto"\nimport "w.proto"\nfunction f(float64): float64\ndata-holder: R\nwire-schema: W\nunpack-rules:\n'
    files = {
        "r.proto": 'syntax = "proto3"; message R { double value = 1; string name = 2; }',
        "w.proto": 'syntax = "proto3"; message W { double value = 1; string name = 2; }',
        "m.mapping": f"{mapping}  .value = f(.value)\n  .name = upper(.name)\n",
    }
    encode = rj.Encoder.of("W", schema=files, imports=["w.proto"], backend="interpreter")
    message = encode(encode.holder_type.from_dict({"value": 2.0, "name": "me"}))
    found = rj.Decoder("m.mapping", schema=files, functions={"f": lambda x: 3 * x})(message)
    assert (found.value, found.name) == (6.0, "ME")
    assert all(len(each) > 1 for each in images)
