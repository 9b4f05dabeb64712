"""What a mapping decides: conditions, choices, tables and rejections, in both directions and in every backend."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
FILES = {
    "wire.bottle-schema": '"wire" (("encoding" :string) ("count" :int) ("level" :double) ("values" (:list :double)))',
    "holder.proto": """syntax = "proto2"; package h;
message Picture {
  enum Mode { GRAY = 0; RGB = 1; BGR = 2; }
  required Mode mode = 1; required int32 count = 2; required double level = 3; required bool loud = 4; repeated double values = 5;
}""",
}
HEAD = """import "wire.bottle-schema"
import "holder.proto"
data-holder: h.Picture
wire-schema: wire
"""
UNPACK = """unpack-rules:
  reject "negative counts mean nothing" when .count < 0 or .count == 99
  .mode = table(.encoding) { "mono8" = h.Picture.Mode.GRAY, "rgb8" = h.Picture.Mode.RGB, "bgr8" = h.Picture.Mode.BGR,
                             otherwise reject "no such encoding" }
  .count = int32(.count & 0xff | 1 << 8) if .count > 1000 else .count
  .loud = not (.level <= 10.5) and .encoding != "mono8"
  when .encoding == "mono8"
    .level = -.level
    len(.values) = 0
  else
    .level = .level
    .values = .values
  end
"""
PACK = """pack-rules:
  .encoding = table(.mode) { h.Picture.Mode.GRAY = "mono8", h.Picture.Mode.RGB = "rgb8", otherwise "bgr8" }
  .count = .count
  when .mode == h.Picture.Mode.GRAY
    .level = -.level
    len(.values) = 0
  else
    reject "too many values" when len(.values) > 3
    .level = .level
    len(.values) = len(.values)
    for i from 0 to len(.values)
      .values[i] = .values[i] if .values[i] >= 0 else 0.0
    end
  end
