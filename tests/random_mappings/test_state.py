"""Random rules with state: each backend goes from message to message as plain Python does, one by one and as a batch."""

from __future__ import annotations

import random

import numpy as np
import pytest

import rosetta_jit as rj
from tests.random_mappings.arrays import some_arrays
from tests.random_mappings.fields import plain, some_fields
from tests.random_mappings.meaning import LEAVES, Refused
from tests.random_mappings.rules import exactly
from tests.random_mappings.test_mappings import FILES, IN, mapping
from tests.random_mappings.values import Made, Maker

MESSAGES = 30
TYPES = ["int64", "int32", "uint8", "float32", "float64", "bool"]
INITIAL = {"int64": ("-7", -7), "int32": ("3", 3), "uint8": ("200", 200), "bool": ("true", True)}


def initial(type_):
    kind = np.float32 if type_ == "float32" else np.float64
    return INITIAL.get(type_, ("0.5", kind(0.5)))


def some_rules(rng):
    """Variables with their types, what they become behind each message, and the fields that are made."""
    types = {f"v{number}": rng.choice(TYPES) for number in range(4)}
    atoms = tuple(Made(name, type_, lambda fields, name=name: fields[f"state {name}"]) for name, type_ in types.items())
    maker = Maker(rng, LEAVES, atoms=atoms)
    fields = {f"o{number}": exactly(maker, rng.choice(TYPES), rng.randrange(3)) for number in range(3)}
    fields |= {f"p{number}": atom for number, atom in enumerate(atoms)}  # so that each is read
    return types, {name: exactly(maker, type_, rng.randrange(3)) for name, type_ in types.items()}, fields


def files_of(types, after, fields):
    declared = "".join(f"state {name}: {type_} = {initial(type_)[0]}\n" for name, type_ in types.items())
    out = "".join(f"{made.type} {name}\n" for name, made in fields.items())
    rules = [f"  .{name} = {made.text}\n" for name, made in fields.items()] + [
        f"  state {name} = {made.text}\n" for name, made in after.items()
    ]
    found = mapping({**FILES, "t/In.msg": IN, "t/Out.msg": out}, "".join(rules), "decode")
    return {**found, "m.mapping": declared + found["m.mapping"]}


def followed(types, after, fields, messages):
    """What each message becomes, or the kind of its refusal; and what is kept behind all of them."""
    state = {f"state {name}": initial(type_)[1] for name, type_ in types.items()}
    found = []
    for message in messages:
        seen = {**message, **state}
        try:
            made = {name: plain(each.evaluate(seen)) for name, each in fields.items()}
            state = {f"state {name}": each.evaluate(seen) for name, each in after.items()}
            found.append(made)
        except Refused as refused:
            found.append(refused.kind)
    return found, {name: plain(state[f"state {name}"]) for name in types}


def check_state(seed, backends):
    rng = random.Random(f"state {seed}")
    types, after, fields = some_rules(rng)
    files = files_of(types, after, fields)
    messages = [{**some_arrays(rng), **some_fields(rng, LEAVES)} for _ in range(MESSAGES)]
    with np.errstate(all="ignore"):
        wanted, kept = followed(types, after, fields, messages)
    write = rj.Encoder.of("t/In", schema=files, imports=["t/In.msg", "t/Pt.msg"], encoding="ros1", backend="interpreter")
    sent = [write(write.holder_type.from_dict(each)) for each in messages]
    good = [each for each in wanted if isinstance(each, dict)]
    for backend in backends:
        decode = rj.Decoder("m.mapping", schema=files, encoding="ros1", backend=backend)
        assert [one(decode, each) for each in sent] == wanted, (seed, backend, files["m.mapping"], messages)
        assert {name: plain(value) for name, value in decode.state.items()} == kept, (seed, backend, files["m.mapping"])
        decode.reset()
        batch = decode.many(sent, on_error="skip")
        assert [plain_fields(row) for row in batch] == good, (seed, backend, files["m.mapping"], messages)
        assert {name: plain(value) for name, value in decode.state.items()} == kept, (seed, backend, files["m.mapping"])


def one(decode, message):
    try:
        return plain_fields(decode(message))
    except rj.DecodeError as error:
        return error.kind


def plain_fields(holder):
    return {name: plain(value) for name, value in holder.to_dict().items()}


def test_state():
    check_state(0, ["python", "llvm"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        check_state(seed, ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
