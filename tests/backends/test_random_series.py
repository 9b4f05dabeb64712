"""Series of fields that are alike, in random types: compiled code does what the interpreter does, which knows of no series.

Series are looked for in much smaller messages than usual, so that each type compiles in a moment. What they are printed as must not
depend on how many stretches they have.
"""

from __future__ import annotations

from functools import partial
from random import Random

import pytest

import rosetta_jit as rj
from rosetta_jit.backends.llvm import alike, function, stretches, twins

SEEDS, BLOCK, BLOCKS = 4, 50, 20
WORDS = ("", "a", "some text", "é ü", "x" * 40)


def numbers(random, count=4):
    return [random.randrange(100) for _ in range(random.randrange(count))]


PLAIN = {
    "string": lambda random: random.choice(WORDS),
    "int32": lambda random: random.randrange(-(2**31), 2**31),
    "uint16": lambda random: random.randrange(2**16),
    "float64": lambda random: random.randrange(10**6) / 8,
    "float64[]": numbers,
    "uint8[]": numbers,
    "int16[3]": lambda random: [random.randrange(-9, 9) for _ in range(3)],
    "string[]": lambda random: random.choices(WORDS, k=random.randrange(3)),
    "Inner": lambda random: {"name": random.choice(WORDS), "value": random.randrange(9)},
    "Inner[]": lambda random: [PLAIN["Inner"](random) for _ in range(random.randrange(3))],
}
TAGGED = {
    "string": PLAIN["string"],
    "int64": lambda random: random.choice((0, 1, 200, 70_000, -5, 2**40)),
    "double": PLAIN["float64"],
    "repeated int32": numbers,
    "repeated double": numbers,
    "bytes": lambda random: random.choice(WORDS).encode(),
    "repeated string": PLAIN["string[]"],
    "Inner": PLAIN["Inner"],
    "repeated Inner": PLAIN["Inner[]"],
}
OPTIONAL = {
    "long": PLAIN["int32"],
    "octet": lambda random: random.randrange(2**8),
    "double": PLAIN["float64"],
    "boolean": lambda random: random.random() < 0.5,
    "string": PLAIN["string"],
    "sequence<double>": numbers,
    "Inner": PLAIN["Inner"],
}


def random_fields(random, kinds):
    """Names and kinds of fields: a few patterns, each of them repeated, with some other field between them now and then."""
    found = []
    for _ in range(random.randint(1, 2)):
        pattern = random.choices(list(kinds), k=random.randint(1, 3))
        for _ in range(random.randint(stretches.ROUNDS, stretches.ROUNDS + 4)):
            found += pattern
        found += random.choices(list(kinds), k=random.randrange(2))
    return [(f"field{number}", kind) for number, kind in enumerate(found)]


def message_text(name, fields):
    """The declaration of a message of protobuf."""
    lines = "".join(f"  {kind} {field} = {number};\n" for number, (field, kind) in enumerate(fields, 1))
    return f"message {name} {{\n{lines}}}\n"


def values_of(random, fields, kinds):
    """Values of the fields; some of those that are optional are left out."""
    return {name: kinds[kind](random) for name, kind in fields if kinds is not OPTIONAL or random.random() < 0.6}


def random_type(random):
    """A type, how it is asked for, its fields, and what makes their values."""
    encoding = random.choice(("ros1", "cdr", "cdr2", "protobuf"))
    if encoding == "protobuf":
        parts = {f"Part{number}": random_fields(random, TAGGED) for number in range(random.randrange(4))}
        kinds = TAGGED | {name: partial(values_of, fields=fields, kinds=TAGGED) for name, fields in parts.items()}
        fields = [*random_fields(random, TAGGED), *((f"part{number}", random.choice([*parts])) for number in range(len(parts) * 2))]
        messages = "".join(map(message_text, ("All", *parts), (fields, *parts.values())))
        source = f'syntax = "proto3"; package a;\nmessage Inner {{ string name = 1; int32 value = 2; }}\n{messages}'
        return "a.All", {"encoding": encoding, "schema": {"a.proto": source}}, fields, kinds
    if encoding == "cdr2":
        fields = random_fields(random, OPTIONAL)
        members = "".join(f"  @optional {kind} {name};\n" for name, kind in fields)
        source = f"module a {{\nstruct Inner {{ string name; long value; }};\nstruct All {{\n{members}}};\n}};\n"
        return "a::All", {"encoding": encoding, "schema": {"a.idl": source}}, fields, OPTIONAL
    fields = random_fields(random, PLAIN)
    files = {"a/msg/Inner.msg": "string name\nint32 value\n", "a/msg/All.msg": "".join(f"{kind} {name}\n" for name, kind in fields)}
    name, framework = ("a/All", "ros1") if encoding == "ros1" else ("a/msg/All", "ros2")
    return name, {"encoding": encoding, "schema": files, "framework": framework}, fields, PLAIN


def told(decode, message):
    try:
        return repr(decode(message).to_dict())
    except rj.DecodeError as error:
        return str(error)


def altered(random, message):
    """The message, and what is left of it where it is cut or damaged."""
    yield message
    for _ in range(8):
        yield message[: random.randrange(len(message) + 1)]
        changed = bytearray(message)
        for _ in range(random.randint(1, 2)):
            if changed:
                changed[random.randrange(len(changed))] = random.choice((0, 1, 127, 128, 255))
        yield bytes(changed)


def compare(seed):
    """Compare compiled code with the interpreter on messages of a random type."""
    random = Random(seed)  # no secret depends on it
    type_, options, fields, kinds = random_type(random)
    (decode, encode), (reference, written) = (
        (rj.Decoder.of(type_, **options, backend=backend), rj.Encoder.of(type_, **options, backend=backend))
        for backend in ("llvm", "interpreter")
    )
    for _ in range(3):
        values = values_of(random, fields, kinds)
        message = bytes(encode(encode.holder_type.from_dict(values)))
        assert message == bytes(written(written.holder_type.from_dict(values))), seed
        for each in altered(random, message):
            assert told(decode, each) == told(reference, each), (seed, each)


@pytest.fixture
def bodies(monkeypatch):
    """Of each body that is printed, whether it has series; what is compiled so is not kept."""
    seen, real = [], stretches.found

    def found(kernel, body):
        series = real(kernel, body)
        seen.append(bool(series))
        return series

    monkeypatch.setenv("ROSETTA_JIT_CACHE", "off")
    monkeypatch.setattr(alike, "MANY", 16)
    monkeypatch.setattr(stretches, "ROUNDS", 4)
    monkeypatch.setattr(alike, "SEVERAL", 16)
    monkeypatch.setattr(twins, "LEAST", 4)
    monkeypatch.setattr(function.stretches, "found", found)
    return seen


@pytest.mark.parametrize("large", [False, True])
def test_types(large, bodies, monkeypatch):
    """In large kernels more is worth a loop."""
    monkeypatch.setattr(stretches, "is_large", lambda _: large)
    for seed in range(SEEDS):
        compare(seed + large * SEEDS)
    assert sum(bodies) >= SEEDS


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(BLOCKS))
def test_campaign(bodies, block, monkeypatch):
    monkeypatch.setattr(stretches, "is_large", lambda _: block % 2 > 0)
    for seed in range(2 * SEEDS + block * BLOCK, 2 * SEEDS + (block + 1) * BLOCK):
        compare(seed)
    assert sum(bodies) > BLOCK
