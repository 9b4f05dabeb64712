"""Arrays in another order: permutations, slices, rows and planes, each against numpy, and back where a relation says so."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.kernel.nodes import Copy, For, SetField
from rosetta_jit.kernel.walk import statements
from rosetta_jit.pipeline.build import Build
from rosetta_jit.pipeline.request import Request
from tests.language.pairs import pair

BACKENDS = ["llvm", "python", "interpreter"]
WIRE = {"w.bottle-schema": '"w" (("k" :int) ("a" (:list :int)))'}
BLOB = {
    "w.bottle-schema": '"w" (("k" :int) ("a" :blob))',
    "h.proto": 'syntax = "proto2"; message H { required int32 k = 1; required bytes b = 2; }',
}
HEAD = 'import "w.bottle-schema"\nimport "h.proto"\ndata-holder: H\nwire-schema: w\n'
HOLDER = {
    "h.proto": """syntax = "proto2"; enum Order { MIXED = 0; PLANES = 1; }
message H { required int32 k = 1; repeated int32 b = 2; repeated int32 c = 3; optional Order order = 4; }"""
}


@pytest.fixture
def programs(tmp_path):
    def make(rules, backend):
        for name, content in {**WIRE, **HOLDER, "m.mapping": HEAD + rules}.items():
            (tmp_path / name).write_text(content)
        kinds = (rj.Decoder, rj.Encoder) if "\npack-rules" in rules else (rj.Decoder,)
        return tuple(kind(tmp_path / "m.mapping", encoding="yarp3", backend=backend) for kind in kinds)

    return make


def message(k, a):
    encode = rj.Encoder.of("w", schema=WIRE, imports=list(WIRE), encoding="yarp3", backend="interpreter")
    return encode(encode.holder_type.from_dict({"k": k, "a": list(map(int, a))}))


def padded(rows, stride):
    return np.pad(rows, ((0, 0), (0, stride - rows.shape[1]))).ravel()


N = np.arange(12)
BOTH = [
    ("reversed(.a)", N, N[::-1]),
    ("reversed(.a, 3)", N, N.reshape(4, 3)[:, ::-1]),
    ("reversed(.a, .k)", N, N.reshape(4, 3)[:, ::-1]),
    ("permuted(.a, [2, 0, 1])", N, N.reshape(4, 3)[:, [2, 0, 1]]),
    ("permuted(permuted(.a, [2, 0, 1]), [1, 0, 2])", N, N.reshape(4, 3)[:, [2, 0, 1]][:, [1, 0, 2]]),
    ("permuted(reversed(.a), [1, 3, 0, 2])", N, N[::-1].reshape(3, 4)[:, [1, 3, 0, 2]]),
    ("transposed(.a, 3, 4)", N, N.reshape(3, 4).T),
    ("transposed(.a, .k, 4)", N, N.reshape(3, 4).T),
    ("transposed(.a, 2, 3, 2)", N, N.reshape(2, 3, 2).transpose(1, 0, 2)),
    ("planar(.a, 3)", N, N.reshape(4, 3).T),
    ("planar(.a, .k)", N, N.reshape(4, 3).T),
    ("planar(.a, 3, 2)", N, N.reshape(2, 3, 2).transpose(1, 0, 2)),
    ("interleaved(.a, 3)", N, N.reshape(3, 4).T),
    ("interleaved(.a, 3, 2)", N, N.reshape(3, 2, 2).transpose(1, 0, 2)),
    ("reversed(planar(.a, 3))", N, N.reshape(4, 3).T.ravel()[::-1]),
    ("rows(.a, .k, 4, 6)", padded(N.reshape(3, 4), 6), N),
    ("rows(.a, 3, 4, 4)", N, N),
    ("padded_rows(.a, .k, 4, 6)", N, padded(N.reshape(3, 4), 6)),
    ("planar(rows(.a, 2, 6, 8), 3)", padded(N.reshape(2, 6), 8), N.reshape(4, 3).T),
    ("planar(rows(.a, 2, 2 * .k, 8), .k)", padded(N.reshape(2, 6), 8), N.reshape(4, 3).T),
    ("reversed(rows(.a, 2, 6, 8), 2)", padded(N.reshape(2, 6), 8), N.reshape(6, 2)[:, ::-1]),
    ("padded_rows(permuted(.a, [1, 0]), 2, 6, 7)", N, padded(N.reshape(6, 2)[:, ::-1].reshape(2, 6), 7)),
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("value", "wire", "held"), BOTH, ids=[case[0] for case in BOTH])
def test_orders_and_their_opposites(programs, value, wire, held, backend):
    decode, encode = programs(f"rules:\n  .k <-> .k\n  .b <-> {value}\nunpack-rules:\n  default .c\npack-rules:\n  ignore .c\n", backend)
    data = message(3, wire)
    found = decode(data)
    assert list(found.b) == list(held.ravel())
    assert encode(found) == data


ONE_WAY = [
    (".a[2 to 5]", N[2:5]),
    (".a[1 to 9 by 3]", N[1:9:3]),
    (".a[1 to 8 by 3]", N[1:8:3]),
    (".a[.k to]", N[3:]),
    (".a[.k to len(.a) - 1 by .k]", N[3:11:3]),
    (".a[2 to][1 to 4]", N[3:6]),
    (".a[4 to 4]", N[:0]),
    ("reversed(.a[1 to 5])", N[4:0:-1]),
    ("transposed(.a[2 to 8], 2, 3)", N[2:8].reshape(2, 3).T.ravel()),
    (".a[[2, 0, 0, 11]]", N[[2, 0, 0, 11]]),
    (".a[3 to][[1, 0]]", N[[4, 3]]),
    ("reversed(.a[[2, 0, 5]])", N[[5, 0, 2]]),
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("value", "held"), ONE_WAY, ids=[case[0] for case in ONE_WAY])
def test_parts(programs, value, held, backend):
    (decode,) = programs(f"unpack-rules:\n  .k = .k\n  .b = {value}\n  .c[] = int32(2 * -.a[])\n", backend)
    found = decode(message(3, N))
    assert list(found.b) == list(held)
    assert list(found.c) == list(-2 * N)


@pytest.mark.parametrize("backend", BACKENDS)
def test_parts_that_make_a_whole(programs, backend):
    rules = "rules:\n  .k <-> .k\n  .b <-> .a[0 to 3]\n  .c <-> reversed(.a[3 to])\npack-rules:\n  len(.a) = 3 + len(.c)\n"
    decode, encode = programs(rules, backend)
    data = message(1, N)
    found = decode(data)
    assert (list(found.b), list(found.c)) == ([0, 1, 2], list(N[:2:-1]))
    assert encode(found) == data
    with pytest.raises(rj.EncodeError, match="different lengths") as error:
        encode(encode.holder_type.from_dict({"k": 1, "b": [1, 2], "c": []}))
    assert error.value.kind == "rejected"
    with pytest.raises(rj.DecodeError):
        decode(message(1, N[:2]))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("value", "k", "kind", "text"),
    [
        ("transposed(.a, .k, 4)", 2, "rejected", "not all elements"),
        ("planar(.a, .k)", 5, "range", "remainder"),
        ("planar(.a, .k)", 0, "range", "division by 0"),
        ("rows(.a, 2, 4, .k)", 3, "rejected", "the rows overlap"),
        ("rows(.a, 4, 3, .k)", 4, "index", "no such element"),
        ("padded_rows(.a, 3, 4, .k)", 3, "count", "ends before it starts"),
        ("padded_rows(.a, 2, .k, 9)", 4, "rejected", "different lengths"),
        (".a[.k to 2]", 3, "rejected", "the slice ends before it starts"),
        (".a[0 to .k]", 13, "index", "no such element"),
        (".a[0 to 3 by .k]", 0, "rejected", "step of a slice"),
        (".a[0 to 3 by .k]", -1, "rejected", "step of a slice"),
        (".a[[0, 13]]", 3, "index", "no such element"),
    ],
)
def test_messages_that_do_not_fit(programs, value, k, kind, text, backend):
    (decode,) = programs(f"unpack-rules:\n  .k = .k\n  default .c\n  .b = {value}\n", backend)
    with pytest.raises(rj.DecodeError, match=text) as error:
        decode(message(k, N))
    assert error.value.kind == kind


# --- a flag beside an array --------------------------------------------------------------------------------------------

FLAGGED = "rules:\n  .k <-> .k\n  .b by .order <-> {{ {} }}\nunpack-rules:\n  default .c\npack-rules:\n  ignore .c\n"
CASES = {"MIXED": "MIXED = .a", "PLANES": "PLANES = planar(.a, 3)"}
PLANES = {"MIXED": N, "PLANES": N.reshape(4, 3).T.ravel()}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("first", CASES)
def test_flag_and_order_are_said_once(programs, first, backend):
    cases = [CASES[first], *(case for name, case in CASES.items() if name != first)]
    decode, encode = programs(FLAGGED.format(", ".join(cases)), backend)
    data = message(0, N)
    found = decode(data)
    assert (found.to_dict()["order"], list(found.b)) == (first, list(PLANES[first]))
    for order, held in PLANES.items():
        assert encode(encode.holder_type.from_dict({"k": 0, "b": held.tolist(), "order": order})) == data


@pytest.mark.parametrize("backend", BACKENDS)
def test_other_flags_are_refused(programs, backend):
    _, encode = programs(FLAGGED.format(CASES["PLANES"]), backend)
    with pytest.raises(rj.EncodeError, match="no layout for this") as error:
        encode(encode.holder_type.from_dict({"k": 0, "b": [1, 2, 3], "order": "MIXED"}))
    assert error.value.kind == "rejected"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_flag_in_one_direction(programs, backend):
    rules = """unpack-rules:
  .k = .k
  default .c
  when .k > 0
    .b by .order = { PLANES = planar(.a, 3) }
  else
    .b by .order = { MIXED = .a }
  end
