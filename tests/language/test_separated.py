"""Arrays of texts as one text and back, against Python's join and split."""

from __future__ import annotations

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
SEPARATORS = {"one": ",", "two": ", ", "alike": "aa", "wide": "é€"}
SCHEMAS = {
    "lab/msg/Robot.msg": "string[] names\nstring line\n",
    "robot.proto": 'syntax = "proto2"; message Robot { required string all = 1; repeated string parts = 2; }',
    "blobs.proto": 'syntax = "proto2"; message Blobs { repeated bytes parts = 1; required bytes line = 2; }',
    "held.proto": 'syntax = "proto2"; message Held { required bytes all = 1; repeated bytes parts = 2; }',
}


@cache
def programs(separator, backend):
    text = f"""import "lab/msg/Robot.msg"
import "robot.proto"
data-holder: Robot
wire-schema: lab/msg/Robot
rules:
  .all <-> join(.names, "{separator}")
  .parts <-> split(.line, "{separator}")
"""
    files = {**SCHEMAS, "m.mapping": text}
    decode, encode = (kind("m.mapping", schema=files, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("lab/msg/Robot", schema=SCHEMAS, imports=["lab/msg/Robot.msg"], backend="interpreter")
    return decode, encode, lambda names, line: write(write.holder_type.from_dict({"names": names, "line": line}))


def split(line, separator):
    return line.split(separator) if line else []


def can_be_joined(names, separator):
    """Whether Python gets the same names back."""
    return split(separator.join(names), separator) == names


NAMES = [
    [],
    ["a"],
    ["c", "ba"],
    ["a", ""],
    ["", ""],
    ["", "b", ""],
    ["été", "ä€", "x"],
    ["a,", "b"],
    ["a", "ab"],
    [",", " "],
]
LONG = ["x" * 300] * 20


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("separator", SEPARATORS.values(), ids=SEPARATORS)
def test_both_directions(separator, backend):
    decode, encode, make = programs(separator, backend)
    for names in NAMES if backend == "interpreter" else [*NAMES, LONG]:
        if not can_be_joined(names, separator):
            continue
        line = separator.join(names)
        found = decode(make(names, line))
        assert found.to_dict() == {"all": line, "parts": split(line, separator)}
        assert encode(found) == make(names, line)


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_could_not_be_split_again(backend):
    decode, encode, make = programs("aa", backend)
    for names in (["baab"], ["b", "aa"], ["ba", "c"], ["aa", "c"]):
        assert not can_be_joined(names, "aa")
        with pytest.raises(rj.DecodeError, match="holds the separator") as error:
            decode(make(names, ""))
        assert (error.value.kind, error.value.path) == ("text", ".all")
    with pytest.raises(rj.DecodeError, match="one empty text"):
        decode(make([""], ""))
    with pytest.raises(rj.EncodeError, match="holds the separator") as error:
        encode(encode.holder_type.from_dict({"all": "", "parts": ["x", "aa"]}))
    assert (error.value.kind, error.value.path) == ("text", ".line")


@settings(max_examples=60, deadline=None)
@given(st.lists(st.text("ab,é", max_size=4), max_size=5), st.text("ab,é", max_size=12), st.sampled_from([",", "ab", "aa", "aba"]))
def test_laws(names, line, separator):
    decode, encode, make = programs(separator, "python")
    try:
        found = decode(make(names, line))
    except rj.DecodeError:
        assert not can_be_joined(names, separator)
        return
    assert can_be_joined(names, separator)
    assert found.to_dict() == {"all": separator.join(names), "parts": split(line, separator)}
    assert encode(found) == make(names, line)
    assert decode(encode(found)).to_dict() == found.to_dict()


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes(backend):
    text = """import "blobs.proto"
import "held.proto"
data-holder: Held
wire-schema: Blobs
rules:
  .all <-> join(.parts, ";")
  .parts <-> split(.line, ";")
"""
    files = {**SCHEMAS, "m.mapping": text}
    decode, encode = (kind("m.mapping", schema=files, backend=backend) for kind in (rj.Decoder, rj.Encoder))
    write = rj.Encoder.of("Blobs", schema=SCHEMAS, imports=["blobs.proto"], backend="interpreter")
    message = write(write.holder_type.from_dict({"parts": [b"\xff", b"", b"\0"], "line": b"a;\xfe;"}))
    found = decode(message)
    assert found.to_dict() == {"all": b"\xff;;\0", "parts": [b"a", b"\xfe", b""]}
    assert encode(found) == message


@pytest.mark.parametrize("backend", BACKENDS)
def test_within_other_texts_and_into_fixed_arrays(backend):
    files = {
        "lab/msg/Robot.msg": "string[] names\nstring line\n",
        "robot.proto": 'syntax = "proto2"; message Robot { required string all = 1; required int64 size = 2; }',
        "m.mapping": """import "lab/msg/Robot.msg"
import "robot.proto"
data-holder: Robot
wire-schema: lab/msg/Robot
unpack-rules:
  .all = upper("<" + join(.names, "|") + ">")
  .size = len(join(.names, "--"))
  ignore .line
""",
    }
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    write = rj.Encoder.of("lab/msg/Robot", schema=files, imports=["lab/msg/Robot.msg"], backend="interpreter")
    found = decode(write(write.holder_type.from_dict({"names": ["a", "bc"], "line": ""})))
    assert found.to_dict() == {"all": "<A|BC>", "size": 5}


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        ('.all = join(.line, ",")', "text-needed"),
        ('.all = join(.names, "")', "empty-text"),
        (".all = join(.names, .line)", "quoted-text"),
        ('.parts = split(.names, ",")', "text-needed"),
        ('.all = split(.line, ",")', "type-clash"),
        ('.all = upper(split(.line, ","))', "text-needed"),
        ('.all = join(split(.line, ","), ";")', "text-needed"),
    ],
)
def test_mistakes(rule, code):
    text = f'import "lab/msg/Robot.msg"\nimport "robot.proto"\ndata-holder: Robot\nwire-schema: lab/msg/Robot\nunpack-rules:\n  {rule}\n'
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, backend="interpreter")
    assert code in {problem.code for problem in error.value.diagnostics}, str(error.value)
