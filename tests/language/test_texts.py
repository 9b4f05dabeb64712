"""The functions of texts, against Python's own, in every backend and both directions."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.language.texts import BACKENDS, HEAD, SCHEMAS, WIRE, decoder, encoder

WORDS = ["", "a", "Zoë €1 😀 end", "  \t padded\r\n", "a,b,,c", ",", "xyxyx", "ABCxyz[`{@", "long " * 50]


def in_case(text, case):
    return "".join(case(letter) if letter.isascii() else letter for letter in text)


OF_TEXT = {
    "lower(.s)": lambda s, _t: in_case(s, str.lower),
    "upper(.s)": lambda s, _t: in_case(s, str.upper),
    "strip(.s)": lambda s, _t: s.strip(" \t\n\r\v\f"),
    'strip(.s, "ax,")': lambda s, _t: s.strip("ax,"),
    'replace(.s, "xy", "longer")': lambda s, _t: s.replace("xy", "longer"),
    'replace(.s, "a", "")': lambda s, _t: s.replace("a", ""),
    'replace(lower(.s), "€", "EUR")': lambda s, _t: in_case(s, str.lower).replace("€", "EUR"),
    'part(.s, ",", 0)': lambda s, _t: s.split(",")[0],
    '.s + "/" + .t + .s': lambda s, t: s + "/" + t + s,
    'text(len(.s)) + "|" + text(parts(.s, ","))': lambda s, _t: f"{len(s.encode())}|{len(s.split(','))}",
    'upper(.s) if contains(.s, "xy") else strip(.t) + "-"': lambda s, t: s.upper() if "xy" in s else t.strip(" \t\n\r\v\f") + "-",
    'lower(.s if .s > .t else "BOTH" + .t)': lambda s, t: in_case(s if s.encode() > t.encode() else "BOTH" + t, str.lower),
    'behind("x" + .s, "x")': lambda s, _t: s,
    'before(.s + "€", "€")': lambda s, _t: s,
}
OF_TWO = {
    ".s == .t": lambda s, t: s == t,
    ".s != .t": lambda s, t: s != t,
    ".s < .t": lambda s, t: s.encode() < t.encode(),
    ".s <= .t": lambda s, t: s.encode() <= t.encode(),
    ".s > .t": lambda s, t: s.encode() > t.encode(),
    ".s >= lower(.t)": lambda s, t: s.encode() >= in_case(t, str.lower).encode(),
    "starts_with(.s, .t)": lambda s, t: s.startswith(t),
    'ends_with(.s, "xyx")': lambda s, _t: s.endswith("xyx"),
    "ends_with(.t, .s)": lambda s, t: t.endswith(s),
    'contains(.s, ",,")': lambda s, _t: ",," in s,
    'not (len(.s + .t) == 0) and .s != "a"': lambda s, t: len(s + t) != 0 and s != "a",
}


MANY = 'syntax = "proto2"; message Many { repeated string texts = 1; repeated bool answers = 2; }'


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_and_questions(backend):
    """All in one program."""
    rules = [f"len(.texts) = {len(OF_TEXT)}", *(f".texts[{number}] = {each}" for number, each in enumerate(OF_TEXT))]
    rules += [f"len(.answers) = {len(OF_TWO)}", *(f".answers[{number}] = {each}" for number, each in enumerate(OF_TWO))]
    head = 'import "w.bottle-schema"\nimport "many.proto"\ndata-holder: Many\nwire-schema: w\nunpack-rules:\n  '
    schema = {**SCHEMAS, "many.proto": MANY, "m.mapping": head + "\n  ".join(rules) + "\n"}
    decode = rj.Decoder("m.mapping", schema=schema, encoding="yarp3", backend=backend)
    write = rj.Encoder.of("w", schema=SCHEMAS, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    others = ("", "xy", " t ", "xyxy", "A")
    for s in WORDS:
        for t in others if backend == "interpreter" else (*WORDS, *others):
            found = decode(write(write.holder_type.from_dict({**WIRE, "s": s, "t": t})))
            assert list(found.texts) == [expected(s, t) for expected in OF_TEXT.values()], (s, t)
            assert list(found.answers) == [expected(s, t) for expected in OF_TWO.values()], (s, t)


@pytest.mark.parametrize("backend", BACKENDS)
def test_packing(backend):
    run = encoder({"s": 'strip(.s) + "!"', "t": 'upper(.s) if .n > 0 else "none"', "b": "padded(.s, 12)", "i": "len(strip(.s))"}, backend)
    found = run(s=" Zoë ", n=1)
    assert (found["s"], found["t"], found["b"], found["i"]) == ("Zoë!", " ZOë ", " Zoë ".encode().ljust(12, b"\0"), 4)
    assert run(s="x", n=0)["t"] == "none"
    with pytest.raises(rj.EncodeError, match="more than 12 bytes") as error:
        run(s="x" * 13)
    assert (error.value.kind, error.value.path) == ("length", ".b")


@pytest.mark.parametrize("backend", BACKENDS)
def test_parts_and_slices(backend):
    part = decoder({"s": 'part(.s, "::", .i)'}, backend)
    cut = decoder({"s": "slice(.s, .i, .j)"}, backend)
    for text in ("", "a", "a::b", "::a::::b:", "rosetta::jit::texts"):
        parts = text.split("::")
        for number, expected in enumerate(parts):
            assert part(s=text, i=number)["s"] == expected
        for number in (-1, len(parts), 1 << 62):
            with pytest.raises(rj.DecodeError, match="no such part") as error:
                part(s=text, i=number)
            assert (error.value.kind, error.value.path) == ("index", ".s")
    text = "aß€😀"
    starts = [len(text[:n].encode()) for n in range(len(text) + 1)]
    for start in range(12):
        for stop in range(12):
            if start <= stop <= 10 and {start, stop} <= set(starts):
                assert cut(s=text, i=start, j=stop)["s"] == text.encode()[start:stop].decode()
                continue
            with pytest.raises(rj.DecodeError) as error:
                cut(s=text, i=start, j=stop)
            assert error.value.kind == ("text" if start <= stop <= 10 else "index")


@pytest.mark.parametrize("backend", BACKENDS)
def test_fixed_sizes(backend):
    read = decoder({"s": 'text(until_nul(.b), "latin-1")', "b": "padded(until_nul(.b), 6)"}, backend)
    for data in (b"", b"abc", b"abc\0\0\0", b"\0abc", b"caf\xe9\0x"):
        name = data.partition(b"\0")[0]
        assert read(b=data) == {"s": name.decode("latin-1"), "b": name.ljust(6, b"\0"), "n": 0, "x": 0.0, "ok": True}
    with pytest.raises(rj.DecodeError, match="more than 6 bytes"):
        read(b=b"abcdefg")


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("encoding", ["utf-8", "ascii", "latin-1", "utf-16le", "utf-16be"])
def test_encodings(encoding, backend):
    read, write = decoder({"s": f'text(.b, "{encoding}")'}, backend), decoder({"b": f'bytes(.s, "{encoding}")'}, backend)
    for text in (*WORDS, "\x7f\x80ÿĀ\ud7ff\ue000\uffff\U00010000\U0010ffff"):
        try:
            data = text.encode(encoding)
        except UnicodeEncodeError:
            with pytest.raises(rj.DecodeError, match=f"a character that {encoding} lacks") as error:
                write(s=text)
            assert error.value.kind == "text"
            continue
        assert read(b=data)["s"] == text
        assert write(s=text)["b"] == data
    for data in (b"\xff", b"\x00\xd8", b"\xd8\x00", b"\x00\xdc\x00\xd8", b"\xd8\x00\x00a", b"\x00\xd8\x00\xd8\x00\xdc", b"a\xc3"):
        try:
            expected = data.decode(encoding)
        except UnicodeDecodeError:
            with pytest.raises(rj.DecodeError, match="not valid") as error:
                read(b=data)
            assert error.value.kind == "text"
        else:
            assert read(b=data)["s"] == expected


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes_that_are_no_text(backend):
    """Text that a field promises is checked wherever it comes from; bytes are not."""
    assert decoder({"b": 'lower(.b) + .b + replace(.b, "A", "€")'}, backend)(b=b"\xffA")["b"] == b"\xffa\xffA\xff\xe2\x82\xac"
    with pytest.raises(rj.DecodeError, match="not valid UTF-8") as error:
        decoder({"s": "lower(.b)"}, backend)(b=b"\xffA")
    assert error.value.kind == "text"


@pytest.mark.parametrize("encoding", ["yarp", "yarp3", "yarp4"])
def test_dialects(encoding):
    schema = {
        "w.bottle-schema": '"w" (("s" :string) ("t" :string))',
        "h.proto": 'syntax = "proto2"; message H { required string s = 1; }',
        "m.mapping": HEAD + "unpack-rules:\n  .s = strip(.s) + upper(.t)\n",
    }
    decode = rj.Decoder("m.mapping", schema=schema, encoding=encoding, backend="interpreter")
    for dialect in ("yarp3", "yarp4") if encoding == "yarp" else (encoding,):
        write = rj.Encoder.of("w", schema=schema, imports=["w.bottle-schema"], encoding=dialect, backend="interpreter")
        assert decode(write(write.holder_type.from_dict({"s": " a ", "t": "b"}))).s == "aB"


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_of_elements(backend):
    """In a loop, with lists of strings on both sides; a choice looks nothing up for the rounds behind it."""
    schema = {
        "w.bottle-schema": '"w" (("names" (:list :string)) ("unit" :string))',
        "h.proto": 'syntax = "proto2"; message H { repeated string names = 1; repeated int64 sizes = 2; }',
        "m.mapping": """import "w.bottle-schema"