pack-rules:
  ignore .c
  .k = .k
  .a = table(.order) { MIXED = .b, PLANES = interleaved(.b, 3) }
"""
    decode, encode = programs(rules, backend)
    for k, order in ((1, "PLANES"), (0, "MIXED")):
        found = decode(message(k, N))
        assert (found.to_dict()["order"], list(found.b)) == (order, list(PLANES[order]))
        assert encode(found) == message(k, N)


# --- how ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "value", [".a[2 to 99]", ".a[.k to]", "rows(.a, .k, 40, 40)", "transposed(.a, 1, .k)", "padded_rows(.a, .k, 40, 40)"]
)
def test_what_lies_end_to_end_is_one_copy(tmp_path, value):
    for name, content in {**BLOB, "m.mapping": f"{HEAD}unpack-rules:\n  .k = .k\n  .b = {value}\n"}.items():
        (tmp_path / name).write_text(content)
    (kernel,) = Build(Request("decode", mapping=str(tmp_path / "m.mapping"), encoding="yarp3")).kernels
    (body,) = kernel.bodies
    loops = [stmt for stmt, _ in statements(body) if isinstance(stmt, For)]
    in_loops = [stmt for loop in loops for stmt, _ in statements(loop.body)]
    copies = [stmt for stmt, _ in statements(body) if isinstance(stmt, Copy)]
    assert len([stmt for stmt in copies if stmt not in in_loops]) == 1
    assert not any(isinstance(stmt, SetField) for stmt in in_loops)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_array_of_fixed_length(backend):
    """How many groups there are follows from the type."""
    files = {
        "t/W.msg": "float64[4] q\nint32[6] k\n",
        "t/H.msg": "float64[4] q\nint32[6] k\n",
        "m.mapping": """import "t/W.msg"
