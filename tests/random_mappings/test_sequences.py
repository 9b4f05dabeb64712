"""Random relations of arrays that are made of others, of signals and of checksums: each backend against plain Python, both ways."""

from __future__ import annotations

import random
import zlib
from functools import partial

import pytest

import rosetta_jit as rj
from rosetta_jit.language.signal_bits import signal_of
from tests.language.test_signals import reference
from tests.random_mappings.meaning import INTEGERS, Refused, fits

MESSAGES = 20
FRAME = 8
WHOLE = [each for each in INTEGERS if each != "uint64"]


def deltas(values):
    return [fits(each - last) for last, each in zip([0, *values], values, strict=False)]


def running_sums(values):
    total, found = 0, []
    for each in values:
        total = fits(total + each)
        found.append(total)
    return found


def runs(values):
    """The values of runs and how long each is."""
    found = []
    for each in values:
        if found and found[-1][0] == each:
            found[-1][1] += 1
        else:
            found.append([each, 1])
    return [each for each, _ in found], [count for _, count in found]


def bits(octets, *, is_big):
    return [bool(octet >> place & 1) for octet in octets for place in (range(7, -1, -1) if is_big else range(8))]


def bit_bytes(flags, *, is_big):
    if len(flags) % 8:
        raise Refused("range")
    places = range(7, -1, -1) if is_big else range(8)
    return [sum(flag << place for flag, place in zip(flags[at : at + 8], places, strict=True)) for at in range(0, len(flags), 8)]


def as_type(values, type_):
    return [fits(each, type_) for each in values]


def some_integers(rng, type_):
    low, high = INTEGERS[type_]
    near = rng.choice([(0, 3), (-2, 2), (-1000, 1000), (low, high)])
    return [min(high, max(low, rng.randint(*near))) for _ in range(rng.choice([0, 1, 2, 7, 30]))]


class Relations:
    """Relations with their fields: ``unpack(message)`` is what each makes, ``pack(holder)`` what the message is again."""

    def __init__(self, rng):
        self.rng = rng
        self.wire, self.holder, self.rules = {}, {}, []
        self.some_wire, self.some_holder, self.unpack, self.pack = {}, {}, [], []
        for name in (self.sums, self.runs, self.flags, self.frame):
            name()
        self.rules.append(".check <-> .check\n")

    def sums(self):
        rng, there, here = self.rng, self.rng.choice(WHOLE), self.rng.choice(WHOLE)
        forward, back = rng.choice([("deltas", "running_sums"), ("running_sums", "deltas")])
        functions = {"deltas": deltas, "running_sums": running_sums}
        self.field("a", f"{there}[]", f"{here}[]", lambda: some_integers(rng, there), lambda: some_integers(rng, here))
        self.rule(
            f".a <-> {forward}(.a)",
            "a",
            "a",
            lambda m: as_type(functions[forward](m["a"]), here),
            lambda h: as_type(functions[back](h["a"]), there),
        )

    def runs(self):
        rng, there, here, counts = self.rng, self.rng.choice(WHOLE), self.rng.choice(WHOLE), self.rng.choice(["uint8", "uint16", "int64"])
        self.field("v", f"{there}[]", f"{here}[]", lambda: some_integers(rng, there), lambda: sorted(some_integers(rng, here)))
        self.wire["n"] = f"{counts}[]"
        self.some_wire["n"] = lambda: [rng.choice([0, 1, 2, 5]) for _ in range(rng.choice([0, 1, 2, 7, 30]))]

        def repeated(message):
            if len(message["v"]) != len(message["n"]):
                raise Refused("rejected")
            return as_type([each for each, count in zip(message["v"], message["n"], strict=True) for _ in range(count)], here)

        self.rule(".v <-> repeated(.v, .n)", "v", "v", repeated, lambda h: as_type(runs(h["v"])[0], there))
        self.pack.append(("n", lambda h: as_type(runs(h["v"])[1], counts)))

    def flags(self):
        rng, is_big = self.rng, self.rng.random() < 0.5
        order = ", true" if is_big else rng.choice(["", ", false"])
        octets = lambda: [rng.randrange(256) for _ in range(rng.choice([0, 1, 5]))]  # noqa: E731
        flags = lambda: [rng.random() < 0.5 for _ in range(rng.choice([0, 8, 8, 24, 3]))]  # noqa: E731
        if rng.random() < 0.5:
            self.field("f", "uint8[]", "bool[]", octets, flags)
            self.rule(
                f".f <-> bits(.f{order})", "f", "f", lambda m: bits(m["f"], is_big=is_big), lambda h: bit_bytes(h["f"], is_big=is_big)
            )
        else:
            self.field("f", "bool[]", "uint8[]", flags, octets)
            self.rule(
                f".f <-> bit_bytes(.f{order})", "f", "f", lambda m: bit_bytes(m["f"], is_big=is_big), lambda h: bits(h["f"], is_big=is_big)
            )

    def frame(self):
        """Signals that share no bit, each an integer of its own."""
        rng, taken, found = self.rng, set(), []
        for _ in range(30):
            text = f"{rng.randrange(8 * FRAME)}|{rng.choice([1, 3, 8, 12, 16, 33, 40])}@{rng.choice('01')}{rng.choice('+-')}"
            signal = signal_of(text)
            if signal is not None and signal.size <= FRAME and not signal.bits & taken and len(found) < 5:
                taken |= signal.bits
                found.append(signal)
        self.wire["d"] = f"uint8[{FRAME}]"
        self.some_wire["d"] = lambda: [rng.randrange(256) for _ in range(FRAME)]
        for number, signal in enumerate(found):
            name, type_ = f"s{number}", rng.choice(WHOLE)
            low, high = (-(1 << signal.length - 1), (1 << signal.length - 1) - 1) if signal.signed else (0, (1 << signal.length) - 1)
            self.holder[name] = type_
            self.some_holder[name] = lambda low=low, high=high, type_=type_: inside(
                rng.choice([low, high, rng.randint(low, high), rng.randint(-3, 300)]), type_
            )
            self.rules.append(f'.{name} <-> {type_}(signal(.d, "{signal.text}"))\n')
            self.unpack.append((name, lambda m, text=signal.text, type_=type_: fits(reference(text, bytes(m["d"])), type_)))

        def packed(holder):
            frame = 0
            for number, signal in enumerate(found):
                value = holder[f"s{number}"]
                if not (-(1 << signal.length - 1) <= value < 1 << signal.length - 1 if signal.signed else 0 <= value < 1 << signal.length):
                    raise Refused("range")
                for piece in signal.pieces:
                    frame |= (value >> piece.shift & piece.mask) << 8 * piece.byte + piece.bit
            return list(frame.to_bytes(FRAME, "little"))

        self.pack.append(("d", packed))

    def field(self, name, there, here, some_there, some_here):
        self.wire[name], self.holder[name] = there, here
        self.some_wire[name], self.some_holder[name] = some_there, some_here

    def rule(self, text, here, there, unpack, pack):
        self.rules.append(f"{text}\n")
        self.unpack.append((here, unpack))
        self.pack.append((there, pack))


