"""`same names` between fields of one name whose types differ."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
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


@pytest.mark.parametrize(
    ("kinds", "block", "line"),
    [
        ((":double", "float"), "rules", ".x <-> float32(.x)"),
        ((":float32", "double"), "rules", ".x <-> .x"),
        (("(:list :double)", "repeated float"), "rules", ".x[] <-> float32(.x[])"),
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
