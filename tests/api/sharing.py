"""Run as a program: threads share what they should not, for some seconds; what they get must be right, or `InUse`.

`python -m tests.api.sharing KIND SECONDS` prints how often each thread got a right value and how often an error. A wrong value ends it with
exit code 1, and memory that two of them use at once ends it in whatever way the system has.
"""

from __future__ import annotations

import copy
import faulthandler
import gc
import os
import pickle
import random
import signal
import struct
import sys
import threading
import time
from contextlib import suppress

import numpy as np

import rosetta_jit as rj

SCHEMA = {
    "p/A.msg": "int32 n\nfloat64[] d\nstring s\nstring[] names\nB[] items\nuint8[] raw\n",
    "p/B.msg": "int32 k\nstring t\n",
}
PICTURE = {
    "p/P.msg": "uint32 width\nuint32 height\nuint8[] pixels\n",
    "p/Q.msg": "uint8[] packed\n",
    "picture.mapping": """import "p/P.msg"
import "p/Q.msg"
data-holder: p/P
wire-schema: p/Q
pack-rules:
  .packed = compress(.pixels, "png", .width, .height, 1)
""",
}
DIGITS = "0123456789"
CHOICES = {
    "choices.proto": """syntax = "proto3";
package p;
message N { string t = 1; repeated double d = 2; }
message C { oneof u { string a = 1; N b = 2; int32 c = 3; } map<string, N> m = 4; map<int32, string> k = 5; N n = 6; }
"""
}
KINDS = {}


def kind(function):
    KINDS[function.__name__] = function
    return function


def of(program):
    return program.of("p/A", schema=SCHEMA, encoding="ros1", imports=["p/A.msg"])


def plain(number):
    """All parts of a message say which one it is; few are of one size."""
    size = 1 + number * 37 % 1000
    word = f"{number} " * size
    return {
        "n": number,
        "d": [float(number)] * size,
        "s": word,
        "names": [word] * (1 + number % 4),
        "items": [{"k": number, "t": str(number)}] * (number % 5),
        "raw": word.encode() * (1 + number % 3 * 20),
    }


def choice(number):
    """The same of a message with a oneof and maps."""
    word = str(number % 10) * (1 + number * 37 % 500)
    nested = {"t": word, "d": [float(number)] * (number % 50)}
    chosen = ({"a": word}, {"b": nested}, {"c": number})[number % 3]
    return {**chosen, "m": {f"{word}{i}": nested for i in range(number % 6)}, "k": dict.fromkeys(range(number % 9), word), "n": nested}


def buffer_of(sent):
    return b"".join(sent), np.cumsum([0, *map(len, sent)])


def messages(count):
    encode = of(rj.Encoder)
    return [bytes(encode(encode.holder_type.from_dict(plain(number)))) for number in range(count)]


def check(found, number=None):
    if found != plain(found["n"] if number is None else number):
        raise AssertionError(f"a mixture: {found['n']} of {number}, {found['d'][:1]} {found['s'][:10]} {str(found['names'])[:10]}")


class Turns:
    """Threads that call functions, again and again, until the time is over or one of them has seen what must not be."""

    def __init__(self, seconds):
        self.seconds = seconds
        self.end = float("inf")
        self.failed = None
        self.counts = {}

    def run(self, *functions):
        self.end = time.monotonic() + self.seconds
        threads = [threading.Thread(target=self._again, args=(number, each)) for number, each in enumerate(functions)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        if self.failed is not None:
            raise self.failed

    def _again(self, number, function):
        right = refused = 0
        rng = random.Random(number)
        while time.monotonic() < self.end and self.failed is None:
            try:
                function(rng)
                right += 1
            except rj.InUse:
                refused += 1
                time.sleep(1e-4)  # as who is refused does something else first
            except BaseException as error:
                self.failed = error
                raise
        self.counts[f"{number} {function.__name__}"] = (right, refused)


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
def batch(turns):
    """A batch is filled again, and its rows made longer, while another thread encodes it."""
    decode, encode = of(rj.Decoder), of(rj.Encoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]) * 20, np.cumsum([0, *([len(each) for each in sent[:count]] * 20)])) for count in (5, 40, 20)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=shared)

    def lengthen(rng):
        shared[rng.randrange(100)].s = "x" * rng.randrange(100_000)

    def encode_it(rng):
        data, offsets = encode.many(shared)
        assert len(offsets) - 1 in (100, 400, 800)
        assert offsets[-1] == len(data)

    turns.run(refill, lengthen, encode_it, encode_it)


@kind
def columns(turns):
    """Columns and rows of a batch are read while it is filled again."""
    decode = of(rj.Decoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]), np.cumsum([0, *(len(each) for each in sent[:count])])) for count in (5, 40)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=shared)

    def row(rng):
        number = rng.randrange(5)
        check(shared[number].to_dict(), number)

    def column(rng):
        names = shared.column("names")
        assert len(names) in (5, 40)
        assert len(shared.n) in (5, 40)
        assert shared.mask("s").all()

    turns.run(refill, row, column)


