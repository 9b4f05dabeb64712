"""Editions: what their features mean, on the wire too, as protobuf's own classes have it."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

import rosetta_jit as rj
from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set, from_message_class
from rosetta_jit.frameworks.protobuf.idl import parse
from rosetta_jit.frameworks.protobuf.proto.features import DEFAULTS, FEATURES
from rosetta_jit.model.types import Array, Enum, Map, Optional, Ref
from rosetta_jit.source import Source
from tests.frameworks.protobuf.proto_files import SHIPPED, VECTORS, load_from, protoc, source

FILES = ("presence", "wire", "lexical", "edition2024", "mixed")


@pytest.fixture(scope="module")
def sets(tmp_path_factory):
    out = tmp_path_factory.mktemp("editions")
    return {name: protoc(VECTORS, f"editions/{name}.proto", out / name) for name in FILES}


@pytest.fixture(scope="module")
def native(sets):
    """A function from a file and the name of a message type to protobuf's class."""
    pools = {name: descriptor_pool.DescriptorPool() for name in sets}
    for name, data in sets.items():
        for file in descriptor_pb2.FileDescriptorSet.FromString(data).file:
            pools[name].AddSerializedFile(file.SerializeToString())
    return lambda name, message: message_factory.GetMessageClass(pools[name].FindMessageTypeByName(message))


def fields(name: str, message: str):
    schema = parse(source(VECTORS, f"editions/{name}.proto"), load_from(VECTORS, SHIPPED))
    return {field.name: field for field in schema.types[message].fields}


def test_presence():
    plain = fields("presence", "vec.presence.Plain")
    tracked = {name for name, field in plain.items() if isinstance(field.type, Optional)}
    assert tracked == {"explicit", "required", "text", "told", "inner", "needed", "[vec.presence.Plain.inside]", "[vec.presence.added]"}
    assert {name for name, field in plain.items() if field.required} == {"required", "needed"}
    assert plain["text"].default == "none"
    assert plain["told"].default == 1


def test_encoding_of_messages_and_lists():
    every = fields("wire", "vec.wire.All")
    cases = {case.name: case for case in every["pick"].type.cases}
    delimited = {name for name, field in {**every, **cases}.items() if field.option("group")}
    assert delimited == {"delimited", "many", "a", "deep", "tree", "[vec.wire.far]"}
    packed = {name for name, field in every.items() if field.option("packed")}
    assert packed == {"packed", "packed_doubles", "closed_packed"}
    assert isinstance(every["by_number"].type, Map)
    assert isinstance(every["many"].type, Array)


def test_enums_are_open_unless_they_choose_otherwise():
    types = parse(source(VECTORS, "editions/lexical.proto"), load_from(VECTORS, SHIPPED)).types
    closed = {name.rpartition(".")[2] for name, type_ in types.items() if isinstance(type_, Enum) and type_.closed}
    assert closed == {"Outer", "Inner"}
    assert types["vec.lexical.Message.Freed"].closed is False


def test_what_no_byte_depends_on_is_not_checked():
    """Names out of style, types exported from within others under STRICT, and values of features of a single language."""
    text = """edition = "2024";
        import option "google/protobuf/cpp_features.proto";
        option features.default_symbol_visibility = STRICT;
        message lower { export message Inner {} int32 Upper = 1; string s = 2 [features.(pb.cpp).string_type = NONE]; }"""
    types = parse(Source("style.proto", text), load_from(SHIPPED)).types
    assert {"lower", "lower.Inner"} <= types.keys()
    assert [field.name for field in types["lower"].fields] == ["Upper", "s"]


@pytest.mark.parametrize("name", FILES)
def test_a_generated_class_has_the_schema_of_its_file(name, sets, native):
    file = descriptor_pb2.FileDescriptorSet.FromString(sets[name]).file[-1]
    ours = parse(source(VECTORS, f"editions/{name}.proto"), load_from(VECTORS, SHIPPED)).types
    theirs = from_message_class(native(name, f"{file.package}.{file.message_type[-1].name}")).types
    # Files that are imported for options alone are not known to a class, nor are these options.
    assert theirs.keys() == {full for full in ours if not full.startswith(("google.", "pb.")) and full != "vec.lib.Level"}
    assert all(bare(theirs[full]) == bare(ours[full]) for full in theirs)


def bare(declaration):
    """A declaration without custom options."""
    if isinstance(declaration, Enum):
        return declaration
    kept = (replace(each, options=tuple(pair for pair in each.options if "(" not in pair[0])) for each in declaration.fields)
    return replace(declaration, fields=tuple(kept))