import "h.proto"
data-holder: H
wire-schema: w
unpack-rules:
  len(.names) = len(.names)
  len(.sizes) = len(.names)
  for i from 0 to len(.names)
    .names[i] = text(i) + ":" + (lower(.names[i]) if .names[i] > "b" else .names[i] + .unit)
    .sizes[i] = len(.names[i]) if .unit == "m" else len(strip(.names[i]))
  end
""",
    }
    decode = rj.Decoder("m.mapping", schema=schema, encoding="yarp4", backend=backend)
    write = rj.Encoder.of("w", schema=schema, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")
    names = ["A", "cD", "", "b ", "x" * 1000]
    for unit in ("m", "deg"):
        expected = [f"{n}:{name.lower() if name > 'b' else name + unit}" for n, name in enumerate(names)]
        sizes = [len(name) if unit == "m" else len(name.strip()) for name in names]
        message = write(write.holder_type.from_dict({"names": names, "unit": unit}))
        assert decode(message).to_dict() == {"names": expected, "sizes": sizes}
        rows = decode.many(message * 3, np.arange(4, dtype=np.int64) * len(message))
        assert [row.to_dict() for row in rows] == [{"names": expected, "sizes": sizes}] * 3


@pytest.mark.parametrize("count", [16, 40])
def test_many_texts_are_made(count):
    """What the hidden lane holds is a long sum then, and each text still has its room."""
    names = [f"y{number}" for number in range(count)]
    files = {
        "t/In.msg": "string s\n",
        "t/Out.msg": "".join(f"string {name}\n" for name in names),
        "m.mapping": 'import "t/In.msg"\nimport "t/Out.msg"\ndata-holder: t/Out\nwire-schema: t/In\nunpack-rules:\n'
        + "".join(f'  .{name} = replace(.s, "a", "{name}")\n' for name in names),
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend="python")
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg"], encoding="ros1", backend="interpreter")
    assert decode(write(write.holder_type.from_dict({"s": "banana"}))).to_dict() == {name: f"b{name}n{name}n{name}" for name in names}


def test_texts_of_texts_of_texts():
    text = "replace(" * 20 + ".s" + ', "a", "b")' * 20
    assert decoder({"s": text}, "python")(s="banana")["s"] == "bbnbnb"


ABSENT = {
    "w.proto": """syntax = "proto2"; package w;
