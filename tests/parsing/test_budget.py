"""Texts that say much in few words end soon, in a program or in an error with words of ours; so do files that are none."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import rosetta_jit as rj
from rosetta_jit.catalogue.limits import MAX_CANDIDATES, MAX_COMPARED
from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.lowering.limits import MAX_STATEMENTS
from rosetta_jit.model.expansion import excess
from rosetta_jit.model.limits import MAX_BYTES, MAX_INITIAL_BYTES, MAX_LINKS, MAX_NESTED, MAX_SLOTS
from rosetta_jit.model.types import Array, Field, Int, Ref, Schema, Struct
from rosetta_jit.parsing import search
from rosetta_jit.recording import MAX_MESSAGE_BYTES
from rosetta_jit.runtime.run import ELEMENTS_A_BYTE, GRACE_BYTES

if TYPE_CHECKING:
    from collections.abc import Callable

SECONDS = 30
"""Of the processor; each takes one or two of a machine with nothing else to do."""
PROTO = 'syntax = "proto3"; package t; '
LONE = "\ud800"
"""Half of a character, which no text has, but Python's strings may."""
DOUBLING: dict[str, Callable[[int], tuple[str, dict[str, str]]]] = {
    "proto": lambda n: (
        "t.A",
        {
            "a.proto": f"{PROTO} message M0 {{ int32 a = 1; }}"
            + " ".join(f"message M{i} {{ M{i - 1} a = 1; M{i - 1} b = 2; }}" for i in range(1, n))
            + f"message A {{ M{n - 1} a = 1; }}"
        },
    ),
    "lcm": lambda n: (
        "A",
        {
            "A.lcm": "struct M0 { int32_t a; } "
            + " ".join(f"struct M{i} {{ M{i - 1} a; M{i - 1} b; }}" for i in range(1, n))
            + f" struct A {{ M{n - 1} a; }}"
        },
    ),
    "thrift": lambda n: (
        "A",
        {
            "A.thrift": "struct M0 { 1: i32 a } "
            + " ".join(f"struct M{i} {{ 1: M{i - 1} a; 2: M{i - 1} b }}" for i in range(1, n))
            + f" struct A {{ 1: M{n - 1} a }}"
        },
    ),
    "idl": lambda n: (
        "A",
        {
            "A.idl": "struct M0 { long z; }; "
            + " ".join(f"struct M{i} {{ M{i - 1} y; M{i - 1} z; }};" for i in range(1, n))
            + f" struct A {{ M{n - 1} z; }};"
        },
    ),
    "msg": lambda n: (
        "p/A",
        {
            "p/M0.msg": "int32 a",
            **{f"p/M{i}.msg": f"M{i - 1} a\nM{i - 1} b" for i in range(1, n)},
            "p/A.msg": f"M{n - 1} a",
        },
    ),
}


def refused(type_: str, files: dict[str, str], code: str = "too-large", **options: object) -> None:
    start = time.process_time()
    with pytest.raises(rj.RosettaError) as caught:
        rj.Decoder.of(type_, schema=files, imports=[next(reversed(files))], **options)  # pyright: ignore[reportArgumentType]
    assert time.process_time() - start < SECONDS
    assert isinstance(caught.value, rj.SchemaError)
    assert {each.code for each in caught.value.diagnostics} & {*code.split()}, caught.value


@pytest.mark.parametrize("language", DOUBLING)
@pytest.mark.parametrize("lines", [18, 30])
def test_types_that_double_with_each_line_are_counted_before_they_are_unfolded(language, lines):
    type_, files = DOUBLING[language](lines)
    refused(type_, files, "too-large nesting")


@pytest.mark.parametrize("language", DOUBLING)
def test_types_within_the_budget_become_programs(language):
    type_, files = DOUBLING[language](3)
    assert rj.Decoder.of(type_, schema=files, imports=[next(reversed(files))], backend="interpreter")


@pytest.mark.parametrize("language", DOUBLING)
def test_chains_of_types_are_as_long_as_may_be(language):
    type_, files = DOUBLING[language](2_000)
    refused(type_, files, "too-large nesting")


def test_arrays_of_arrays_are_of_a_size():
    chain = {"p/M0.msg": "float64[1000] a\n", **{f"p/M{i}.msg": f"M{i - 1}[1000] a\n" for i in range(1, 7)}}
    refused("p/M6", chain, encoding="ros1")
    refused(
        "A", {"A.idl": "typedef long T0[1000];" + "".join(f"typedef T{i - 1} T{i}[1000];" for i in range(1, 9)) + "struct A { T8 z; };"}
    )


