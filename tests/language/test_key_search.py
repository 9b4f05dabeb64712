"""Elements that a key tells: found wherever they stand, set in the order of the text, against Python's own search."""

from __future__ import annotations

import random
import re

import pytest

import rosetta_jit as rj

BACKENDS = ["llvm", "python", "interpreter"]
SCHEMAS = {
    "lab/msg/Pair.msg": "string key\nstring value\n",
    "lab/msg/Device.msg": "int32 id\nfloat64 level\nPair[] values\n",
    "lab/msg/Status.msg": "string wanted\nPair[] values\nDevice[] devices\n",
    "h.proto": """syntax = "proto3"; package lab;
message Entry { string name = 1; int64 number = 2; }
message Held { string text = 1; double level = 2; int64 at = 3; repeated string rest = 4; repeated double levels = 5;
  bool there = 6; repeated Entry entries = 7; map<string, double> sizes = 8; }""",
}
HEAD = 'import "lab/msg/Status.msg"\nimport "h.proto"\ndata-holder: lab.Held\nwire-schema: lab/msg/Status\n'
DEFAULTS = {
    ".text": '.text = ""',
    ".level": ".level = 0",
    ".at": ".at = 0",
    ".rest": "len(.rest) = 0",
    ".levels": "len(.levels) = 0",
    ".there": ".there = false",
    ".entries": "len(.entries) = 0",
    ".sizes": "len(.sizes) = 0",
}
"""What a holder has that a test is not about."""

EMPTY = {"wanted": "", "values": [], "devices": []}


def files(rules, head=HEAD):
    return {**SCHEMAS, "m.mapping": f"{head}{rules}"}


def filled(rules):
    """The rules, and others for all fields that they do not set."""
    written = "".join(f"  {rule}\n" for rule in rules)
    others = (rule for name, rule in DEFAULTS.items() if not any(re.match(rf"(len\()? *\{name}\b", each.strip()) for each in rules))
    return written + "".join(f"  {rule}\n" for rule in others)


def decoder(rules, backend, **options):
    """``run(values=…)``: what rules to unpack make of a status."""
    decode = rj.Decoder("m.mapping", schema=files(f"unpack-rules:\n{filled(rules)}"), backend=backend, **options)
    write = rj.Encoder.of("lab/msg/Status", schema=SCHEMAS, imports=["lab/msg/Status.msg"], backend="interpreter")
    return lambda **fields: decode(write(write.holder_type.from_dict({**EMPTY, **fields}))).to_dict()


def pairs(*items):
    return [{"key": key, "value": value} for key, value in items]


def refused(kind, words, use, **fields):
    with pytest.raises(rj.MessageError) as error:
        use(**fields)
    assert error.value.kind == kind
    assert words in str(error.value)


@pytest.mark.parametrize("backend", BACKENDS)
def test_texts_wherever_they_stand(backend):
    run = decoder(['.text = .values[.key = "speed"].value', '.at = index(.values[.key = "speed"])'], backend)
    rng = random.Random(3)
    for size in (0, 1, 5, 40):
        items = [(f"speed{number}"[: rng.randrange(8)].replace("speed", "s"), str(number)) for number in range(size)]
        at = rng.randrange(size + 1)
        items.insert(at, ("speed", "21.5 é"))
        found = run(values=pairs(*items))
        assert (found["text"], found["at"]) == ("21.5 é", at)
    refused("index", '`.values` has no element whose `.key` is "speed"', run, values=pairs(("spee", ""), ("speedy", "")))
    refused("index", "has more than one element", run, values=pairs(("speed", "1"), ("x", "2"), ("speed", "1")))


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_may_be_missing(backend):
    rules = ['.text = .values[.key = "unit"].value if has(.values[.key = "unit"]) else "K"', '.there = has(.values[.key = "unit"])']
    run = decoder(rules, backend)
    assert run(values=pairs(("a", "b"), ("unit", "C"))) == {**run(), "text": "C", "there": True}
    assert run(values=pairs(("a", "b"))) == {**run(), "text": "K"}
    refused("index", "more than one", run, values=pairs(("unit", "C"), ("unit", "K")))


