"""State: what programs keep from one message to the next, alike on every backend, and only of messages that are right."""

from __future__ import annotations

import copy
import math
import pickle
import threading
from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj

BACKENDS = ("llvm", "numba", "python", "interpreter")
HEAD = """import "m.bottle-schema"
import "m.proto"
data-holder: M
wire-schema: m
"""
SCHEMAS = {
    "m.bottle-schema": '"m" (("position" :double) ("seq" :int64) ("good" :bool))',
    "m.proto": """syntax = "proto2";
message M {
  required double speed = 1; required double low = 2; required int64 seen = 3; required bool gap = 4; required string note = 5;
}""",
}
MAPPING = f"""{HEAD}
parameter share: float64 = 0.25
state last: float64 = 0.0
state low: float64 = 0.0
state seen: int64 = 0
state next: int64 = 0
state was_good: bool = true
unpack-rules:
  reject "bad" when not .good and not was_good
  .speed = (.position - last) * 100.0 if seen > 0 else 0.0
  .low = low + share * (.position - low)
  .seen = seen
  .gap = seen > 0 and .seq != next
  .note = text(seen)
  state last = .position
  state low = low + share * (.position - low)
  state seen = seen + 1
  state next = .seq + 1
  when .seq > 0
    state was_good = .good
  end
pack-rules:
  ignore .speed
  ignore .low
  ignore .gap
  ignore .note
  .position = last
  .seq = .seen + seen
  .good = was_good
  state last = float64(.seen)
  state seen = .seen + seen
  state was_good = not was_good
"""


def files(mapping=MAPPING):
    return {**SCHEMAS, "m.mapping": mapping}


def decoder(backend, **options):
    return rj.Decoder("m.mapping", schema=files(), encoding="yarp4", backend=backend, **options)


def encoder(backend):
    return rj.Encoder("m.mapping", schema=files(), encoding="yarp4", backend=backend)


WRITE = rj.Encoder.of("m", schema=files(), imports=["m.bottle-schema"], encoding="yarp4", backend="python")
READ = rj.Decoder.of("m", schema=files(), imports=["m.bottle-schema"], encoding="yarp4", backend="python")


def message(position=0.0, seq=1, good=True):
    return WRITE(WRITE.holder_type.from_dict({"position": position, "seq": seq, "good": good}))


class Model:
    """What the rules to unpack say, in Python."""

    def __init__(self, share=0.25):
        self.share, self.state = share, {"last": 0.0, "low": 0.0, "seen": 0, "next": 0, "was_good": True}

    def decode(self, values):
        """The holder, or the kind of the error; ``values`` are None where the message is cut."""
        if values is None:
            return "truncated"
        position, seq, good = values
        s = self.state
        if not good and not s["was_good"]:
            return "rejected"
        low = s["low"] + self.share * (position - s["low"])
        if seq == 2**63 - 1 or s["seen"] == 2**63 - 1:
            return "range"
        speed, gap = ((position - s["last"]) * 100.0, seq != s["next"]) if s["seen"] else (0.0, False)
        found = {"speed": speed, "low": low, "seen": s["seen"], "gap": gap, "note": str(s["seen"])}
        self.state = {"last": position, "low": low, "seen": s["seen"] + 1, "next": seq + 1, "was_good": good if seq > 0 else s["was_good"]}
        return found


def outcome(decode, data):
    try:
        return decode(data).to_dict()
    except rj.DecodeError as error:
        return error.kind


def same(found, expected):
    return repr(found) == repr(expected)  # NaN is itself


VALUES = st.tuples(st.floats(width=64), st.sampled_from((-3, 0, 1, 2, 3, 2**63 - 1)) | st.integers(-(2**63), 2**63 - 1), st.booleans())
SEQUENCES = st.lists(st.none() | VALUES, max_size=12)


def sent(values):
    return message()[:-3] if values is None else message(*values)


@pytest.mark.parametrize("backend", BACKENDS)
def test_any_sequence_of_messages(backend):
    decode = decoder(backend)

    @settings(max_examples=60 if backend in ("llvm", "numba") else 25, deadline=None)
    @given(SEQUENCES)
    def check(sequence):
        decode.reset()
        model = Model()
        for values in sequence:
            expected = model.decode(values)
            assert same(outcome(decode, sent(values)), expected)
            assert same(decode.state, model.state)

    check()


@pytest.mark.parametrize("backend", BACKENDS)
def test_any_batch(backend):
    """Rows in their order, at once; those that fail are as if they had never come."""
    decode = decoder(backend)

    @settings(max_examples=40 if backend in ("llvm", "numba") else 15, deadline=None)
    @given(SEQUENCES, st.sampled_from(["skip", "mask", "raise"]))
    def check(sequence, on_error):
        decode.reset()
        model, good, failed = Model(), [], None
        for number, values in enumerate(sequence):
            expected = model.decode(values)
            if isinstance(expected, str):
                failed = number
                if on_error == "raise":
                    break
            else:
                good.append((number, expected))
        messages = [sent(values) for values in sequence]
        if on_error == "raise" and failed is not None:
            with pytest.raises(rj.DecodeError, match=rf"\[{failed}\]"):
                decode.many(messages)
        else:
            rows = [row.to_dict() for row in decode.many(messages, on_error=on_error)]
            kept = rows if on_error == "skip" else [rows[number] for number, _ in good]
            assert same(kept, [expected for _, expected in good])
        assert same(decode.state, model.state)

    check()


