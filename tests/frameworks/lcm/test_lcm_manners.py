"""Holders have the manners of lcm-gen's classes: each test runs with both."""

from __future__ import annotations

import copy
import io
import pickle

import numpy as np
import pytest

from rosetta_jit import Decoder
from rosetta_jit.errors import DecodeError, EncodeError
from tests.frameworks.lcm.lcm_files import Generated
from tests.frameworks.lcm.values import of_generated, of_holder

TEXT = """package manners_p;

struct inner_t
{
    int16_t a;
    string s;
}

struct all_t
{
    const int32_t K = 16, L = -0x10;
    const double PI = 3.5;
    int32_t n;
    boolean b;
    float f;
    string s;
    byte raw;
    byte blob[n];
    double d[n][3];
    int64_t cube[2][2][2];
    int8_t grid[2][n];
    string names[2];
    inner_t ins[2];
    inner_t one;
    inner_t many[n];
    byte blobs[2][n];
    boolean flags[K];
}

struct bytes_t
{
    byte x[3];
}
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("manners")
    path = folder / "a.lcm"
    path.write_text(TEXT)
    with Generated(folder, path) as classes:
        yield classes


def holder_type(name):
    return Decoder.of(f"manners_p.{name}", encoding="lcm", schema={"a.lcm": TEXT}).holder_type


@pytest.fixture(scope="module")
def ours():
    return holder_type("all_t")


@pytest.fixture(params=["theirs", "ours"])
def cls(request, theirs, ours):
    return ours if request.param == "ours" else theirs["manners_p.all_t"]


def test_a_new_message_has_the_same_values(theirs, ours):
    assert of_holder(ours()) == of_generated(theirs["manners_p.all_t"]())


def test_it_says_what_it_has(theirs, ours):
    peer = theirs["manners_p.all_t"]
    assert list(ours.__slots__) == peer.__slots__
    assert ours.__typenames__ == peer.__typenames__
    assert ours.__dimensions__ == peer.__dimensions__
    assert ours.__name__ == peer.__name__
    assert ours().one.__slots__ == ("a", "s")


def test_constants_are_attributes(cls):
    assert (cls.K, cls.L, cls.PI, cls().K) == (16, -16, 3.5, 16)


def test_the_fingerprint(theirs, ours):
    peer = theirs["manners_p.all_t"]
    assert ours._get_packed_fingerprint() == peer._get_packed_fingerprint() == ours()._get_packed_fingerprint()
    assert ours().get_hash() == peer().get_hash()


def fill(message):
    message.n = 2
    message.s = "é"
    message.blob = b"ab"
    message.d = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    message.cube[1][0][1] = -7
    message.grid = [[1, 2], [3, 4]]
    message.names = ["x", "y"]
    message.ins[1].s = "in"
    message.one.a = 5
    message.many = [message.one, message.ins[1]]
    message.blobs = [b"ab", b"cd"]
    message.flags[3] = True
    return message


def test_encode_and_decode(cls, theirs):
    message = fill(cls())
    data = message.encode()
    assert data == fill(theirs["manners_p.all_t"]()).encode()
    found = cls.decode(data)
    assert isinstance(found, cls)
    assert found.encode() == data
    assert message.decode(data).encode() == data
    assert cls.decode(io.BytesIO(data)).encode() == data


def test_what_is_no_message_of_the_type_is_a_value_error(cls):
    with pytest.raises(ValueError):  # noqa: PT011  lcm-gen's classes say nothing more
        cls.decode(bytes(200))


def test_where_decoding_failed(ours):
    data = fill(ours()).encode()
    with pytest.raises(DecodeError, match=r"truncated.*\.flags"):
        ours.decode(data[:-1])
    with pytest.raises(DecodeError, match="constant"):
        ours.decode(b"\xff" + data[1:])


def test_nested_messages_encode_too(cls, theirs):
    one = fill(cls()).one
    assert one.encode() == theirs["manners_p.inner_t"].decode(one.encode()).encode()


def test_a_size_must_agree_with_its_array(ours):
    message = ours()
    message.n = 1
    with pytest.raises(EncodeError, match=r"must agree.*\.blob"):
        message.encode()


def test_arrays_of_numbers_are_numpys(ours):
    message = fill(ours())
    assert message.cube.shape == (2, 2, 2)
    assert message.cube.dtype == np.int64
    assert message.flags.dtype == np.bool_
    assert message.grid[1].tolist() == [3, 4]


def test_copies_and_pickles(ours):
    message = fill(ours())
    assert copy.deepcopy(message) == message == pickle.loads(pickle.dumps(message))  # noqa: S301  our own


def test_bytes_of_fixed_size_are_as_many_as_there_must_be(theirs):
    """lcm-gen's are empty at first, and encode to a message that its own decoder misreads."""
    assert holder_type("bytes_t")().x == bytes(3)
    assert len(theirs["manners_p.bytes_t"]().encode()) == 8


HOSTILE = """struct t
{
    const int8_t __init__ = 1, lanes_ = 2, encode = 3, _get_packed_fingerprint = 4;
    int8_t decode, _programs, new;
}"""


def test_names_that_the_holder_needs():
    decode = Decoder.of("t", encoding="lcm", schema={"a.lcm": HOSTILE}, backend="python")
    message = decode(bytes.fromhex(f"{decode.holder_type.get_hash():016x}010203"))
    assert message.to_dict() == {"decode": 1, "_programs": 2, "new": 3}
    assert (message.encode, message.decode, message.new) == (3, 1, 3)


def test_enums_are_numbers(tmp_path):
    """In arrays: lcm-gen's classes cannot be made where a field is an enum by itself."""
    text = "package enums_q;\nenum color_t { RED, GREEN = 5 }\nstruct t { int8_t n; color_t b[n]; }\n"
    (tmp_path / "a.lcm").write_text(text)
    decode = Decoder.of("enums_q.t", encoding="lcm", schema={"a.lcm": text}, backend="python")
    with Generated(tmp_path, tmp_path / "a.lcm") as classes:
        color, peer = classes["enums_q.color_t"], classes["enums_q.t"]()
        peer.n, peer.b = 3, [color(1), color(5), color(77)]
        message = decode(peer.encode())
        assert message.b.tolist() == [1, 5, 77]
        assert message.to_dict() == {"n": 3, "b": ["RED", "GREEN", 77]}
        assert message.encode() == peer.encode()