@pytest.mark.parametrize("backend", BACKENDS)
def test_numbers_and_keys_that_messages_tell(backend):
    rules = [
        ".level = .devices[.id = 7].level",
        ".text = .values[.key = .wanted].value",
        ".at = index(.devices[.id = 3 + 4].values[.key = .wanted])",
    ]
    run = decoder(rules, backend)
    devices = [{"id": number, "level": number / 2, "values": pairs(*[("x", "")] * number, ("é", ""))} for number in (9, 7, -7)]
    devices[2]["values"] = []
    found = run(wanted="é", values=pairs(("e", "1"), ("é", "2")), devices=devices)
    assert (found["level"], found["text"], found["at"]) == (3.5, "2", 7)
    refused("index", "whose `.id` is 7", run, wanted="é", values=pairs(("é", "2")), devices=[])
    refused("index", "whose `.key` is what is looked for", run, wanted="e", values=pairs(("é", "2")), devices=devices)


@pytest.mark.parametrize("backend", BACKENDS)
def test_keys_of_a_list_in_a_loop(backend):
    rules = ["len(.levels) = len(ids)", "for i from 0 to len(ids)", "  .levels[i] = .devices[.id = ids[i]].level", "end"]
    text = HEAD + "parameter ids: list of int32\nunpack-rules:\n" + filled(rules)
    decode = rj.Decoder("m.mapping", schema={**SCHEMAS, "m.mapping": text}, backend=backend, parameters={"ids": [5, -1, 3]})
    write = rj.Encoder.of("lab/msg/Status", schema=SCHEMAS, imports=["lab/msg/Status.msg"], backend="interpreter")
    devices = [{"id": number, "level": float(number), "values": []} for number in (3, 4, 5, -1)]
    message = write(write.holder_type.from_dict({**EMPTY, "devices": devices}))
    assert list(decode(message).levels) == [5.0, -1.0, 3.0]
    many = decode.many(message * 2, [0, len(message), 2 * len(message)])
    assert [list(each.levels) for each in many] == [[5.0, -1.0, 3.0]] * 2


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_search_of_each_round_fails_only_in_it(backend):
    rules = ["len(.levels) = len(.devices)", "for i from 0 to len(.devices)", '  .levels[i] = number(.values[.key = "x"].value)', "end"]
    run = decoder(rules, backend)
    device = {"id": 0, "level": 0.0, "values": []}
    assert run()["levels"] == []
    assert run(values=pairs(("a", "1"), ("x", "2.5")), devices=[device] * 3)["levels"] == [2.5] * 3
    refused("index", '"x"', run, devices=[device])


@pytest.mark.parametrize("backend", BACKENDS)
def test_all_but_some(backend):
    names = ["c", "a", "b"]
    looked = ", ".join(f'index(.values[.key = "{name}"])' for name in names)
    rules = ["len(.rest) = len(.values) - 3", "for i from 0 to len(.values) - 3", f"  .rest[i] = .values[others(i, {looked})].key", "end"]
    run = decoder(rules, backend)
    rng = random.Random(4)
    for _ in range(10):
        keys = [*names, *(f"k{number}" for number in range(rng.randrange(5)))]
        rng.shuffle(keys)
        assert run(values=pairs(*((key, "") for key in keys)))["rest"] == [key for key in keys if key not in names]