@kind
def tables(turns):
    """Tables and parts of a batch are made while it is filled again."""
    decode = of(rj.Decoder)
    sent = messages(40)
    buffers = [(b"".join(sent[:count]), np.cumsum([0, *(len(each) for each in sent[:count])])) for count in (5, 40)]
    shared = decode.many(*buffers[0])

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=shared)

    def table(rng):
        for number, row in enumerate(shared.to_arrow().to_pylist()):
            check(row, number)

    def part(rng):
        for number, message in enumerate(shared[2:5], 2):
            check(message.to_dict(), number)

    def pickled(rng):
        assert len(pickle.loads(pickle.dumps(shared))) in (5, 40)  # noqa: S301 - our own

    turns.run(refill, table, part, pickled)


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
def pictures(turns):
    """A kernel that calls Python, which lets other threads run, while its holder is changed."""
    encode = rj.Encoder("picture.mapping", schema=PICTURE, encoding="ros1")
    fill = rj.Decoder.of("p/P", schema=PICTURE, encoding="ros1", imports=["p/P.msg"])
    shared = encode.new()
    sizes = [(20, 30), (200, 300), (64, 10)]
    sent = [struct.pack("<III", width, height, width * height) + bytes(width * height) for width, height in sizes]
    fill(sent[0], shared)
    known = {encode(fill(each)) for each in sent}

    def write(rng):
        assert encode(shared) in known

    def change(rng):
        fill(sent[rng.randrange(3)], shared)

    turns.run(write, write, change)


@kind
def kept_tables(turns):
    """Tables that were made before stay whole, while their batch is filled with longer texts."""
    decode = of(rj.Decoder)
    buffers = [buffer_of(messages(count)) for count in (5, 40, 20)]
    shared = decode.many(*buffers[0])
    kept = [shared.to_arrow()]

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=shared)

    def make(rng):
        kept[0] = shared.to_arrow()
        time.sleep(0.001)

    def read(rng):
        table = kept[0]
        table.validate(full=True)
        assert table.to_pylist() == table.to_pylist()

    turns.run(refill, make, read, read)


@kind
def iterators(turns):
    """Batches, parts of them and lists are gone through while another thread decodes into them; what is gone raises what lists raise."""
    sent, decode = messages(40), of(rj.Decoder)
    buffers = [buffer_of(sent[:count]) for count in (5, 40, 20)]
    rows, one = decode.many(*buffers[0]), decode(sent[7], decode.new())
    words = {plain(number)["s"] for number in range(40)}

    def refill(rng):
        decode.many(*buffers[rng.randrange(3)], into=rows)
        decode(sent[rng.randrange(40)], one)

    def batch_rows(rng):
        with suppress(rj.InvalidHolder, IndexError):
            assert all(row.s in words for row in rows)
            for row in rows[1:4][::-1]:
                assert row.s in words

    def lists(rng):
        with suppress(rj.InvalidHolder, IndexError):
            assert all(name in words for name in reversed(one.names))
            assert all(item.t.isdigit() or not item.t for item in one.items)
            assert one.d.tolist() == [] or len(one.d)

    turns.run(refill, batch_rows, lists, lists)


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


@kind
def forks(turns):
    """A child of a fork beside threads that decode goes on, and what they had begun is in use there."""
    sent, decode, encode = messages(40), of(rj.Decoder), of(rj.Encoder)
    buffers = [buffer_of(sent[:count]) for count in (5, 40)]
    shared, rows = decode.new(), decode.many(*buffers[0])

    def fill(rng):
        decode(sent[rng.randrange(40)], shared)

    def refill(rng):
        decode.many(*buffers[rng.randrange(2)], into=rows)

    def child(rng):
        number = os.fork()
        if number:
            assert os.waitpid(number, 0)[1] == 0
            return
        code = 1
        try:
            signal.alarm(30)
            check(decode(sent[3]).to_dict(), 3)
            assert encode(decode(sent[4], decode.new())) == sent[4]
            assert len(decode.many(*buffers[1])) == 40
            with suppress(rj.InUse):
                decode.many(*buffers[0], into=rows)
            with suppress(rj.InUse):
                shared.to_dict()
            code = 0
        finally:
            os._exit(code)

    turns.run(fill, refill, child)


def main(name, seconds):
    faulthandler.enable()
    sys.setswitchinterval(1e-6)
    turns = Turns(seconds)
    KINDS[name](turns)
    print(turns.counts)
    assert any(right for right, _ in turns.counts.values()), "where all are refused each time, nothing is shown"


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