@pytest.mark.parametrize("backend", BACKENDS)
def test_encoding_has_its_own(backend):
    encode, decode = encoder(backend), decoder(backend)
    holder = decode.new()
    holder.seen = 5
    assert decode(message(1.5)).seen == 0
    wanted = [{"position": 0.0, "seq": 5, "good": True}, {"position": 5.0, "seq": 10, "good": False}]
    assert [READ(encode(holder)).to_dict() for _ in wanted] == wanted
    assert (encode.state["seen"], decode.state["seen"]) == (10, 1)
    size, buffer = encode.size(holder), bytearray(100)
    assert encode.state["seen"] == 10, "to measure a message changes nothing"
    assert encode.into(holder, buffer, 3) == 3 + size
    with pytest.raises(BufferError):
        encode.into(holder, bytearray(3))
    assert encode.state == {"last": 5.0, "low": 0.0, "seen": 15, "next": 0, "was_good": False}
    encode.reset()
    batch = decode.many([message()] * 3)
    for row, seen in zip(batch, (1, 2, 2**63 - 2), strict=True):
        row.seen = seen
    with pytest.raises(rj.EncodeError, match=r"\[2\].seq"):
        encode.many(batch)
    assert encode.state["seen"] == 3, "what the last good message left"


GROWING = f"""{HEAD}
state seen: int64 = 0
unpack-rules:
  ignore .position
  ignore .seq
  ignore .good
  .speed = 0.0
  .low = 0.0
  .seen = seen
  .gap = false
  .note = "n"
  state seen = seen + 1
"""
TEXTS = {
    "t.bottle-schema": '"t" (("note" :string))',
    "t.proto": 'syntax = "proto2"; message T { required int64 n = 1; }',
    "t.mapping": """import "t.bottle-schema"
import "t.proto"
state seen: int64 = 8
data-holder: T
wire-schema: t
pack-rules:
  .note = text(seen)
  reject "no" when .n == 13
  state seen = seen + .n
""",
}


@pytest.mark.parametrize("backend", BACKENDS)
def test_sizes_that_depend_on_state(backend):
    encode = rj.Encoder("t.mapping", schema=TEXTS, encoding="yarp4", backend=backend)
    own = {"schema": TEXTS, "imports": ["t.proto"], "encoding": "protobuf", "backend": "python"}
    write = rj.Encoder.of("T", **own)
    batch = rj.Decoder.of("T", **own).many([write(write.holder_type.from_dict({"n": n})) for n in (1, 1, 90, 900, 13, 1)])
    one = rj.Decoder.of("t", schema=TEXTS, imports=["t.bottle-schema"], encoding="yarp4", backend="python")
    buffer, offsets = encode.many(batch[:4])
    assert [one(bytes(buffer[a:b])).note for a, b in pairwise(offsets)] == ["8", "9", "10", "100"]
    assert encode.state == {"seen": 1000}
    with pytest.raises(rj.EncodeError, match=r"\[4\]"):
        encode.many(batch)
    assert encode.state == {"seen": 1992}


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_whatever_a_decoder_is_called_by(backend):
    decode = decoder(backend)
    calls = decode, decode.builtin, lambda data: decode(bytearray(data)), lambda data: decode(memoryview(data))
    calls = *calls, lambda data: decode.into(data, decode.new()), lambda data: decode(data, decode.new())
    numbers = [call(message()).seen for call in calls]

    class Thing:
        speed = low = 0.0
        seen = 0
        gap = False
        note = ""

    numbers += [decode.to(message(), Thing).seen, decode.into(message(), Thing()).seen]
    assert numbers == list(range(8))
    borrowing = decoder(backend, borrow=True)
    assert [borrowing(message()).seen, borrowing(bytearray(message())).seen] == [0, 1]


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_holders_have_no_part_in_it(backend):
    one, other = decoder(backend), decoder(backend)
    holder = one.new()
    assert [one(message(), holder).seen, one(message()).seen, other(message(), holder).seen] == [0, 1, 0]


@pytest.mark.parametrize("backend", ["llvm", "python"])
def test_copies_start_anew(backend):
    decode = decoder(backend)
    decode(message(2.0))
    for made in (copy.copy(decode), copy.deepcopy(decode), pickle.loads(pickle.dumps(decode))):  # noqa: S301 - our own
        assert made.state == Model().state
    assert decode.state["last"] == 2.0


