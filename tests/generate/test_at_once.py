"""Messages that generated C++ reads in its header, and arrays that it sets where the object has them: whole, cut at every byte, altered."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.api.options import type_request
from rosetta_jit.generate.build import generated
from rosetta_jit.generate.cpp.decoding.one_by_one import MOST_BYTES
from tests.generate import cpp
from tests.generate.cpp import QUICK
from tests.generate.driver import answers, harmed
from tests.generate.test_cpp import BOTH, same

NUMBERS = "bool flag\nfloat64 x\nint8 small\nuint16 medium\nfloat64[36] covariance\nint32[3] three\nfloat32 y\n"
SEPARATOR = "=" * 80
GAP, POINT = "MSG: rj/Gap\nuint8 kind\nfloat32 value\n", "MSG: rj/Point\nfloat32 x\nfloat32 y\nfloat32 z\n"
GAPS = [{"kind": each, "value": 0.5 * each} for each in range(18)]
POINTS = [{"x": each, "y": -each, "z": 0.25 * each} for each in range(18)]
TRIANGLE, CORNER = "MSG: rj/Triangle\nuint32[3] corners\nint32 side\n", "MSG: rj/Corner\nfloat64 x\nfloat64 y\nfloat64 z\n"
TRIANGLES = [{"corners": [each, each + 1, each + 2], "side": -each} for each in range(18)]
POSE = "MSG: rj/Pose\nCorner position\nbyte kind\nCorner size\n"
POSES = [{"position": {"x": each, "z": -0.5}, "kind": each, "size": {"y": 0.5 * each}} for each in range(6)]
KEYS = [{"key": bytes([each, 0, 255]), "kind": each, "value": bytes(range(each, each + 17))} for each in range(18)]
STATUS = "MSG: rj/Status\nbyte level\nstring name\nfloat32[] raw\nint16[2] two\nValue[] values\nuint16 last\n"
VALUE = "MSG: rj/Value\nstring key\nstring value\n"
VALUES = [{"key": "k" * each, "value": "v" * (40 - each)} for each in range(5)]
STATUSES = [{"level": each, "name": "n" * each, "raw": [0.5] * each, "two": [each, -each], "values": VALUES[:each]} for each in range(4)]
TYPES = {
    "numbers": (NUMBERS, {"flag": True, "x": 1.5, "small": -3, "covariance": [0.5 * i for i in range(36)], "three": [1, -2, 3], "y": 2.5}),
    "text": ("string data\n", {"data": "as it is"}),
    "text behind numbers": ("uint32 seq\nstring frame\nfloat64 x\nuint8 last\n", {"seq": 7, "frame": "base", "x": 0.5, "last": 9}),
    "numbers behind bytes": (
        "float32[3] some\nbool kept\nint64 now\nuint8[3] raw\nint64 end\n",
        {"some": [1.0, 2.0, 3.0], "now": -7, "end": 2},
    ),
    "lists before arrays": (
        "string[] names\nuint32 offset\nstring text\nfloat64[] many\nint8[2] two\nuint8[] last\n",
        {"offset": 3, "text": "t" * 70, "many": [1.0, 2.0], "two": [1, -2]},
    ),
    "lists of numbers": (f"Gap[] gaps\nPoint[] points\n{SEPARATOR}\n{GAP}\n{SEPARATOR}\n{POINT}", {"gaps": GAPS[:3], "points": POINTS[:2]}),
    "a list of numbers": (f"Point[] points\n{SEPARATOR}\n{POINT}", {"points": POINTS[:4]}),
    "a list of flags": (f"Flag[] flags\n{SEPARATOR}\nMSG: rj/Flag\nbool set\nuint8 rest\n", {"flags": [{"set": True, "rest": 2}] * 3}),
    "a list of keys": (
        f"uint8[16] whole\nKey[] keys\n{SEPARATOR}\nMSG: rj/Key\nuint8[3] key\nuint8 kind\nuint8[17] value\n",
        {"whole": bytes(range(16)), "keys": KEYS[:3]},
    ),
    "lists of texts": ("string[] names\nstring[] others\n", {}),
    "triangles": (
        f"Triangle[] triangles\nCorner[] corners\n{SEPARATOR}\n{TRIANGLE}\n{SEPARATOR}\n{CORNER}",
        {"triangles": TRIANGLES[:3], "corners": POINTS[:2]},
    ),
    "poses between texts": (
        f"string frame\nint16 number\nPose[] poses\nstring name\nuint8[] data\nPose pose\n{SEPARATOR}\n{POSE}\n{SEPARATOR}\n{CORNER}",
        {"frame": "base_link", "number": -3, "poses": POSES[:2], "name": "n" * 20, "data": b"some", "pose": POSES[3]},
    ),
    "bytes and a list of texts": (
        f"Kind[] kinds\nstring[] names\nKind[] others\n{SEPARATOR}\nMSG: rj/Kind\nuint8 kind\n",
        {"kinds": [{"kind": each} for each in range(16)], "others": [{"kind": 7}]},
    ),
    "lists within lists": (
        f"uint8 first\nStatus[] statuses\nstring last\n{SEPARATOR}\n{STATUS}\n{SEPARATOR}\n{VALUE}",
        {"first": 1, "statuses": STATUSES, "last": "end"},
    ),
    "arrays": ("string name\nfloat64[] many\nint16[] few\nuint8 last\n", {"name": "n", "many": [1.0, 2.0, 3.0], "few": [-1, 2], "last": 4}),
    "bytes": ("int32[] some\nint64[3] three\nuint8[] data\n", {"some": [1, 2], "three": [1, 2, 3], "data": b"d" * 70}),
    "fixed arrays of texts": (
        f"string[2] two\nFew[3] few\n{SEPARATOR}\nMSG: rj/Few\nstring[2] names\nint8[5] five\nfloat32[] values\n",
        {
            "two": ["one", ""],
            "few": [{"names": ["n" * 17, "\u20ac"], "five": [1, 2, 3, 4, each], "values": [0.5] * each} for each in range(3)],
        },
    ),
}
OTHERS = {
    "text": {"data": "\u00e4\u00f6\u20ac"},
    "text behind numbers": {"frame": "\U0001f916 and more"},
    "arrays": {"name": ""},
    "bytes": {"data": b"some"},
    "lists before arrays": {"names": ["one", "another"]},
    "lists of texts": {"names": ["one"], "others": ["another", ""]},
    "lists of numbers": {"gaps": GAPS[:16], "points": POINTS[:17]},
    "lists within lists": {"statuses": STATUSES[3:]},
    "a list of numbers": {"points": POINTS},
    "a list of keys": {"keys": KEYS},
    "triangles": {"triangles": TRIANGLES, "corners": POINTS[:17]},
    "poses between texts": {"frame": "", "poses": POSES, "name": "\u00e4"},
    "bytes and a list of texts": {"kinds": [{"kind": 3}] * 17, "names": ["one", ""]},
    "a list of flags": {"flags": [{"set": False, "rest": 1}] * 2},
    "fixed arrays of texts": {"two": ["x" * 500, "longer than what is read in the header"]},
}
"""What the source file reads, as lists that have many elements, or texts that have nothing."""
EMPTY_IN_CDR = {
    "a list of numbers",
    "a list of flags",
    "a list of keys",
    "lists of numbers",
    "lists of texts",
    "bytes and a list of texts",
    "bytes",
}
"""Texts of CDR have a byte behind them, and so are never empty."""
EMPTY = {*TYPES} - {"numbers", "numbers behind bytes", "triangles", "fixed arrays of texts"}
WRITTEN = {*TYPES} - {"fixed arrays of texts"}
ONE_LENGTH = {"text", "text behind numbers", "a list of numbers", "a list of flags", "a list of keys"}
"""What has several texts or lists is read by a function that is called, where an empty message is read without one."""
ONE_BY_ONE = {
    "lists before arrays",
    "lists of texts",
    "bytes and a list of texts",
    "lists within lists",
    "a list of flags",
    "fixed arrays of texts",
}
"""What has lists whose elements are set as they are read, as they have texts, or are checked. A compiler says whether that is a call."""
ALIGNED = {"poses between texts"}
"""What lies elsewhere in each message of CDR: elements of a list whose places only a loop says."""


def encoders(type_, encoding):
    """Encoders of a type: of CDR in both orders of bytes."""
    orders = ({"byte_order": "little"}, {"byte_order": "big"}) if encoding == "cdr" else ({},)
    return [rj.Encoder.of("rj/Message", encoding=encoding, schema=schema(type_), **each) for each in orders]


def schema(type_):
    return {"rj/msg/Message.msg": TYPES[type_][0]}


def called(type_):
    """The name of a type's unit."""
    return type_.replace(" ", "_")