@pytest.mark.parametrize(
    ("type_", "name", "text"),
    [
        ("p/A", "p/A.msg", "".join(f"float64 a{i}\n" for i in range(20_001))),
        ("t.A", "a.proto", f"{PROTO} message A {{ {' '.join(f'int32 a{i} = {i + 1};' for i in range(18_000))} }}"),
        ("A", "A.idl", f"struct A {{ {' '.join(f'long z{i};' for i in range(20_001))} }};"),
        ("A", "A.lcm", f"struct A {{ {' '.join(f'int32_t a{i};' for i in range(20_001))} }}"),
        ("A", "A.thrift", f"struct A {{ {' '.join(f'{i + 1}: i32 a{i};' for i in range(20_001))} }}"),
        ("A", "A.bottle-schema", f'"A" ({" ".join(f"{chr(40)}{chr(34)}a{i}{chr(34)} :int{chr(41)}" for i in range(20_001))})'),
    ],
    ids=["msg", "proto", "idl", "lcm", "thrift", "bottle"],
)
def test_types_have_so_many_fields(type_, name, text):
    refused(type_, {name: text}, "too-large nesting too-many-fields")


def test_recursive_types_refer_to_each_other_so_often():
    """Each lane of a recursive struct leads to the lanes of all others."""
    each = range(12)
    declared = " ".join(f"message M{i} {{ {' '.join(f'M{j} f{j} = {j + 1};' for j in each)} }}" for i in each)
    refused("t.A", {"a.proto": f"{PROTO} {declared} message A {{ M0 a = 1; }}"})
    assert len(each) ** 2 > MAX_LINKS


def test_what_is_counted():
    def struct(name: str, *types: object) -> Struct:
        return Struct(name, tuple(Field(f"f{i}", type_) for i, type_ in enumerate(types)))  # pyright: ignore[reportArgumentType]

    chain = [struct("m0", Int(32)), *(struct(f"m{i}", Ref(f"m{i - 1}")) for i in range(1, MAX_NESTED + 2))]
    schema = Schema({each.name: each for each in chain})
    assert not excess(chain[MAX_NESTED], schema)
    assert "within each other" in excess(chain[-1], schema)
    wide = struct("w", *([Int(32)] * (MAX_SLOTS - 1)))
    assert not excess(wide, Schema({"w": wide}))
    assert "fields" in excess(struct("w", *wide.fields, *([Int(8)] * MAX_SLOTS)), Schema({"w": struct("w", *([Int(8)] * MAX_SLOTS))}))
    long = struct("l", Array(Int(64), (1 << 37) - 100))
    assert not excess(long, Schema({"l": long}))
    long = struct("l", Array(Int(64), 1 << 37))
    assert "bytes" in excess(long, Schema({"l": long}))


def test_an_empty_message_has_no_fields_to_read():
    decode = rj.Decoder.of("t.A", schema={"a.proto": f"{PROTO} message A {{}}"}, backend="interpreter")
    assert decode(b"").to_dict() == {}


def test_thousands_of_texts_are_compiled_one_by_one():
    """The time of passes over a long run of statements grows with it, not with its square."""
    lines = "".join(f"string s{i}\nfloat64 a{i}\n" for i in range(500))
    start = time.process_time()
    assert rj.Decoder.of("p/A", schema={"p/A.msg": lines}, encoding="ros1").holder_type
    assert time.process_time() - start < 2 * SECONDS


def test_the_page_states_the_budget():
    page = (Path(__file__).resolve().parents[2] / "docs" / "security.md").read_text()
    for stated in (
        f"fields that a type unfolds to | {MAX_SLOTS:,}",
        f"protobuf | {MAX_STATEMENTS:,}",
        f"bound of an array or text | 2{str(MAX_BYTES.bit_length() - 1).translate(str.maketrans('0123456789', '⁰¹²³⁴⁵⁶⁷⁸⁹'))}",
        f"recursion not counted | {MAX_NESTED}",
        f"recursive structs refer to recursive structs | {MAX_LINKS}",
        f"one file or text | {search.MAX_FILE_BYTES >> 20} MiB",
        f"one program is made from | {search.MAX_TEXT_BYTES >> 20} MiB",
        f"message in a recording | {MAX_MESSAGE_BYTES >> 20} MiB",
        f"arrays of fixed length | {MAX_INITIAL_BYTES >> 20} MiB",
        f"at most {ELEMENTS_A_BYTE} *n* elements of each field, and {GRACE_BYTES >> 20} MiB",
    ):
        assert stated in page


