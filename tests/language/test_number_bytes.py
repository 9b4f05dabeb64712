"""Numbers within bytes, read where they lie and taken apart, against `struct`."""

from __future__ import annotations

import struct

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
CODES = {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q"}
CODES |= {"float32": "f", "float64": "d"}
OF_PROTO = {"int8": "int32", "uint8": "int32", "int16": "int32", "uint16": "int32", "float32": "float", "float64": "double"}
DATA = bytes(range(0x7C, 0x90)) + bytes.fromhex("ff8000000000000080")
FRAME = '"frame" (("at" :int) ("big" :bool) ("data" :blob))'
HEAD = 'import "frame.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: frame\n'


def programs(tmp_path, proto, rules, backend, *kinds):
    files = {"frame.bottle-schema": FRAME, "h.proto": f'syntax = "proto2"; message H {{ {proto} }}', "m.mapping": HEAD + rules}
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    return [kind(tmp_path / "m.mapping", encoding="yarp3", backend=backend) for kind in kinds]


def frame(tmp_path, **fields):
    encode = rj.Encoder.of("frame", search_path=[tmp_path], imports=["frame.bottle-schema"], encoding="yarp3", backend="interpreter")
    return encode(encode.holder_type.from_dict({"at": 0, "big": False, "data": DATA, **fields}))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CODES)
def test_numbers_of_every_type(name, backend, tmp_path):
    proto = f"required {OF_PROTO.get(name, name)} n = 1; required {OF_PROTO.get(name, name)} fixed = 2;"
    rules = f"unpack-rules:\n  .n = {name}_at(.data, .at, .big)\n  .fixed = {name}_at(.data, 2)\n"
    (decode,) = programs(tmp_path, proto, rules, backend, rj.Decoder)
    size = struct.calcsize(CODES[name])
    fixed = struct.unpack_from(f"<{CODES[name]}", DATA, 2)[0]
    for at in range(len(DATA) - size + 1):
        for big, order in ((False, "<"), (True, ">")):
            found = decode(frame(tmp_path, at=at, big=big))
            (wanted,) = struct.unpack_from(f"{order}{CODES[name]}", DATA, at)
            assert struct.pack("<2d", found.n, found.fixed) == struct.pack("<2d", wanted, fixed)
    for at in (-1, len(DATA) - size + 1, 1 << 31 - 1, -(1 << 31)):
        with pytest.raises(rj.DecodeError, match=f"no {size} bytes from there on") as error:
            decode(frame(tmp_path, at=at))
        assert error.value.kind == "index"
        assert (error.value.path, "m.mapping:6" in str(error.value)) == (".n", True)


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes_of_numbers(backend, tmp_path):
    proto = "required int32 i = 1; required double d = 2; required float f = 3; required int32 which = 4;"
    rules = """pack-rules:
  .at = byte(.i, .which)
  .big = byte(.f, 3) == 192
  len(.data) = 14
  for row from 0 to 4
    .data[row] = byte(.f, row)
  end
  for begin from 0 to 8
    .data[4 + begin] = byte(.d, 7 - begin)
  end
  .data[12] = byte(258, 1)
  .data[13] = byte(-1.5, 7)
"""
    (encode,) = programs(tmp_path, proto, rules, backend, rj.Encoder)
    read = rj.Decoder.of("frame", search_path=[tmp_path], imports=["frame.bottle-schema"], encoding="yarp3", backend="interpreter")
    for number in (-2, 1 << 30, -(1 << 31)):
        for which in range(4):
            found = read(encode(encode.holder_type.from_dict({"i": number, "d": -0.1, "f": -2.5, "which": which})))
            assert (found.at, found.big) == (struct.pack("<i", number)[which], True)
            assert bytes(found.data) == struct.pack("<f", -2.5) + struct.pack(">d", -0.1) + b"\x01\xbf"
    for which in (-1, 4):
        with pytest.raises(rj.EncodeError, match="the number has 4 bytes") as error:
            encode(encode.holder_type.from_dict({"i": 1, "d": 0.0, "f": 0.0, "which": which}))
        assert error.value.kind == "index"


@pytest.mark.parametrize(
    ("value", "code", "text"),
    [
        ("int16_at(.data)", "arguments", "does not take 1 value"),
        ("int16_at(.data, 1, .big, 2)", "arguments", "does not take 4 values"),
        ("int16_at(.at, 1)", "no-bytes", "reads a field of bytes"),
        ("int16_at(.data, 1.5)", "integer", "counted in integers"),
        ("int16_at(.data, 1, 2)", "condition", "true or false"),
        ("byte(.at)", "arguments", "does not take 1 value"),
        ("byte(.data, 1)", "operand", "takes a number"),
        ("byte(.at, 4)", "index-range", "the number has 4 bytes"),
        ("int61_at(.data, 1)", "unknown-function", "int64_at"),
    ],
)
def test_mistakes(value, code, text, tmp_path):
    with pytest.raises(rj.MappingError) as error:
        programs(tmp_path, "required int32 n = 1;", f"unpack-rules:\n  .n = {value}\n", "interpreter", rj.Decoder)
    assert [problem.code for problem in error.value.diagnostics if problem.severity == "error"] == [code]
    assert text in str(error.value)


@pytest.mark.parametrize("backend", BACKENDS)
def test_names_of_the_kernel_are_free(backend, tmp_path):
    """Fields and loops may be called as a kernel's own parameters are."""
    files = {
        "w.bottle-schema": '"w" (("row" :int) ("begin" :int) ("end" (:list :int)))',
        "h.proto": 'syntax = "proto2"; message H { required int32 begin = 1; required int32 row = 2; repeated int32 end = 3; }',
        "m.mapping": """import "w.bottle-schema"
import "h.proto"
data-holder: H
wire-schema: w
rules:
  .begin <-> .row
  .row <-> .begin
  len(.end) <-> len(.end)
  for row from 0 to len(.end)
    .end[row] <-> .end[row]
  end
""",
    }
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    decode, encode = (kind(tmp_path / "m.mapping", encoding="yarp3", backend=backend) for kind in (rj.Decoder, rj.Encoder))
    held = {"begin": 1, "row": 2, "end": [3, 4]}
    assert decode(encode(encode.holder_type.from_dict(held))).to_dict() == held