def test_reset_begins_counting_again():
    counting = f"{HEAD}unpack-rules:\n  ignore .position\n  ignore .seq\n  ignore .good\n"
    counting += '  .speed = 0.0\n  .low = 0.0\n  .seen = counter()\n  .gap = false\n  .note = ""\n'
    decode = rj.Decoder("m.mapping", schema=files(counting), encoding="yarp4")
    assert [decode(message()).seen for _ in range(3)] == [0, 1, 2]
    assert decode.state == {}
    decode.reset()
    assert decode(message()).seen == 0


def test_initial_values_from_parameters():
    text = MAPPING.replace("state low: float64 = 0.0", "state low: float64 = share")
    decode = rj.Decoder("m.mapping", schema=files(text), encoding="yarp4", parameters={"share": 0.5})
    assert decode.state["low"] == 0.5
    assert decode(message(8.0)).low == 4.25


TYPES = {
    "bool": (True, False, "was"),
    "int8": (-128, 127, "int8(was)"),
    "uint8": (255, 0, "uint8(was)"),
    "int16": (-(2**15), 2**15 - 1, "was"),
    "uint32": (2**32 - 1, 7, "was"),
    "int64": (-(2**63), 2**63 - 1, "was"),
    "uint64": (2**64 - 1, 2**63, "was"),
    "float32": (0.10000000149011612, -0.0, "was"),
    "float64": (0.1, 1e300, "was"),
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("type_", TYPES)
def test_every_type_keeps_its_values(backend, type_):
    first, second, _ = TYPES[type_]
    written = [str(each).lower() for each in (first, second)]
    field = {"bool": "bool", "float32": "float", "float64": "double", "uint64": "uint64", "uint32": "uint32"}.get(type_, "int64")
    schemas = {
        "v.bottle-schema": '"v" (("n" :int))',
        "v.proto": f'syntax = "proto2"; message V {{ required {field} was = 1; }}',
        "v.mapping": f"""import "v.bottle-schema"
import "v.proto"
state was: {type_} = {written[0]}
parameter then: {type_} = {written[1]}
data-holder: V
wire-schema: v
unpack-rules:
  reject "odd" when .n == 1
  .was = was
  state was = then
""",
    }
    decode = rj.Decoder("v.mapping", schema=schemas, encoding="yarp4", backend=backend)
    write = rj.Encoder.of("v", schema=schemas, imports=["v.bottle-schema"], encoding="yarp4", backend="python")
    data = write(write.holder_type.from_dict({"n": 0}))
    found = [decode(data).was, decode(data).was, decode.state["was"]]
    assert list(map(repr, found)) == list(map(repr, (first, second, second)))


def test_one_call_at_a_time():
    """A call beside another one is right or refused, and never a mixture."""
    decode = decoder("llvm")
    one = [message(1.0, seq) for seq in range(2000)]
    results, refused, done = [], 0, threading.Event()

    def run():
        while not done.is_set():
            with suppress(rj.InUse):
                results.append(decode(one[0]).seen)

    thread = threading.Thread(target=run)
    thread.start()
    total = 0
    for _ in range(50):
        try:
            batch = decode.many(one)
        except rj.InUse:
            refused += 1
            continue
        total += len(batch)
        first = batch.seen[0]
        assert batch.seen.tolist() == list(range(first, first + len(one))), "no other message came between"
    done.set()
    thread.join()
    assert decode.state["seen"] == total + len(results)
    assert results == sorted(set(results))


def test_a_function_that_calls_its_own_decoder_is_refused():
    text = MAPPING.replace("data-holder: M", "function again(float64): float64\ndata-holder: M")
    text = text.replace(".low = low +", ".low = again(low) +")

    def again(x: float) -> float:
        with pytest.raises(rj.InUse):
            decode(message(), decode.new())
        return x

    options = {"encoding": "yarp4", "functions": {"again": again}, "backend": "python"}
    decode = rj.Decoder("m.mapping", schema=files(text), **options)
    assert [decode(message()).seen, decode(message()).seen] == [0, 1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_functions_of_ones_own_get_it_as_any_value(backend):
    """Other threads may run while such a function does, so that all calls take the slow path, which keeps them out."""
    text = MAPPING.replace("data-holder: M", "function half(float64): float64\ndata-holder: M")
    text = text.replace(".low = low +", ".low = half(low) +")
    options = {"encoding": "yarp4", "functions": {"half": lambda x: x / 2}, "backend": backend}
    decode = rj.Decoder("m.mapping", schema=files(text), **options)
    assert [(each.seen, each.low) for each in (decode(message(4.0)) for _ in range(2))] == [(0, 1.0), (1, 1.25)]
    assert decode.many([message(4.0)] * 2).seen.tolist() == [2, 3]


def test_compiled_code_of_ones_own_is_refused():
    with pytest.raises(ValueError, match="keeps state"):
        _ = decoder("llvm").kernel
    with pytest.raises(ValueError, match="keeps state"):
        _ = encoder("llvm").kernel


def test_not_a_number_is_kept():
    decode = decoder("llvm")
    decode(message(math.nan))
    assert math.isnan(decode.state["last"])
    assert math.isnan(decode(message(1.0)).speed)
    assert np.isnan(decode.many([message(2.0)]).low[0])
