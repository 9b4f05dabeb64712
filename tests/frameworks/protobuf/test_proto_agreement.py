"""A text and the descriptors that protoc makes of it lead to one schema."""

from __future__ import annotations

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, struct_pb2, timestamp_pb2

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set, from_message_class
from rosetta_jit.frameworks.protobuf.idl import parse
from rosetta_jit.frameworks.protobuf.proto.options import OPTIONS
from rosetta_jit.source import Source
from tests.frameworks.protobuf.proto_files import IDL, SHIPPED, VECTORS, load_from, names, protoc, source

CORPUS = [(folder, name) for folder in (VECTORS, IDL, SHIPPED) for name in names(folder)]
RST_TYPES = 70


@pytest.mark.parametrize(("folder", "name"), CORPUS, ids=[name for _, name in CORPUS])
def test_text_and_descriptors_agree(folder, name, tmp_path):
    data = protoc(folder, name, tmp_path / "set")
    assert data is not None
    assert parse(source(folder, name), load_from(folder, SHIPPED)) == from_file_descriptor_set(data)


def test_a_set_of_many_files_agrees_with_each(tmp_path):
    every = Source("all.proto", "\n".join(f'import "{name}";' for name in names(IDL)))
    schema = parse(every, load_from(IDL))
    for name in names(IDL):
        assert schema.types.items() >= parse(source(IDL, name), load_from(IDL)).types.items()


def test_every_rst_type_is_declared_once():
    declared = [name for name in names(IDL) if name.startswith("rst/")]
    every = Source("all.proto", "\n".join(f'import "{name}";' for name in declared))
    outer = {name for name in parse(every, load_from(IDL)).types if name.rpartition(".")[2] in {_stem(n) for n in declared}}
    assert len(declared) == RST_TYPES
    assert {name.replace(".", "/") + ".proto" for name in outer} >= set(declared)


@pytest.mark.parametrize("cls", [timestamp_pb2.Timestamp, struct_pb2.Value, descriptor_pb2.FieldDescriptorProto])
def test_well_known_files_need_not_be_found(cls):
    name = cls.DESCRIPTOR.file.name
    schema = parse(Source("root.proto", f'import "{name}";'), lambda _: None)
    assert schema.types == from_message_class(cls).types


@pytest.mark.parametrize("name", ["scalars2", "shapes3", "imports", "options"])
def test_a_message_class_of_a_pool_of_its_own(name, tmp_path):
    data = protoc(VECTORS, f"{name}.proto", tmp_path / "set")
    files = descriptor_pb2.FileDescriptorSet.FromString(data)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    message = files.file[-1].message_type[-1].name
    descriptor = pool.FindMessageTypeByName(f"{files.file[-1].package}.{message}")
    schema = from_message_class(message_factory.GetMessageClass(descriptor))
    assert schema == from_file_descriptor_set(files)
    assert schema == parse(source(VECTORS, f"{name}.proto"), load_from(VECTORS, SHIPPED))


@pytest.mark.parametrize("holder", OPTIONS)
def test_the_table_of_options_is_that_of_descriptor_proto(holder):
    fields = getattr(descriptor_pb2, holder).DESCRIPTOR.fields
    assert {field.name for field in fields} - {"uninterpreted_option"} <= OPTIONS[holder].keys()


@pytest.mark.parametrize("cut", [1, 7, 100])
def test_a_damaged_set_is_refused(cut, tmp_path):
    data = protoc(VECTORS, "shapes2.proto", tmp_path / "set")
    with pytest.raises(SchemaError, match="damaged"):
        from_file_descriptor_set(data[:-cut])


def test_a_set_without_its_imports_is_refused(tmp_path):
    files = descriptor_pb2.FileDescriptorSet.FromString(protoc(VECTORS, "imports.proto", tmp_path / "set"))
    del files.file[0]
    with pytest.raises(SchemaError, match="there is no file"):
        from_file_descriptor_set(files)


def _stem(name: str) -> str:
    return name.rpartition("/")[2].removesuffix(".proto")
