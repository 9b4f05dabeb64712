"""Whatever a text or a descriptor set holds, a schema or a SchemaError comes out, and soon."""

from __future__ import annotations

import time
from contextlib import suppress

import pytest
from google.protobuf import descriptor_pb2
from hypothesis import given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.protobuf.descriptors import from_file_descriptor_set
from rosetta_jit.frameworks.protobuf.idl import parse
from rosetta_jit.source import Source
from tests.frameworks.protobuf.proto_files import SHIPPED, VECTORS, load_from, protoc, source

SOUP = (VECTORS / "token_soup.txt").read_text("utf-8").split()
BIG, MANY = 10_000, 100_000


def outcome(text: str) -> str:
    try:
        parse(Source("a.proto", text), lambda _: None)
    except SchemaError as error:
        return str(error)
    return ""


@settings(max_examples=300, deadline=None)
@given(st.lists(st.sampled_from(SOUP), max_size=40))
def test_token_soup(words):
    outcome(" ".join(words))


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_files_with_tokens_moved(data):
    words = (
        (
            VECTORS
            / data.draw(st.sampled_from(["shapes2.proto", "options.proto", "words.proto", "editions/wire.proto", "editions/words.proto"]))
        )
        .read_text()
        .split(" ")
    )
    for _ in range(data.draw(st.integers(1, 3))):
        here, there = (data.draw(st.integers(0, len(words) - 1)) for _ in range(2))
        words[here], words[there] = words[there], words[here]
    outcome(" ".join(words))


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=60))
def test_any_text(text):
    outcome(text)
    outcome(f'message M {{ optional string a = 1 [default = "{text}"]; }}')


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_descriptors_with_bytes_changed(data, shapes):
    changed = bytearray(shapes)
    for _ in range(data.draw(st.integers(1, 4))):
        changed[data.draw(st.integers(0, len(changed) - 1))] = data.draw(st.integers(0, 255))
    with suppress(SchemaError):
        from_file_descriptor_set(bytes(changed))


@pytest.fixture(scope="module")
def shapes(tmp_path_factory):
    out = tmp_path_factory.mktemp("sets")
    names = ("shapes2.proto", "shapes3.proto", "extensions.proto", "editions/wire.proto", "editions/lib/public.proto")
    sets = [protoc(VECTORS, name, out / "set") for name in names]
    return b"".join(sets)


def hostile(big):
    """Texts whose parts are repeated up to so many times."""
    return {
        "braces": "message M {" * big,
        "brackets": "option a = " + "{a: [" * big,
        "parentheses": "option " + "(" * big,
        "maps": "message M { map<" + "map<" * big,
        "comment opened again and again": "/*" * big,
        "stars": "/" + "*" * big,
        "quotes": "'\\" * big,
        "long number": "enum E { A = " + "9" * big + "; }",
        "long hexadecimal": "enum E { A = 0x" + "9" * big + "; }",
        "long octal": "enum E { A = 0" + "7" * big + "; }",
        "long name": "message " + "a" * big + " { optional int32 a = 1; }",
        "long package": "package a" + ".a" * big + "; message M {}",
        "long type": "message M { optional a" + ".a" * big + " b = 1; }",
        "long default": "message M { optional string a = 1 [default = " + '"a" ' * big + "]; }",
        "unknown types": "message M { " + "optional A a = 1; " * (big // 10) + "}",
        "wrong statements": "a " * big,
        "wrong statements that end": "a; " * big,
        "closing braces": "}" * big,
        "one reserved number again and again": "message M { reserved " + "1, " * (big // 10) + "1; }",
        "one name again and again": "message M { " + "message A {} " * (big // 10) + "}",
        "many defaults of a great enum": "enum E { "
        + " ".join(f"V{i} = {i};" for i in range(big // 20))
        + "} message M {"
        + " ".join(f"optional E f{i} = {i + 1} [default = V{i}];" for i in range(big // 20))
        + "}",
        "long name of a feature": 'edition = "2023"; option features' + ".a" * big + " = A;",
        "one feature again and again": 'edition = "2023"; ' + "option features.enum_type = OPEN; " * (big // 10),
        "many features at once": 'edition = "2023"; option features = { ' + "a: b " * (big // 10) + "};",
        "underscores": 'edition = "2024"; message M { ' + "".join(f"int32 {'a_' * 200}{i} = {i + 1}; " for i in range(big // 100)) + "}",
        "visibility again and again": 'edition = "2024"; ' + "export local " * big,
        "lone surrogates": 'message M { optional string a = 1 [default = "\ud800"]; }',
    }


@pytest.mark.parametrize("name", hostile(1))
def test_hostile_texts_end_in_time(name):
    ends_in_time(hostile(BIG)[name], 8)


@pytest.mark.campaign
@pytest.mark.parametrize("name", hostile(1))
def test_larger_hostile_texts_end_in_time(name):
    ends_in_time(hostile(MANY)[name], 30)


def ends_in_time(text, seconds):
    start = time.process_time()
    report = outcome(text)
    assert time.process_time() - start < seconds
    assert len(report) < 100_000


def test_a_chain_of_imports_does_not_recurse():
    def load(path: str) -> Source:
        index = int(path)
        return Source(path, f'import public "{index + 1}";' if index < 1500 else "message Last {}")

    assert "Last" in parse(Source("root", 'import "0"; message M { optional Last last = 1; }'), load).types


def test_nested_descriptors_do_not_recurse():
    file = descriptor_pb2.FileDescriptorProto(name="a.proto")
    message = file.message_type.add(name="M")
    for _ in range(90):
        message = message.nested_type.add(name="M")
    assert len(from_file_descriptor_set(descriptor_pb2.FileDescriptorSet(file=[file])).types) == 91


def test_a_hundred_fields_take_little_time():
    text = "message M {" + "".join(f"optional int32 field_{i} = {i + 1} [deprecated = true];\n" for i in range(100)) + "}"
    outcome(text)
    times = []
    for _ in range(5):
        start = time.process_time()
        outcome(text)
        times.append(time.process_time() - start)
    assert min(times) < 0.1


def test_names_of_every_file_are_absolute():
    schema = parse(source(VECTORS, "options.proto"), load_from(VECTORS, SHIPPED))
    assert all(not name.startswith(".") for name in schema.types)