@pytest.fixture(scope="module", params=["ros1", "cdr"])
def units(request, tmp_path_factory):
    """The encoding, the texts of all types in it, and the program around them."""
    options = {type_: {"encoding": request.param, "schema": schema(type_)} for type_ in TYPES}
    texts = {type_: generated(type_request("decode", "rj/Message", options[type_]), "cpp", BOTH, called(type_)) for type_ in TYPES}
    folder = tmp_path_factory.mktemp(request.param)
    name = cpp.write_as_one(folder, "units", texts.values())
    return request.param, texts, cpp.program(folder, name, options=QUICK, units=map(called, TYPES))


@cpp.needs_cpp
@pytest.mark.parametrize("type_", TYPES)
def test_messages_that_are_harmed_get_the_same_answers(type_, units):
    encoding, texts, program = units
    header = texts[type_][f"{called(type_)}.hpp"]
    options = {"encoding": encoding, "schema": schema(type_)}
    is_found = encoding == "ros1" or type_ not in ALIGNED
    is_read_empty = type_ in (EMPTY if encoding == "ros1" else EMPTY_IN_CDR)
    is_one_by_one = type_ in ONE_BY_ONE or not is_found
    assert "static bool is_read(" in header
    assert (f"if (end > {MOST_BYTES})" in header) == is_one_by_one
    assert ("static bool is_read_empty(" in header) == is_read_empty
    assert ("ROSETTA_JIT_APART static bool is_read(" in header) == (is_read_empty and not is_one_by_one and type_ not in ONE_LENGTH)
    assert ("put_at_once(" in header) == (type_ in WRITTEN and is_found)
    assert ("statuses_values_list::at(" in header) == (type_ == "lists within lists" and encoding == "ros1")
    values = TYPES[type_][1]
    other = values | OTHERS.get(type_, {})
    encoders_ = encoders(type_, encoding)
    good = [bytes(encode(each)) for encode in encoders_ for each in (values, other, {})]
    messages = [message[:end] + more for message in good for end in range(len(message) + 1) for more in (b"", b"\0", b"\x80")]
    messages += harmed(good, 40, f"{type_} {encoding}")
    same(answers(program, messages, unit=called(type_)), rj.Decoder.of("rj/Message", **options), encoders_[0], messages)


