"""Many messages into a batch that has room for them: one compiled step does it, and all that is unusual is as without it."""

from __future__ import annotations

import array

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.runtime.batches import filling

SCHEMA = {"p/A.msg": "int32 n\nstring s\nfloat64[] xs\n"}


def of(program, **options):
    return program.of("p/A", schema=SCHEMA, encoding="ros1", imports=["p/A.msg"], **options)


def plain(number):
    return {"n": number, "s": "s" * number, "xs": [float(each) for each in range(number % 3)]}


@pytest.fixture(scope="module")
def sent():
    encode = of(rj.Encoder)
    messages = [encode(encode.holder_type.from_dict(plain(number))) for number in range(6)]
    return b"".join(messages), np.cumsum([0, *map(len, messages)], dtype=np.int64)


@pytest.fixture(params=["llvm", "python"])
def decode(request):
    return of(rj.Decoder, backend=request.param)


def read(batch):
    return [message.to_dict() for message in batch]


WAYS = {
    "bytes": lambda data, at: (data, at),
    "a bytearray": lambda data, at: (bytearray(data), at),
    "a view": lambda data, at: (memoryview(b"." + data)[1:], at),
    "an array of bytes": lambda data, at: (np.frombuffer(data, np.uint8), at),
    "two rows": lambda data, at: (data, np.array([at[:-1], at[1:]])),
    "another array": lambda data, at: (data, array.array("q", at.tolist())),
    "read-only offsets": lambda data, at: (data, np.frombuffer(at.tobytes(), np.int64)),
}


@pytest.mark.parametrize("way", WAYS)
def test_one_step_does_all(decode, sent, way, monkeypatch):
    """No `Filling` is made where there is code: with the batch's lanes nothing but the compiled step is left to do."""
    batch = decode.many(*sent)
    if decode._fill_rows is not None:
        monkeypatch.setattr(filling, "Filling", None)
    assert decode.many(*WAYS[way](*sent), into=batch) is batch
    assert read(batch) == [plain(number) for number in range(6)]
    assert len(decode.many(b"", np.zeros(1, np.int64), into=batch)) == 0


OTHERS = {
    "strided": lambda data, at: (data, np.repeat(at, 2)[::2]),
    "the columns of a table": lambda data, at: (data, np.stack([at[:-1], at[1:]], axis=1).T),
    "strided bytes, made whole": lambda data, at: (np.ascontiguousarray(np.repeat(np.frombuffer(data, np.uint8), 2)[::2]), at),
    "numbers that are bytes": lambda data, at: (np.frombuffer(data + b"\0" * (-len(data) % 4), np.int32), at),
}


@pytest.mark.parametrize("way", OTHERS)
def test_what_the_step_leaves_to_python(decode, sent, way):
    batch = decode.many(*sent)
    assert read(decode.many(*OTHERS[way](*sent), into=batch)) == [plain(number) for number in range(6)]


WRONG = {
    "int32": (lambda data, at: (data, at.astype(np.int32)), ValueError),
    "the other byte order": (lambda data, at: (data, at.astype(">i8")), ValueError),
    "unsigned": (lambda data, at: (data, at.astype(np.uint64)), ValueError),
    "floats": (lambda data, at: (data, at.astype(float)), ValueError),
    "moments": (lambda data, at: (data, at.view("M8[ns]")), ValueError),
    "a list": (lambda data, at: (data, at.astype(float).tolist()), ValueError),
    "no place": (lambda data, at: (data, at[:0]), ValueError),
    "three rows": (lambda data, at: (data, np.array([at, at, at])), ValueError),
    "three dimensions": (lambda data, at: (data, at.reshape(1, 1, -1)), ValueError),
    "references": (lambda data, at: (np.array([data, at], object), at), TypeError),
    "strided bytes": (lambda data, at: (memoryview(data)[::2], at), BufferError),
    "a number": (lambda data, at: (5, at), TypeError),  # noqa: ARG005
    "a text": (lambda data, at: ("text", at), TypeError),  # noqa: ARG005
}


@pytest.mark.parametrize("way", WRONG)
def test_wrong_arguments_leave_the_batch_as_it_was(decode, sent, way):
    data, at = sent
    batch = decode.many(data, np.array([at[:-1], at[1:] - [0, 1, 0, 0, 0, 0]]), on_error="skip")
    make, error = WRONG[way]
    with pytest.raises(error):
        decode.many(*make(data, at), into=batch)
    assert read(batch) == [plain(number) for number in (0, 2, 3, 4, 5)]
    assert list(batch.errors) == [1]
    assert batch.kept.tolist() == [0, 2, 3, 4, 5]


@pytest.mark.parametrize("on_error", ["raise", "skip", "mask"])
def test_what_stops_in_the_middle_goes_on_from_there(decode, sent, on_error):
    data, at = sent
    places = np.array([at[:-1], at[1:] - [0, 0, 0, 1, 0, 0]])
    batch = decode.many(data, at)
    if on_error == "raise":
        with pytest.raises(rj.DecodeError, match=r"`\[3\]"):
            decode.many(data, places, into=batch)
        with pytest.raises(rj.InvalidHolder):
            _ = batch.n
    else:
        decode.many(data, places, into=batch, on_error=on_error)
        assert list(batch.errors) == [3]
        assert batch.n.tolist() == ([0, 1, 2, 4, 5] if on_error == "skip" else [0, 1, 2, 0, 4, 5])
    assert read(decode.many(data, at, into=batch)) == [plain(number) for number in range(6)]
    assert batch.errors == {}
    assert batch.kept.tolist() == list(range(6))


def test_places_outside_the_buffer_are_told_by_their_number(decode, sent):
    data, at = sent
    batch = decode.many(data, at)
    for begin, end in ((-1, 4), (8, 4), (0, len(data) + 1), (1 << 62, -(1 << 62))):
        with pytest.raises(ValueError, match="of message 1 fall, or leave the buffer"):
            decode.many(data, np.array([[at[0], begin], [at[1], end]]), into=batch)


def test_lanes_grow_on_the_way(decode, sent):
    """Texts of a small batch have little room, and rows no more than there were."""
    data, at = sent
    small = decode.many(data, at[:2])
    assert read(decode.many(data * 40, np.concatenate([at, *(at[1:] + len(data) * each for each in range(1, 40))]), into=small)) == [
        plain(number % 6) for number in range(240)
    ]


def test_batches_of_one_length_share_their_plan(decode, sent):
    data, at = sent
    first, second, third = decode.many(data, at), decode.many(data, at), decode.many(data, at[:3])
    assert first.lanes.plan is second.lanes.plan
    assert (first.lanes.plan.rows, third.lanes.plan.rows) == (6, 2)
    assert read(first) == read(second) == [plain(number) for number in range(6)]
    assert read(third) == [plain(0), plain(1)]
