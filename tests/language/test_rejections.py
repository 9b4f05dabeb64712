"""Values in the texts of rejections."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, DEFAULTS, HEAD, SCHEMAS, WIRE

PICTURE = {
    "w.bottle-schema": '"w" (("encoding" :string) ("sizes" (:list :int)))',
    "h.proto": """syntax = "proto2";
message H { enum Mode { GRAY = 0; RGB = 2; } required Mode mode = 1; repeated int32 sizes = 2; }""",
    "m.mapping": """import "w.bottle-schema"
import "h.proto"
data-holder: H
wire-schema: w
unpack-rules:
  .mode = table(.encoding) { "mono8" = H.Mode.GRAY, otherwise reject "no {upper(.encoding)} here, {{mono8}}" }
  len(.sizes) = len(.sizes)
  for i from 0 to len(.sizes)
    reject "size {i} of {len(.sizes)} is {.sizes[i]}" when .sizes[i] < 0
    .sizes[i] = .sizes[i]
  end
pack-rules:
  reject "mode {.mode} with {len(.sizes)} sizes" when .mode == H.Mode.RGB
  .encoding = "mono8"
  .sizes = .sizes
""",
}


def rejecting(text, condition, backend, encoding="yarp3"):
    lines = "".join(f"  .{name} = {value}\n" for name, value in DEFAULTS.items())
    mapping = f'{HEAD}unpack-rules:\n  reject "{text}" when {condition}\n{lines}'
    decode = rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": mapping}, encoding=encoding, backend=backend)
    write = rj.Encoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    return decode, lambda **values: write(write.holder_type.from_dict({**WIRE, **values}))


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
@pytest.mark.parametrize("encoding", ["yarp3", "yarp"])
def test_values_are_shown(backend, encoding):
    text = r"frame {.s} has {.i * 2} joints, {.x} m, {text(.x, 2)} m, {part(.t, \"/\", 1)}, {.b}, {.i > 3}: {{no}}"
    decode, message = rejecting(text, ".i > 2", backend, encoding)
    assert decode(message(i=2)).n == 0
    values = {"s": "torso", "i": 7, "x": 0.125, "t": "a/b/c", "b": b"raw"}
    for _ in range(2):
        with pytest.raises(rj.DecodeError) as error:
            decode(message(**values))
        assert error.value.kind == "rejected"
        assert error.value.detail == "frame torso has 14 joints, 0.125 m, 0.12 m, b, raw, 1: {no} (m.mapping:6:3)"
    assert decode(message()).n == 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_long_values_are_cut(backend):
    decode, message = rejecting("<{.s}>", "len(.s) > 1", backend)
    for text in ("x" * 5000, "€" * 34, "\0\n"):
        with pytest.raises(rj.DecodeError) as error:
            decode(message(s=text))
        assert error.value.detail.startswith(f"<{text.encode()[:100].decode(errors='replace')}>")


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes_that_are_no_text(backend):
    decode, message = rejecting("<{.b}>", "true", backend)
    with pytest.raises(rj.DecodeError, match="<a\ufffdz>"):
        decode(message(b=b"a\xffz"))


@pytest.mark.parametrize("backend", BACKENDS)
def test_tables_loops_and_batches(backend):
    decode = rj.Decoder("m.mapping", schema=PICTURE, encoding="yarp4", backend=backend)
    encode = rj.Encoder("m.mapping", schema=PICTURE, encoding="yarp4", backend=backend)
    write = rj.Encoder.of("w", schema=PICTURE, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")

    def message(encoding, sizes):
        return write(write.holder_type.from_dict({"encoding": encoding, "sizes": sizes}))

    good = message("mono8", [1, 2])
    for wrong, path, detail in [
        (message("rgb8", []), ".mode", "no RGB8 here, {mono8} ("),
        (message("mono8", [3, -4]), "", "size 1 of 2 is -4 ("),
    ]:
        with pytest.raises(rj.DecodeError) as error:
            decode(wrong)
        assert (error.value.path, error.value.detail[: len(detail)]) == (path, detail)
        with pytest.raises(rj.DecodeError) as error:
            decode.many(good + wrong, np.array([0, len(good), len(good) + len(wrong)]))
        assert detail in str(error.value)
    with pytest.raises(rj.EncodeError, match="mode 2 with 3 sizes") as error:
        encode(encode.holder_type.from_dict({"mode": "RGB", "sizes": [1, 2, 3]}))
    assert error.value.kind == "rejected"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("{.nothing}", "unknown-field"),
        ("{.s", "lone-brace"),
        (".s}", "lone-brace"),
        ("{}", "syntax"),
        ("{.s .t}", "syntax"),
        ("{.i +}", "syntax"),
        ("{.i ignore .s}", "syntax"),
        ("{.i pack-rules:}", "syntax"),
        ("{" + "-" * 70 + ".i}", "nesting"),
        ("{.i}" * 30, "many-pieces"),
        ("{len(.i)}", "no-length"),
    ],
)
def test_mistakes(text, code):
    with pytest.raises(rj.MappingError) as error:
        rejecting(text, ".i > 2", "interpreter")
    (problem,) = error.value.diagnostics
    assert problem.code == code
    assert problem.span.source.line_column(problem.span.start)[0] == 6


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_errors_in_loops_name_the_element(backend):
    """With what was wrong first, also where a check does not change from round to round."""
    files = {
        "t/In.msg": "int64[] ks\nstring prefix\n",
        "t/Out.msg": "int32[] a\nt/Row[] rows\nint64[] n\n",
        "t/Row.msg": "int32[2] b\n",
        "m.mapping": """import "t/In.msg"
import "t/Out.msg"
data-holder: t/Out
wire-schema: t/In
unpack-rules:
  .a[] = int32(.ks[])
  len(.rows) = 2
  for i from 0 to 2
    .rows[i].b[0] = 0
    .rows[i].b[1] = int32(.ks[i] * 2)
  end
  .n[] = .ks[] + len(behind(.prefix, "/"))
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")

    def failure(**values):
        with pytest.raises(rj.DecodeError) as error:
            decode(write(write.holder_type.from_dict({"prefix": "/x", **values})))
        return error.value.kind, error.value.path

    assert failure(ks=[0, 0, 2**31]) == ("range", ".a[2]")
    assert failure(ks=[0, 2**30]) == ("range", ".rows[1].b[1]")
    assert failure(ks=[0, 0], prefix="x") == ("text", ".n[0]")
    assert failure(ks=[0, 0], prefix="") == ("text", ".n[0]")