import "t/H.msg"
data-holder: t/H
wire-schema: t/W
rules:
  .q <-> permuted(.q, [1, 2, 3, 0])
  .k <-> planar(.k, 3)
""",
    }
    options = {"schema": files, "encoding": "ros1", "backend": backend}
    decode, encode = rj.Decoder("m.mapping", **options), rj.Encoder("m.mapping", **options)
    write = rj.Encoder.of("t/W", imports=["t/W.msg"], **{**options, "backend": "interpreter"})
    data = write(write.holder_type.from_dict({"q": [0.0, 1.0, 2.0, 3.0], "k": list(range(6))}))
    assert decode(data).to_dict() == {"q": [1.0, 2.0, 3.0, 0.0], "k": [0, 3, 1, 4, 2, 5]}
    assert encode(decode(data)) == data


@pytest.mark.parametrize("backend", BACKENDS)
def test_several_images_of_one_message(backend):
    numbers = range(5)
    fields = "".join(f"uint16 w{i}\nuint16 h{i}\n" for i in numbers) + "".join(f"uint8[] p{i}\n" for i in numbers)
    rules = "".join(f".w{i} <-> .w{i}\n.h{i} <-> .h{i}\n.p{i} <-> rows(.p{i}, .h{i}, .w{i} * 3, align(.w{i} * 3, 4))\n" for i in numbers)
    head = 'import "lab/msg/In.msg"\nimport "lab/msg/Out.msg"\ndata-holder: lab/msg/Out\nwire-schema: lab/msg/In\nrules:\n'
    files = {"lab/msg/In.msg": fields, "lab/msg/Out.msg": fields, "m.mapping": head + rules}
    decode = rj.Decoder("m.mapping", schema=files, backend=backend)
    encode = rj.Encoder("m.mapping", schema=files, backend=backend)
    values = {name: value for i in numbers for name, value in ((f"w{i}", i), (f"h{i}", 2), (f"p{i}", bytes(range(6 * i))))}
    read = rj.Decoder.of("lab/msg/In", schema=files, imports=["lab/msg/In.msg"], backend="interpreter")
    sent = encode(encode.holder_type.from_dict(values))
    assert bytes(read(sent).p1) == bytes([0, 1, 2, 0, 3, 4, 5, 0])
    assert decode(sent).to_dict() == values


@pytest.mark.parametrize("backend", BACKENDS)
def test_slices_whose_ends_and_step_are_fields_of_a_list(backend):
    """The elements of a bottle's list lie apart as each message says, so that an index that is a product is one more factor."""
    lists = pair('("i" :int64) ("j" :int64) ("k" :int64) ("a" (:list :double))', "repeated double a = 1;", SLICED, backend)
    values = [0.5 * number for number in range(9)]
    for i, j, k in ((0, 9, 1), (1, 9, 3), (2, 2, 5), (8, 9, 1 << 62)):
        assert lists.unpack(i=i, j=j, k=k, a=values) == {"a": values[i:j:k]}
    for i, j, k in ((0, 10, 1), (-1, 3, 1), (0, 3, 0), (0, 1 << 62, 1 << 61)):
        with pytest.raises(rj.DecodeError):
            lists.unpack(i=i, j=j, k=k, a=values)


SLICED = """unpack-rules:
  .a = .a[.i to .j by .k]
pack-rules:
  .i = 0
  .j = len(.a)
  .k = 1
  .a = .a
"""


def test_pixels_turned_round_are_moved_by_vectors():
    """LLVM makes vectors of a loop only where it sees that places grow by the same in each round."""
    turned = "rules:\n  .k <-> .k\n  .b <-> reversed(rows(.a, .k, 6, 8), 3)\n"
    decode = rj.Decoder("m.mapping", schema={**BLOB, "m.mapping": HEAD + turned}, encoding="yarp3")
    assert " x i8>" in decode.stage("llvm")