@pytest.mark.parametrize("backend", BACKENDS)
def test_others(backend):
    run = decoder([".at = others(.devices[0].id, .devices[1].id, .devices[2].id, .devices[3].id)"], backend)
    rng = random.Random(6)
    for _ in range(30):
        number, *without = rng.randrange(8), *(rng.randrange(8) for _ in range(3))
        found = run(devices=[{"id": each, "level": 0.0, "values": []} for each in (number, *without)])["at"]
        assert found == [each for each in range(20) if each not in without][number]
    assert decoder([".at = others(2, 1, 0, 1)"], backend)()["at"] == 4


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_directions(backend):
    text = """rules:
  .level <-> number(.values[.key = "level"].value)
  .text <-> .values[.key = "text"].value
  .entries[.name = "first"].number <-> integer(.values[.key = "first"].value)
  .entries[.name = "second"].number <-> integer(.devices[.id = 5].values[.key = "at"].value)
  .sizes[.key = "wide"].value <-> .devices[.id = 5].level
  ignore .wanted
unpack-rules:
  .at = 0
  len(.rest) = 0
  len(.levels) = 0
  .there = false
pack-rules:
  ignore .at
  ignore .rest
  ignore .levels
  ignore .there
"""
    decode = rj.Decoder("m.mapping", schema=files(text), backend=backend)
    encode = rj.Encoder("m.mapping", schema=files(text), backend=backend)
    write = rj.Encoder.of("lab/msg/Status", schema=SCHEMAS, imports=["lab/msg/Status.msg"], backend="interpreter")
    read = rj.Decoder.of("lab/msg/Status", schema=SCHEMAS, imports=["lab/msg/Status.msg"], backend="interpreter")
    values = pairs(("level", "0.5"), ("text", "t"), ("first", "1"))
    status = {"wanted": "", "values": values, "devices": [{"id": 5, "level": 2.5, "values": pairs(("at", "-3"))}]}
    message = write(write.holder_type.from_dict(status))
    held = decode(message)
    entries = [{"name": "first", "number": 1}, {"name": "second", "number": -3}]
    assert (held.level, held.text, held.to_dict()["entries"], held.to_dict()["sizes"]) == (0.5, "t", entries, {"wide": 2.5})
    assert encode(held) == message
    mixed = {**status, "values": [*reversed(values), *pairs(("more", "x"))]}
    assert decode(write(write.holder_type.from_dict(mixed))).to_dict() == held.to_dict()
    turned = {**held.to_dict(), "entries": entries[::-1]}
    assert read(encode(encode.holder_type.from_dict(turned))).to_dict() == status
    with pytest.raises(rj.EncodeError, match=r"has no element whose `\.name` is"):
        encode(encode.holder_type.from_dict({**turned, "entries": entries[:1]}))


@pytest.mark.parametrize("backend", BACKENDS)
def test_arrays_of_each_round_and_lengths_that_are_said(backend):
    text = """pack-rules:
  .wanted = ""
  .values[.key = "a"].value = .text
  len(.values) = 1 + len(.rest)
  for i from 0 to len(.rest)
    .values[1 + i].key = .rest[i]
    .values[1 + i].value = ""
  end
  len(.devices) = len(.levels)
  for i from 0 to len(.levels)
    .devices[i].id = int32(i)
    .devices[i].level = .levels[i]
    .devices[i].values[.key = "unit"].value = "m"
    .devices[i].values[.key = "at"].value = text(i)
  end
"""
    encode = rj.Encoder("m.mapping", schema=files(text), backend=backend)
    read = rj.Decoder.of("lab/msg/Status", schema=SCHEMAS, imports=["lab/msg/Status.msg"], backend="interpreter")
    found = read(encode(encode.holder_type.from_dict({"text": "t", "rest": ["x"], "levels": [0.5, 1.5]}))).to_dict()
    assert found["values"] == pairs(("a", "t"), ("x", ""))
    assert [each["values"] for each in found["devices"]] == [pairs(("unit", "m"), ("at", str(number))) for number in range(2)]


@pytest.mark.parametrize(
    ("rule", "code"),
    [
        (".text = .values[.key = 5].value", "not-comparable"),
        (".text = .values[.name = 5].value", "unknown-field"),
        (".text = .wanted[.key = 5]", "no-keys"),
        (".text = .values[.key[0] = 5].value", "key-field"),
        (".at = index(.values)", "arguments"),
        (".at = index(.values[0])", "arguments"),
        (".at = others(1)", "arguments"),
        (".entries[.name = .wanted].number = 5", "key-to-set"),
        (".there = has(.values[0])", "always-there"),
    ],
)
def test_what_is_no_search(rule, code):
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", schema=files(f"unpack-rules:\n{filled([rule])}"), backend="interpreter")
    assert code in {problem.code for problem in error.value.diagnostics}, str(error.value)