def inside(value, type_):
    low, high = INTEGERS[type_]
    return min(high, max(low, value))


def files_of(relations):
    return {
        "t/Wire.msg": "".join(f"{type_} {name}\n" for name, type_ in relations.wire.items()) + "uint32 check\n",
        "t/Held.msg": "".join(f"{type_} {name}\n" for name, type_ in relations.holder.items()) + "uint32 check\n",
        "m.mapping": 'import "t/Wire.msg"\nimport "t/Held.msg"\ndata-holder: t/Held\nwire-schema: t/Wire\nrules:\n'
        + "".join(relations.rules)
        + 'unpack-rules:\n  reject "damaged" when .check != crc(.d, "CRC-32")\n',
    }


def expected(parts, values):
    """The fields, or the kinds of all rules that refuse the message."""
    found, refused = {}, set()
    for name, make in parts:
        try:
            found[name] = make(values)
        except Refused as why:
            refused.add(why.kind)
    return refused or found


def outcome(run, values, wanted):
    """The fields, or ``wanted`` where that has the kind of the refusal."""
    try:
        found = run(values).to_dict()
    except rj.MessageError as error:
        return wanted if isinstance(wanted, set) and error.kind in wanted else error.kind
    return {name: list(each) if isinstance(each, list | bytes) else each for name, each in found.items() if name != "check"}


def some_message(rng, relations):
    message = {name: some() for name, some in relations.some_wire.items()}
    return {**message, "check": zlib.crc32(bytes(message["d"]))}


def check_sequences(seed, backends):
    rng = random.Random(f"sequences {seed}")
    relations = Relations(rng)
    files = files_of(relations)
    of = {"schema": files, "imports": ["t/Wire.msg"], "encoding": "ros1", "backend": "interpreter"}
    write, read = rj.Encoder.of("t/Wire", **of), rj.Decoder.of("t/Wire", **of)
    messages = [some_message(rng, relations) for _ in range(MESSAGES)]
    holders = [{**{name: some() for name, some in relations.some_holder.items()}, "check": 0} for _ in range(MESSAGES)]
    sent = [write(write.holder_type.from_dict(each)) for each in messages]
    for backend in backends:
        decode, encode = (each("m.mapping", schema=files, encoding="ros1", backend=backend) for each in (rj.Decoder, rj.Encoder))
        for message, data in zip(messages, sent, strict=True):
            wanted = expected(relations.unpack, message)
            assert outcome(decode, data, wanted) == wanted, (seed, backend, files["m.mapping"], message)
            damaged = data[:-1] + bytes([data[-1] ^ 1])
            refused = wanted | {"rejected"} if isinstance(wanted, set) else {"rejected"}
            assert outcome(decode, damaged, refused) == refused, (seed, backend, files["m.mapping"], message)
        for holder in holders:
            wanted = expected(relations.pack, holder)
            packed = partial(sent_and_read, encode, read)
            assert outcome(packed, holder, wanted) == wanted, (seed, backend, files["m.mapping"], holder)


def sent_and_read(encode, read, values):
    return read(encode(encode.holder_type.from_dict(values)))


def test_sequences():
    check_sequences(0, ["python", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check_sequences(seed, ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