message Inner { optional string q = 1 [default = "deep"]; }
message Wire { optional string s = 1 [default = "abc"]; optional bytes o = 2 [default = "a\\377\\000b"]; optional Inner t = 3;
  oneof u { string c = 4 [default = "case"]; int32 i = 5; } }""",
    "h.proto": """syntax = "proto2"; package h;
message Holder { required string s = 1; required bytes o = 2; required string t = 3; required string c = 4; required int64 n = 5;
  required bool e = 6; required bool f = 7; required string up = 8; }""",
    "m.mapping": """import "w.proto"
import "h.proto"
data-holder: h.Holder
wire-schema: w.Wire
unpack-rules:
  .s = .s
  .o = .o
  .t = "<" + .t.q + ">"
  .c = .c
  .n = len(.s) * 100 + len(.o)
  .e = .s == "abc"
  .f = .s < "abd"
  .up = upper(.s)
""",
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_absent_text_reads_as_its_default(backend):
    """As absent numbers do, everywhere: proto2 says what is read of a field that did not come."""
    decode = rj.Decoder("m.mapping", schema=ABSENT, encoding="protobuf", backend=backend)
    write = rj.Encoder.of("w.Wire", schema=ABSENT, imports=["w.proto"], encoding="protobuf", backend="interpreter")
    absent = {"s": "abc", "o": b"a\xff\0b", "t": "<deep>", "c": "case", "n": 304, "e": True, "f": True, "up": "ABC"}
    assert decode(b"").to_dict() == absent
    empty = write(write.holder_type.from_dict({"s": "", "o": b"", "t": {"q": ""}, "c": ""}))
    assert decode(empty).to_dict() == {"s": "", "o": b"", "t": "<>", "c": "", "n": 0, "e": False, "f": True, "up": ""}


def test_defaults_of_bytes_need_not_be_text():
    files = {
        "w.bottle-schema": '"w" (("i" :int))',
        "h.proto": 'syntax = "proto2"; message Holder { required bytes o = 1 [default = "a\\377\\000b"]; }',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: Holder\nwire-schema: w\n'
        "unpack-rules:\n  ignore .i\n  default .o\n",
    }
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp4", backend="python")
    write = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp4", backend="interpreter")
    assert decode(write(write.holder_type.from_dict({"i": 1}))).to_dict() == {"o": b"a\xff\0b"}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("rule", [".t = .s", '.t = "<" + .s', ".t = text(len(.s))", ".t = upper(.s)"])
def test_a_required_text_that_was_never_set_is_refused(rule, backend):
    """As a number is, and not packed as an empty one."""
    files = {
        "p/msg/Text.msg": "string t\n",
        "h.proto": 'syntax = "proto2"; message Holder { required string s = 1; }',
        "m.mapping": f'import "p/msg/Text.msg"\nimport "h.proto"\ndata-holder: Holder\nwire-schema: p/msg/Text\npack-rules:\n  {rule}\n',
    }
    encode = rj.Encoder("m.mapping", schema=files, backend=backend)
    encode(encode.holder_type.from_dict({"s": ""}))
    with pytest.raises(rj.EncodeError) as error:
        encode(encode.holder_type())
    assert (error.value.kind, error.value.path) == ("missing", ".t")
    assert "the required `s` is not there" in str(error.value)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_number_of_parts_is_that_of_an_element(backend):
    """Elements of which the bottle says how far apart they are: a list of integers, or integers each with a code."""
    files = {
        "w.bottle-schema": '"w" (("s" :string) ("n" (:list :int)))',
        "h.proto": 'syntax = "proto3"; message H { int64 n = 1; }',
        "m.mapping": 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n'
        'unpack-rules:\n  .n = .n[parts(.s, "/") - 1]\n',
    }
    write = rj.Encoder.of("w", schema=files, imports=["w.bottle-schema"], encoding="yarp3", backend="interpreter")
    decode = rj.Decoder("m.mapping", schema=files, encoding="yarp3", backend=backend)
    message = write(write.holder_type.from_dict({"s": "a/b/c", "n": [5, 6, 7]}))
    assert decode(message).n == 7
    with pytest.raises(rj.DecodeError) as error:
        decode(write(write.holder_type.from_dict({"s": "a/b/c", "n": [5, 6]})))
    assert (error.value.kind, error.value.path) == ("index", ".n[2]")