"""


def text(*blocks):
    return {**FILES, "m.mapping": HEAD + "".join(blocks)}


def folder(tmp_path, *blocks):
    for name, content in text(*blocks).items():
        (tmp_path / name).write_text(content)
    return tmp_path / "m.mapping"


def wire(backend, **values):
    encode = rj.Encoder.of("wire", schema=FILES, imports=["wire.bottle-schema"], encoding="yarp3", backend=backend)
    return encode(encode.holder_type.from_dict({"encoding": "rgb8", "count": 1, "level": 1.0, "values": [1.0], **values}))


def read_wire(data):
    return rj.Decoder.of("wire", schema=FILES, imports=["wire.bottle-schema"], encoding="yarp3", backend="interpreter")(data).to_dict()


@pytest.mark.parametrize("backend", BACKENDS)
def test_conditions_to_unpack(tmp_path, backend):
    decode = rj.Decoder(folder(tmp_path, UNPACK), encoding="yarp3", backend=backend)

    def decoded(**values):
        return decode(wire(backend, **values)).to_dict()

    assert decoded() == {"mode": "RGB", "count": 1, "level": 1.0, "loud": False, "values": [1.0]}
    assert decoded(encoding="bgr8", level=10.75) == {"mode": "BGR", "count": 1, "level": 10.75, "loud": True, "values": [1.0]}
    assert decoded(encoding="mono8", level=11.0) == {"mode": "GRAY", "count": 1, "level": -11.0, "loud": False, "values": []}
    assert decoded(count=0x1234)["count"] == 0x34 | 256
    for wrong in ({"count": -1}, {"count": 99}):
        with pytest.raises(rj.DecodeError, match="negative counts mean nothing") as error:
            decoded(**wrong)
        assert error.value.kind == "rejected"
        assert "m.mapping:6:3" in str(error.value)
    for wrong in ("mono16", "", "rgb8 ", "rgb"):
        with pytest.raises(rj.DecodeError, match="no such encoding") as error:
            decoded(encoding=wrong)
        assert (error.value.kind, error.value.path) == ("rejected", ".mode")


@pytest.mark.parametrize("backend", BACKENDS)
def test_conditions_to_pack(tmp_path, backend):
    encode = rj.Encoder(folder(tmp_path, PACK), encoding="yarp3", backend=backend)

    def encoded(**values):
        given = {"mode": "RGB", "count": 5, "level": 2.0, "loud": True, "values": [1.0, -2.0, 3.0], **values}
        return read_wire(encode(encode.holder_type.from_dict(given)))

    assert encoded() == {"encoding": "rgb8", "count": 5, "level": 2.0, "values": [1.0, 0.0, 3.0]}
    assert encoded(mode="BGR", values=[]) == {"encoding": "bgr8", "count": 5, "level": 2.0, "values": []}
    assert encoded(mode="GRAY") == {"encoding": "mono8", "count": 5, "level": -2.0, "values": []}
    with pytest.raises(rj.EncodeError, match="too many values") as error:
        encoded(values=[1.0] * 4)
    assert error.value.kind == "rejected"


def problems(tmp_path, *blocks):
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(folder(tmp_path, *blocks), backend="interpreter")
    return [(problem.code, problem.span.source.line_column(problem.span.start)[0]) for problem in error.value.diagnostics]


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".mode = .count == 1", "type-clash"),
        (".loud = .count", "lossy-conversion"),
        (".loud = .count and true", "condition"),
        (".loud = not .level", "condition"),
        ('.loud = .count == "a"', "not-comparable"),
        (f'.loud = .encoding == "{"a" * 65}"', "long-text"),
        (".count = 1 if .loud else 2", "unknown-field"),
        (".count = .count if .level > 1 else .level", "lossy-conversion"),
        ('.level = 1.0 if .count > 1 else "a"', "mixed-choice"),
        ('when .count > 1 reject "a" .count = 1 end', "unreachable"),
        (".level = .level & 1", "operand"),
        ("when .count end", "condition"),
        ("when .count > 1 .count = 1 end", "never-set"),
        ("for i from 0 to 2 when i > 0 .count = 1 else .level = 1.0 end end", "uneven-rounds"),
    ],
)
def test_mistakes(tmp_path, rule, code):
    rules = f"unpack-rules:\n  {rule}\n"
    assert code in {found for found, line in problems(tmp_path, rules) if line == 6 or code == "never-set"}


def test_each_way_sets_everything(tmp_path):
    without = UNPACK.replace("    .level = .level\n", "")
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder(folder(tmp_path, without))
    (problem,) = error.value.diagnostics
    assert problem.code == "never-set"
    assert problem.notes[-1].startswith("in one way through the `when` blocks, not in all")


def test_ways_are_bounded(tmp_path):
    many = "".join(f"  when .count > {number} .count = 1 else .count = 2 end\n" for number in range(200))
    assert ("too-many-ways", 12) in problems(tmp_path, "unpack-rules:\n" + many)


def test_a_thousand_rejections_are_no_nesting(tmp_path):
    many = "".join(f'  reject "number {number}" when .count == {number}\n' for number in range(300))
    decode = rj.Decoder(folder(tmp_path, UNPACK + many), encoding="yarp3", backend="interpreter")
    with pytest.raises(rj.DecodeError, match="number 250"):
        decode(wire("interpreter", count=250))


def test_large_tables(tmp_path):
    def table(entries, keys=lambda number: number, values=lambda number: number + 1):
        return ", ".join(f"{keys(number)} = {values(number)}" for number in range(entries))

    rest = "  .mode = h.Picture.Mode.RGB\n  .level = .level\n  .loud = true\n  .values = .values\n"
    rules = f"unpack-rules:\n{rest}  .count = table(.count) {{ {table(300)} }}\n"
    decode = rj.Decoder(folder(tmp_path, rules), encoding="yarp3", backend="interpreter")
    assert decode(wire("interpreter", count=299)).count == 300
    with pytest.raises(rj.DecodeError, match="no entry"):
        decode(wire("interpreter", count=300))
    assert ("many-cases", 10) in problems(tmp_path, f"unpack-rules:\n{rest}  .count = table(.count) {{ {table(5000)} }}\n")
    texts = table(60, values=lambda number: f'"{number}"')
    assert ("many-cases", 6) in problems(tmp_path, f"pack-rules:\n  .encoding = table(.count) {{ {texts} }}\n")


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_decides_alone_leaves_the_rest_uncomputed(tmp_path, backend):
    rules = """unpack-rules:
  .mode = h.Picture.Mode.GRAY
  .count = 7 if .count != 0 and 100 / .count > 9 else 8
  .loud = len(.values) < 3 or .values[2] > 0
  .level = .level
  .values = .values