def test_defaults_are_those_of_protobuf():
    feature_set = descriptor_pb2.FeatureSet.DESCRIPTOR
    numbers = {"proto2": 998, "proto3": 999, "2023": 1000, "2024": 1001}
    for name, feature in FEATURES.items():
        field = feature_set.fields_by_name[name]
        assert feature.values.items() <= {value.name: value.number for value in field.enum_type.values}.items()
        options = field.GetOptions()
        for version, number in numbers.items():
            (*_, value) = (each.value for each in options.edition_defaults if each.edition <= number)
            assert getattr(DEFAULTS[version], name) == value
        targets = {descriptor_pb2.FieldOptions.OptionTargetType.Name(target).removeprefix("TARGET_TYPE_") for target in options.targets}
        words = {"ENUM_ENTRY": "ENUMVALUE", "EXTENSION_RANGE": "EXTENSIONRANGE"}
        assert {f"{words.get(target, target)}OPTIONS" for target in targets} == {target.upper() for target in feature.targets}


VALUES = {
    1: [0.0, -2.5],
    3: [0, -1, 2**63 - 1],
    5: [0, 1, -1, 2**31 - 1],
    7: [0, 2**32 - 1],
    9: ["", "a", "héllo", "x" * 200],
    12: [b"", b"\0\xff"],
    17: [0, -1, 2**31 - 1],
    18: [0, -(2**63)],
}
GROUP, MESSAGE, ENUM = 10, 11, 14


def value(field, choose):
    if field.type == ENUM:
        known = [each.number for each in field.enum_type.values]
        return choose.choice(known if field.enum_type.is_closed else [*known, 77])
    return choose.choice(VALUES[field.type])


def fill(message, choose, depth=0):
    """Random values in a message, its maps and extensions included."""
    known = message.DESCRIPTOR.file.pool.FindAllExtensions(message.DESCRIPTOR)
    for field in (*message.DESCRIPTOR.fields, *known):
        is_message = field.type in (GROUP, MESSAGE)
        if not field.is_required and (choose.random() < 0.4 or (is_message and depth > 2)):
            continue
        holder, key = (message.Extensions, field) if field.is_extension else (vars_of(message), field.name)
        for _ in range(choose.randrange(4) if field.is_repeated else 1):
            if is_message and field.message_type.GetOptions().map_entry:
                fill_map(holder[key], field.message_type, choose, depth)
            elif is_message:
                inner = holder[key].add() if field.is_repeated else holder[key]
                inner.SetInParent()
                fill(inner, choose, depth + 1)
            elif field.is_repeated:
                holder[key].append(value(field, choose))
            else:
                holder[key] = value(field, choose)
    return message


def fill_map(entries, type_, choose, depth):
    key = value(type_.fields_by_name["key"], choose)
    of = type_.fields_by_name["value"]
    if of.type == MESSAGE:
        fill(entries[key], choose, depth + 1)
    else:
        entries[key] = value(of, choose)


class vars_of:  # noqa: N801 - reads like `vars`
    """The fields of a message by name, to be read and set."""

    def __init__(self, message):
        self.message = message

    def __getitem__(self, name):
        return getattr(self.message, name)

    def __setitem__(self, name, item):
        setattr(self.message, name, item)


CASES = [
    ("presence", "vec.presence.Plain", "llvm"),
    ("wire", "vec.wire.All", "python"),
    ("wire", "vec.wire.Tree", "llvm"),
    ("wire", "vec.wire.Tree", "python"),
    ("lexical", "vec.lexical.Message", "python"),
    ("edition2024", "vec.e24.Message", "python"),
    ("mixed", "vec.mixed.Old", "llvm"),
]


@pytest.mark.parametrize(("name", "message", "backend"), CASES, ids=[f"{message}-{backend}" for _, message, backend in CASES])
def test_bytes_are_those_of_protobuf(name, message, backend, sets, native):
    options = {"schema": sets[name], "encoding": "protobuf", "backend": backend}
    decode, encode = rj.Decoder.of(message, **options), rj.Encoder.of(message, **options)
    cls, choose = native(name, message), random.Random(message)
    for _ in range(60):
        original = fill(cls(), choose)
        holder = decode(original.SerializeToString(deterministic=True))
        assert cls.FromString(encode(holder)) == original
        assert cls.FromString(encode(type(holder).from_dict(holder.to_dict()))) == original


