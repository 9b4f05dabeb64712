"""`same names` between fields of one name whose types differ."""

from __future__ import annotations

import json

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.cli import main
from rosetta_jit.explain.content import explanation
from tests.language.test_laws import files
from tests.language.test_laws_of_several import Both

WIRE = '("n" :int64) ("i" :int) ("l" (:list :int64)) ("f" :float32) ("b" :int8)'
HOLDER = "required int32 n = 1; required int64 i = 2; repeated int32 l = 3; required float f = 4; required int64 b = 5;"


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_integers_of_other_widths(backend):
    both = Both(WIRE, HOLDER, "same names", backend)
    assert str(both.laws) == "messages: exact inverse\nholders: exact inverse"
    values = {"n": -(2**31), "i": 2**31 - 1, "l": [1, -(2**31), 2**31 - 1], "f": 1.5, "b": -128}
    both.assert_message(values, values)
    both.assert_holder(values, values)
    for wrong in ({"n": 2**31}, {"l": [0, -(2**31) - 1]}):
        with pytest.raises(rj.DecodeError) as error:
            both.unpacked({**values, **wrong})
        assert error.value.kind == "range"
    for wrong in ({"i": 2**31}, {"b": 128}):
        with pytest.raises(rj.EncodeError) as error:
            both.packed({**values, **wrong})
        assert (error.value.kind, error.value.path) == ("range", f".{next(iter(wrong))}")


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_floats_of_other_widths(backend):
    wire, holder = (
        '("x" :double) ("f" :float32) ("a" (:list :double)) ("b" (:list :float32))',
        ("required float x = 1; required double f = 2; repeated float a = 3; repeated double b = 4;"),
    )
    both = Both(wire, holder, "same names", backend)
    assert [place for place, _ in both.laws.messages.rounded] == [".x", ".a[]"]
    assert [place for place, _ in both.laws.holders.rounded] == [".f", ".b[]"]
    assert not both.laws.messages.losses
    assert not both.laws.holders.losses
    values = {"x": 0.5, "f": -2.0, "a": [1.5, 2.5], "b": [0.25]}
    both.assert_message(values, values)
    both.assert_holder(values, values)
    near = both.unpacked({**values, "x": 0.1, "a": [0.1]})
    assert (near["x"], near["a"]) == (float(np.float32(0.1)), [float(np.float32(0.1))])


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_renamed_fields(backend):
    wire = '("old" :int64) ("list_old" (:list :float32)) ("same" :int) ("pose" (:bottle ("x" :double)))'
    holder = "required int32 fresh = 1; repeated double list_fresh = 2; required int32 same = 3; required double at = 4;"
    both = Both(wire, holder, "same names with .fresh <-> .old, .list_fresh <-> .list_old, .at <-> .pose.x", backend)
    sent = {"old": -7, "list_old": [1.5, 0.5], "same": 4, "pose": {"x": 2.5}}
    held = {"fresh": -7, "list_fresh": [1.5, 0.5], "same": 4, "at": 2.5}
    both.assert_message(sent, held)
    both.assert_holder(held, sent)
    assert not both.laws.messages.losses
    with pytest.raises(rj.DecodeError) as error:
        both.unpacked({**sent, "old": 2**31})
    assert (error.value.kind, error.value.path) == ("range", ".fresh")


REST_WIRE = '("n" :int64) ("extra" :int) ("old" :float32) ("inner" (:bottle ("x" :double) ("y" :double)))'
REST_HOLDER = "required int64 n = 1; required int32 own = 2; optional string note = 3; required double x = 4;"


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_the_rest_is_left_alone(backend):
    both = Both(REST_WIRE, REST_HOLDER, ".x <-> .inner.x\n  same names\n  ignore rest\n  default rest", backend)
    assert both.unpacked({"n": 7, "extra": 1, "old": 0.5, "inner": {"x": 1.5, "y": 9.0}}) == {"n": 7, "own": 0, "x": 1.5}
    packed = {"n": 7, "extra": 0, "old": 0.0, "inner": {"x": 1.5, "y": 0.0}}
    both.assert_holder({"n": 7, "own": 3, "note": "x", "x": 1.5}, packed)
    mapping = both.decode.mapping
    assert not mapping.warnings
    assert [(each.message, each.notes) for each in mapping.notes] == [
        ("unpacking does not read 3 fields", ("they are: `.extra`, `.old`, `.inner.y`",)),
        ("packing does not set 3 fields", ("they are: `.extra`, `.old`, `.inner.y`",)),
        ("unpacking does not set 2 fields", ("they are: `.own`, `.note`",)),
        ("packing does not read 2 fields", ("they are: `.own`, `.note`",)),
    ]
    lost = {loss.place: loss.why for loss in both.laws.messages.losses}
    assert set(lost) == {".extra", ".old", ".inner.y"}


def test_notes_are_listed_by_check(tmp_path, monkeypatch, capsys):
    for name, text in files(
        REST_WIRE, REST_HOLDER, "unpack-rules:\n  .x = .inner.x\n  same names\n  default rest\n  ignore rest\n"
    ).items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main(["check", "m.mapping", "--strict", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["diagnostics"]
    assert [(each["severity"], each["code"], each["line"]) for each in found] == [("note", "rest", 8), ("note", "rest", 9)]
    assert "`.own`, `.note`" in found[0]["notes"][0]
    assert main(["check", "m.mapping"]) == 0
    assert "2 notes" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("kinds", "block", "line"),
    [
        ((":double", "int32"), "rules", ".x <-> int32(.x)"),
        ((":double", "float"), "unpack-rules", ".x = float32(.x)"),
        ((":int64", "int32"), "unpack-rules", ".x = int32(.x)"),
        ((":float32", "double"), "pack-rules", ".x = float32(.x)"),
        ((":int", "h.Mode"), "rules", ".x <-> h.Mode(.x)"),
        ((":string", "int32"), "rules", "same names except .x"),
    ],
)
def test_what_takes_a_word_is_reported_with_the_rule_to_write(kinds, block, line):
    wire, holder = kinds
    field = holder if holder.startswith("repeated") else f"required {holder}"
    texts = files(f'("x" {wire}) ("y" :int)', f"{field} x = 1; required int32 y = 2;", f"{block}:\n  same names\n")
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=texts, encoding="yarp3", backend="interpreter")
    (problem,) = (each for each in error.value.diagnostics if each.severity == "error")
    assert problem.code == "unlike-names"
    assert problem.help is not None
    assert f"`{line}`" in problem.help
    if line.startswith("same"):
        return
    mended = {**texts, "m.mapping": texts["m.mapping"].replace("same names", f"same names\n  {line}")}
    program = rj.Encoder if block == "pack-rules" else rj.Decoder
    assert program("m.mapping", schema=mended, encoding="yarp3", backend="interpreter").mapping is not None


def test_what_becomes_narrower_is_explained(tmp_path, monkeypatch):
    for name, text in files(WIRE, HOLDER, "rules:\n  same names\n").items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    unpack, pack = explanation("m.mapping", encoding="yarp3").directions
    assert [(line.text, *(note.text for note in line.notes)) for line in unpack.lines] == [
        (".n = .n", "int64 → int32, refused where it does not fit"),
        (".i = .i",),
        (".l = .l", "int64 → int32, refused where it does not fit"),
        (".f = .f",),
        (".b = .b",),
    ]
    assert [line.text for line in pack.lines if line.notes] == [".i = .i", ".b = .b"]
