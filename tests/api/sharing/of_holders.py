"""Threads share programs, holders, and what shows parts of these."""

from __future__ import annotations

import copy
import gc
import pickle
import threading
import time
from contextlib import suppress

import numpy as np

import rosetta_jit as rj
from tests.api.sharing.turns import CHOICES, DIGITS, Turns, check, choice, kind, messages, of, plain


@kind
def decoder(turns):
    """Each thread sees what it has decoded."""
    sent = messages(40)
    for _ in range(round(turns.seconds / 0.2) or 1):
        decode = of(rj.Decoder)
        some = Turns(0.2)

        def call(rng, decode=decode):
            number = rng.randrange(40)
            check(decode(sent[number]).to_dict(), number)

        some.run(call, call, call, call)
        for name, (right, refused) in some.counts.items():
            before = turns.counts.get(name, (0, 0))
            turns.counts[name] = right + before[0], refused + before[1]


@kind
def holder(turns):
    """What is in a holder is one message."""
    sent, decode = messages(40), of(rj.Decoder)
    shared = [decode.new()]

    def fill(rng):
        decode(sent[rng.randrange(40)], shared[0])

    def begin_anew(rng):
        shared[0] = decode.new()
        time.sleep(0.001)

    def read(rng):
        found = shared[0].to_dict()
        if found["d"]:
            check(found)

    turns.run(fill, fill, read, begin_anew)


@kind
def encoded_holder(turns):
    """What is encoded is one message, while the holder is decoded into, and made longer."""
    sent, decode, encode = messages(40), of(rj.Decoder), of(rj.Encoder)
    shared = decode.new()
    decode(sent[0], shared)
    known = set(sent)

    def write(rng):
        data = encode(shared)
        if data not in known:
            check(decode(data).to_dict())

    def write_into(rng):
        assert 0 < encode(shared, bytearray(1 << 20), 0) < 1 << 20

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    turns.run(write, write, write_into, fill)


@kind
def fields(turns):
    """A holder whose fields are set, while another thread encodes it."""
    decode, encode = of(rj.Decoder), of(rj.Encoder)
    shared = decode.new()

    def array(rng):
        shared.d = np.full(rng.randrange(5000), 3.0)

    def text(rng):
        shared.s = "x" * rng.randrange(5000)

    def append(rng):
        if len(shared.names) > 50:
            shared.names = []
        shared.names.append("name" * rng.randrange(50))

    def encode_it(rng):
        found = decode(encode(shared)).to_dict()
        assert set(found["d"]) <= {3.0}, found["d"][:3]
        assert set(found["s"]) <= {"x"}, found["s"][:3]
        assert all(set(each) <= set("name") for each in found["names"])

    turns.run(array, text, append, encode_it)


@kind
def views(turns):
    """Texts, arrays of texts and nested messages are read while their holder is decoded into."""
    sent, decode = messages(40), of(rj.Decoder)
    shared = decode.new()
    decode(sent[7], shared)
    words = {plain(number)["s"] for number in range(40)}
    raws = {plain(number)["raw"] for number in range(40)}

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def text(rng):
        assert shared.s in words

    def texts(rng):
        for each in shared.names:
            assert each in words

    def parts(rng):
        for each in shared.items:
            try:
                assert each.t == "" or each.t.isdigit()
            except rj.InvalidHolder:
                return  # the next message has fewer

    def octets(rng):
        assert len(shared.raw) in {len(each) for each in raws}

    turns.run(fill, text, texts, parts, octets)


@kind
def compared(turns):
    """Comparing, copying and pickling read one message, while the holder is decoded into."""
    sent, decode = messages(40), of(rj.Decoder)
    shared, mine = decode.new(), decode.new()
    decode(sent[7], mine)
    decode(sent[7], shared)

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def compare(rng):
        assert (shared == mine) in (True, False)

    def copied(rng):
        check(copy.deepcopy(shared).to_dict())

    def pickled(rng):
        check(pickle.loads(pickle.dumps(shared)).to_dict())  # noqa: S301 - our own

    turns.run(fill, compare, copied, pickled)


@kind
def apart(turns):
    """What each thread has for itself is never refused."""
    decode = of(rj.Decoder)
    encode = of(rj.Encoder)
    sent = messages(40)
    data, offsets = b"".join(sent), np.cumsum([0, *(len(each) for each in sent)])

    kept = threading.local()

    def work(rng):
        if not hasattr(kept, "holder"):
            kept.holder, kept.batch = decode.new(), decode.many(data, offsets)
        number = rng.randrange(40)
        try:
            assert encode(decode(sent[number])) == sent[number]
            assert encode(decode(sent[number], kept.holder)) == sent[number]
            decode.many(data, offsets, into=kept.batch)
            assert bytes(encode.many(kept.batch)[0]) == data
        except rj.InUse as error:
            raise AssertionError("what was not shared was refused") from error

    turns.run(work, work, work)


@kind
def made_again(turns):
    """`__init__` again, `clear` and new lanes while others decode, encode and read."""
    sent, decode, encode = messages(40), of(rj.Decoder), of(rj.Encoder)
    shared = decode(sent[3])

    def init(rng):
        shared.__init__()

    def clear(rng):
        shared.clear()

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def write(rng):
        found = decode(encode(shared)).to_dict()
        if found["d"]:
            check(found)

    def dropped(rng):
        own = of(rj.Decoder)
        view = own(sent[rng.randrange(40)]).d
        del own
        gc.collect(0)
        assert len(set(view.tolist())) == 1

    turns.run(init, clear, fill, write, dropped)


@kind
def maps(turns):
    """Maps and the fields of a oneof are read while their message is decoded into, and its entries are put and deleted."""
    options = {"schema": CHOICES, "imports": ["choices.proto"], "encoding": "protobuf"}
    decode, encode = rj.Decoder.of("p.C", **options), rj.Encoder.of("p.C", **options)
    dicts = [choice(number) for number in range(40)]
    sent = [bytes(encode(encode.holder_type.from_dict(each))) for each in dicts]
    known = [decode(each).to_dict() for each in sent]
    shared, changed = decode(sent[1], decode.new()), decode.new()

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def whole(rng):
        assert shared.to_dict() in known
        assert decode(encode(shared)).to_dict() in known

    def entries(rng):
        with suppress(rj.InvalidHolder, KeyError, IndexError, RuntimeError):
            assert all(set(text) <= set(DIGITS) for _, text in shared.k.items())
            assert set(shared.a + shared.b.t) <= set(DIGITS)

    def put(rng):
        changed.k[rng.randrange(200)] = "1" * rng.randrange(300)
        changed.a = "1" * rng.randrange(3000)
        with suppress(KeyError):
            del changed.k[rng.randrange(200)]

    def write(rng):
        found = decode(encode(changed)).to_dict()
        assert all(set(text) <= {"1"} for text in found["k"].values())

    turns.run(fill, whole, entries, put, write)