def test_values_that_a_closed_enum_lacks_are_unknown_fields(sets, native):
    options = {"schema": sets["wire"], "encoding": "protobuf-partial", "backend": "python"}
    decode, encode = rj.Decoder.of("vec.wire.All", **options), rj.Encoder.of("vec.wire.All", **options)
    wire = bytes([4 << 3, 5, 4 << 3, 1, 5 << 3 | 2, 2, 2, 9, 7 << 3, 9, 6 << 3, 9])
    cls = native("wire", "vec.wire.All")
    holder, message = decode(wire), cls.FromString(wire)
    assert list(holder.closed) == list(message.closed) == [1]
    assert list(holder.closed_packed) == list(message.closed_packed) == [2]
    assert holder.HasField("one") is message.HasField("one") is False
    assert list(holder.open) == list(message.open) == [9]
    assert cls.FromString(encode(holder)) == message


def test_a_delimited_message_is_a_group_on_the_wire(sets):
    encode = rj.Encoder.of("vec.wire.Tree", schema=sets["wire"], encoding="protobuf")
    tree = encode.holder_type()
    tree.left.n = 1
    tree.right.n = 2
    assert encode(tree) == bytes([0x13, 0x08, 1, 0x14, 0x1A, 2, 0x08, 2])
    fields = tree.DESCRIPTOR.fields_by_name
    assert (fields["left"].type, fields["right"].type) == (GROUP, MESSAGE)


@pytest.mark.parametrize(
    ("changes", "report"),
    [
        ({"syntax": "editions"}, "an unknown edition"),
        ({"syntax": "editions", "edition": 1002}, "edition 1002"),
        ({"syntax": "editions", "edition": 9999}, "edition 9999"),
        ({"syntax": "proto3", "edition": 1000}, ""),
        ({"syntax": "proto4"}, "proto4"),
    ],
)
def test_a_set_in_another_edition_is_refused(changes, report):
    files = descriptor_pb2.FileDescriptorSet()
    files.file.add(name="a.proto", **changes)
    if not report:
        assert from_file_descriptor_set(files).types == {}
        return
    with pytest.raises(SchemaError, match=f"written in `{report}`"):
        from_file_descriptor_set(files)


def test_an_edition_that_protobuf_does_not_know_is_refused():
    """To an older protobuf package a newer edition is a number that is not in its enum."""
    data = descriptor_pb2.FileDescriptorProto(name="a.proto", syntax="editions").SerializeToString() + bytes([14 << 3, 0xB9, 0x17])
    assert descriptor_pb2.FileDescriptorProto.FromString(data).edition == 0
    with pytest.raises(SchemaError, match="an unknown edition"):
        from_file_descriptor_set(b"\x0a" + bytes([len(data)]) + data)


def test_a_feature_that_protobuf_does_not_know_is_refused():
    files = descriptor_pb2.FileDescriptorSet()
    options = descriptor_pb2.FileOptions.FromString(bytes([0x92, 3, 2, 0x08, 99]))
    files.file.add(name="a.proto", syntax="editions", edition=1000, options=options)
    with pytest.raises(SchemaError, match="a feature has a value that is not known"):
        from_file_descriptor_set(files)


@pytest.mark.parametrize("option", ["proto2", "proto3"])
def test_features_of_older_versions_are_refused_in_descriptors(option):
    files = descriptor_pb2.FileDescriptorSet()
    files.file.add(name="a.proto", syntax=option).options.features.field_presence = 1
    with pytest.raises(SchemaError, match="features need an edition"):
        from_file_descriptor_set(files)


def test_utf8_is_demanded_as_in_proto2():
    text = 'edition = "2023"; message M { string loose = 1 [features.utf8_validation = NONE]; string strict = 2; }'
    decode = rj.Decoder.of("M", schema={"m.proto": text}, encoding="protobuf", backend="python")
    for tag in (0x0A, 0x12):
        with pytest.raises(rj.DecodeError, match="UTF-8"):
            decode(bytes([tag, 1, 0xFF]))


def test_a_required_field_that_is_missing_is_refused(sets):
    decode = rj.Decoder.of("vec.presence.Plain", schema=sets["presence"], encoding="protobuf", backend="python")
    with pytest.raises(rj.DecodeError) as caught:
        decode(b"")
    assert caught.value.kind == "missing"
    assert Ref("vec.presence.Inner") == fields("presence", "vec.presence.Plain")["needed"].type.value