"""
    decode = rj.Decoder(folder(tmp_path, rules), encoding="yarp3", backend=backend)

    def decoded(count, values):
        found = decode(wire(backend, count=count, values=values))
        return found.count, found.loud

    assert decoded(0, []) == (8, True)
    assert decoded(10, [1.0, 1.0, -1.0]) == (7, False)
    assert decoded(50, [1.0, 1.0, 2.0]) == (8, True)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_choice_among_comparisons(tmp_path, backend):
    rules = """unpack-rules:
  .mode = h.Picture.Mode.GRAY
  .loud = .count > 3 if .count != 7 else .level > 0
  .count = .count
  .level = .level
  .values = .values
"""
    decode = rj.Decoder(folder(tmp_path, rules), encoding="yarp3", backend=backend)
    assert [decode(wire(backend, count=count, level=-1.0)).loud for count in (2, 5, 7)] == [False, True, False]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("rule", "good", "bad"), [("bool(.count)", (0, 1), (2, -1)), ("bool(uint64(.level))", (0, 1), (2, 2.0**63))])
def test_no_other_number_is_a_bool(tmp_path, rule, good, bad, backend):
    rules = f"unpack-rules:\n  .loud = {rule}\n  .mode = h.Picture.Mode.RGB\n  .count = .count\n  .level = .level\n  .values = .values\n"
    decode = rj.Decoder(folder(tmp_path, rules), encoding="yarp3", backend=backend)
    field = "level" if "level" in rule else "count"
    assert [decode(wire(backend, **{field: value})).loud for value in good] == [False, True]
    for value in bad:
        with pytest.raises(rj.DecodeError, match="does not fit bool") as error:
            decode(wire(backend, **{field: value}))
        assert (error.value.kind, error.value.path) == ("range", ".loud")


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_enum_has_the_numbers_alone_that_it_names(tmp_path, backend):
    rules = """rules:
  .mode <-> h.Picture.Mode(.count)
  .loud <-> true
  .level <-> .level
  .values <-> .values
unpack-rules:
  .count = 0
pack-rules:
  .encoding = ""
  ignore .count
"""
    decode, encode = (make(folder(tmp_path, rules), encoding="yarp3", backend=backend) for make in (rj.Decoder, rj.Encoder))
    assert [decode(wire(backend, count=count)).to_dict()["mode"] for count in (0, 1, 2)] == ["GRAY", "RGB", "BGR"]
    assert read_wire(encode(decode(wire(backend, count=2))))["count"] == 2
    for count in (3, -1):
        with pytest.raises(rj.DecodeError, match=r"does not fit enum h\.Picture\.Mode") as error:
            decode(wire(backend, count=count))
        assert error.value.kind == "range"


@pytest.mark.parametrize("backend", BACKENDS)
def test_rules_in_any_order(tmp_path, backend):
    """A length may stand behind the elements that it makes room for."""
    unpack = """  for i from 0 to len(.values)
    .values[i] = .values[i]
  end
  .level = .level
  len(.values) = len(.values)
  .mode = h.Picture.Mode.RGB
  .count = .count
  .loud = true
"""
    pack = '  .values[] = .values[]\n  ignore .loud\n  .encoding = table(.mode) { h.Picture.Mode.RGB = "rgb8" }\n  .level = .level\n'
    made = folder(tmp_path, f"unpack-rules:\n{unpack}", f"pack-rules:\n{pack}  len(.values) = len(.values)\n  .count = .count\n")
    decode, encode = (make(made, encoding="yarp3", backend=backend) for make in (rj.Decoder, rj.Encoder))
    message = wire(backend, values=[1.0, 2.0, 3.0])
    assert list(decode(message).values) == [1.0, 2.0, 3.0]
    assert encode(decode(message)) == message


def test_what_refuses_the_whole_message_names_no_field(tmp_path):
    decode = rj.Decoder(folder(tmp_path, UNPACK), encoding="yarp3", backend="interpreter")
    message = wire("interpreter", count=-1)
    with pytest.raises(rj.DecodeError) as error:
        decode(message)
    assert error.value.path == ""
    assert str(error.value) == f"rejected: negative counts mean nothing (m.mapping:6:3) - at byte {len(message)}"
    encode = rj.Encoder(folder(tmp_path, PACK), encoding="yarp3", backend="interpreter")
    with pytest.raises(rj.EncodeError, match=r"^rejected: too many values \(m\.mapping:\d+:\d+\)$"):
        encode(encode.holder_type.from_dict({"mode": "RGB", "count": 1, "level": 0.0, "loud": False, "values": [1.0] * 4}))
