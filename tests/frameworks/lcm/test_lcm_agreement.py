"""Front end and fingerprints agree with lcm-gen, on every definition at hand and on random ones."""

from __future__ import annotations

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rosetta_jit.errors import SchemaError
from rosetta_jit.frameworks.lcm.fingerprint import fingerprint, own_hash
from rosetta_jit.frameworks.lcm.idl import parse
from rosetta_jit.model.serial import from_plain, to_plain
from rosetta_jit.model.types import Ref, Struct
from rosetta_jit.source import Source
from tests.frameworks.lcm import declarations
from tests.frameworks.lcm.lcm_files import IDL, VECTORS, Generated, load_from, nothing, own_hashes, refused

SHIPPED = sorted((IDL / "lcm").rglob("*.lcm"))
TYPES = {path.relative_to(IDL / "lcm").with_suffix("").as_posix().replace("/", "."): path for path in SHIPPED}
RECORDS = json.loads((VECTORS / "records.json").read_text())


def schema_of(path):
    return parse(Source(str(path), path.read_text()), load_from(IDL))


def structs(schema):
    return [each for each in schema.types.values() if isinstance(each, Struct)]


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    with Generated(tmp_path_factory.mktemp("shipped"), *SHIPPED) as classes:
        yield classes


@pytest.mark.parametrize("name", TYPES)
def test_shipped_types_hash_as_lcm_gen_says(name):
    schema = schema_of(TYPES[name])
    assert own_hash(schema.types[name]) == own_hashes(TYPES[name])[name]


@pytest.mark.parametrize("name", [name for name in TYPES if "." in name])
def test_shipped_fingerprints_are_those_of_lcm_gens_classes(name, generated):
    schema = schema_of(TYPES[name])
    assert fingerprint(schema.types[name], schema).to_bytes(8, "big") == generated[name]._get_packed_fingerprint()


def test_fingerprints_begin_the_recorded_messages():
    for record in RECORDS:
        schema = schema_of(TYPES[record["type"]])
        assert record["bytes"].startswith(f"{fingerprint(schema.types[record['type']], schema):016x}")


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(found=declarations.files())
def test_random_types(found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("random")
    path = folder / "a.lcm"
    path.write_text(declarations.text_of(found))
    schema = parse(Source("a.lcm", path.read_text()), nothing)
    hashes = own_hashes(path)
    assert {each.name: own_hash(each) for each in structs(schema)} == hashes


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(found=declarations.files())
def test_fingerprints_of_random_types_also_of_those_that_were_stored(found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("random")
    path = folder / "a.lcm"
    path.write_text(declarations.text_of(found).replace("[0x3]", "[3]").replace("[03]", "[3]").replace("0X3", "3").replace("= 02", "= 2"))
    schema = parse(Source("a.lcm", path.read_text()), nothing)
    with Generated(folder / "py", path) as classes:
        for each in structs(schema):
            type_, stored = from_plain(to_plain(Ref(each.name), schema))
            theirs = classes[each.name]._get_packed_fingerprint()
            assert fingerprint(each, schema).to_bytes(8, "big") == theirs
            assert fingerprint(stored.resolve(type_), stored).to_bytes(8, "big") == theirs


WORDS = (
    *("struct", "enum", "package", "const", "{", "}", "[", "]", ";", ",", "=", "//", "/*", "*/"),
    *("t", "u", "n", "x.y", "int8_t", "int32_t", "string", "byte", "3", "0", "0x2", "-1", "1.5"),
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(words=st.lists(st.sampled_from(WORDS), max_size=12), inside=st.booleans())
def test_what_lcm_gen_refuses_is_refused(words, inside, tmp_path_factory):
    text = " ".join(["struct t {", *words, "}"] if inside else words) + "\n"
    path = tmp_path_factory.mktemp("soup") / "a.lcm"
    path.write_text(text)
    if refused(path):
        with pytest.raises(SchemaError):
            parse(Source("a.lcm", text), nothing)


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_what_lcm_gen_refuses_is_refused_of_broken_files(data, tmp_path_factory):
    words = data.draw(st.sampled_from(SHIPPED)).read_text().replace("[", " [ ").replace("]", " ] ").replace(";", " ; ").split(" ")
    for _ in range(data.draw(st.integers(1, 2))):
        here, there = (data.draw(st.integers(0, len(words) - 1)) for _ in range(2))
        words[here], words[there] = words[there], words[here]
    text = " ".join(words)
    path = tmp_path_factory.mktemp("moved") / "a.lcm"
    path.write_text(text)
    if refused(path):
        with pytest.raises(SchemaError):
            parse(Source("a.lcm", text), load_from(IDL))