# --- names and files -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("type_", "name", "text"),
    [
        ("p/A", "p/A.msg", f"int32 a # {LONE}"),
        ("t.A", "a.proto", f"{PROTO} message A {{ int32 a = 1; }} // {LONE}"),
        ("A", "A.idl", f"struct A {{ long z; }}; // {LONE}"),
        ("A", "A.lcm", f"struct A {{ int32_t a; }} // {LONE}"),
        ("A", "A.thrift", f"struct A {{ 1: i32 a }} // {LONE}"),
        ("A", "A.bottle-schema", f'"A" (("a" :int)) ; {LONE}'),
        ("A", "A.hpp", f"struct A {{ int a; }}; // {LONE}"),
        ("A", "A.tlb", f"<typelib>{LONE}</typelib>"),
    ],
)
def test_half_a_character_is_no_text(type_, name, text):
    refused(type_, {name: text}, "file-not-text")


def test_half_a_character_is_no_mapping():
    with pytest.raises(rj.MappingError, match="not UTF-8"):
        rj.Decoder("m.mapping", schema={"m.mapping": LONE})


@pytest.mark.parametrize("name", ["", "..", "/", "::", LONE, "\0", "x" * 5_000, "."])
@pytest.mark.parametrize(
    "option", ["type_", "encoding", "framework", "byte_order", "backend", "schema", "search_path", "lenient", "imports"]
)
def test_names_of_any_form_end_in_words(option, name):
    type_, options = "t.Nowhere", {option: [name] if option in ("search_path", "lenient", "imports") else name}
    if option == "type_":
        type_, options = name, {}
    if option == "schema":
        options = {"schema": {name: "x"}}
    with pytest.raises(rj.RosettaError):
        rj.Decoder.of(type_, **options)


@pytest.mark.parametrize("encoding", ["", LONE, "ros1"])
def test_drafts_are_of_what_tells_fields_apart(encoding):
    with pytest.raises(rj.SchemaError, match=r"unknown-encoding|no-draft"):
        rj.infer([b""], name="a", encoding=encoding)


@pytest.mark.parametrize("kind", ["folder", "fifo", "device", "circle", "bytes", "nul", "endless name"])
def test_files_that_are_none(kind, tmp_path):
    name = "x" * 5_000 if kind == "endless name" else "a"
    for suffix in (".mapping", ".proto"):
        path = tmp_path / f"{name}{suffix}"
        make = {
            "folder": path.mkdir,
            "fifo": lambda path=path: os.mkfifo(path),
            "device": lambda path=path: path.symlink_to("/dev/zero"),
            "circle": lambda path=path: path.symlink_to(path.name),
            "bytes": lambda path=path: path.write_bytes(b"\xff\xfe"),
            "nul": lambda path=path: path.write_bytes(bytes(100)),
            "endless name": lambda: None,
        }
        make[kind]()
    for made in (rj.Decoder, rj.check):
        with pytest.raises(rj.MappingError):
            made(str(tmp_path / f"{name}.mapping"))
    with pytest.raises(rj.SchemaError):
        rj.Decoder.of("t.A", imports=[f"{name}.proto"], search_path=[tmp_path])


def test_texts_have_a_size_one_by_one_and_together(monkeypatch):
    refused("p/A", {"p/A.msg": "# " + "x" * search.MAX_FILE_BYTES}, "file-too-large")
    monkeypatch.setattr(search, "MAX_TEXT_BYTES", 1_000)
    texts = {"p/B.msg": "int32 a # " + "x" * 600, "p/A.msg": "B b # " + "x" * 600}
    refused("p/A", texts, "file-too-large")


def test_of_hostile_names_few_are_compared():
    assert closest("speeed", ["speed"]) == "speed"
    assert closest("speeed", [*map(str, range(MAX_CANDIDATES)), "speed"]) is None
    assert closest("s" * MAX_COMPARED + "peeed", ["s" * MAX_COMPARED + "peed"]) is None


def test_a_folder_that_was_removed(tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert rj.Decoder("yarp/icub/torso_state.mapping", backend="interpreter")
    monkeypatch.chdir(Path(__file__).parent)