LISTS = {
    "rj/Message": "",
    "rj/msg/Message.msg": "string[] names\nRow[] rows\n",
    "rj/msg/Row.msg": "string name\nfloat64[] many\nint16[2] two\nuint8 last\n",
}


@cpp.needs_cpp
@pytest.mark.parametrize("encoding", ["ros1", "cdr"])
def test_arrays_within_lists_are_written_where_the_object_has_them(encoding, tmp_path):
    files = {name: text for name, text in LISTS.items() if name.endswith(".msg")}
    options = {"encoding": encoding, "schema": files}
    texts = generated(type_request("decode", "rj/Message", options), "cpp", BOTH, "unit")
    assert "point_span<double>" in texts["unit.cpp"]
    encode = rj.Encoder.of("rj/Message", **options)
    rows = [{"name": "n" * i, "many": [0.5 * j for j in range(i)], "two": [i, -i], "last": i} for i in range(5)]
    good = [bytes(encode({"names": ["a", "bc"], "rows": rows[:count]})) for count in (5, 1, 0)]
    messages = [message[:end] for message in good for end in range(len(message) + 1)] + harmed(good, 30, encoding)
    name = cpp.write(tmp_path, texts)
    same(answers(cpp.program(tmp_path, name, options=QUICK), messages), rj.Decoder.of("rj/Message", **options), encode, messages)
