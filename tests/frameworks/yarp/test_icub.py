"""The shipped mappings of an iCub's parts: captured bytes of YARP in, each angle as numpy converts it, and the same bytes back."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from tests.frameworks.yarp.test_rst import messages

ARM = ("left_arm", "right_arm")
LEG = ("left_leg", "right_leg")
STATES = {"head": "icub_head_state_6", "torso": "icub_torso_state_3", **dict.fromkeys(LEG, "icub_head_state_6")}
STATES |= dict.fromkeys(ARM, "icub_arm_state_16")
"""A leg's bottle has six numbers as the head's has."""

SIZES = {"head": 6, "torso": 3, **dict.fromkeys(LEG, 6), **dict.fromkeys(ARM, 16)}


def programs(name, dialect="yarp3", backend="python"):
    return tuple(kind(f"yarp/icub/{name}.mapping", encoding=dialect, backend=backend) for kind in (rj.Decoder, rj.Encoder))


def typed(name, dialect="yarp3"):
    file = f"yarp/icub/{name}.bottle-schema"
    options = {"imports": [file], "encoding": dialect, "backend": "interpreter"}
    type_ = "yarp.icub." + name.rpartition("_")[0] + "." + name.rpartition("_")[2]
    return rj.Decoder.of(type_, **options), rj.Encoder.of(type_, **options)


@pytest.mark.parametrize(("dialect", "backend"), [("yarp3", "python"), ("yarp4", "llvm")])
@pytest.mark.parametrize("part", STATES)
def test_states(part, dialect, backend):
    decode, encode = programs(f"{part}_state", dialect, backend)
    sent = messages(dialect)[STATES[part]]
    degrees = np.frombuffer(sent[8:], "<f8")
    assert len(degrees) == SIZES[part]
    assert list(decode(sent).angles) == np.radians(degrees).astype(np.float32).tolist()
    assert np.allclose(np.frombuffer(encode(decode(sent))[8:], "<f8"), degrees, rtol=2e-7, atol=0)
    angles = (np.arange(1, SIZES[part] + 1) / 8).astype(np.float32)
    back = encode(encode.holder_type.from_dict({"angles": angles.tolist()}))
    assert np.array_equal(np.frombuffer(back[8:], "<f8"), np.degrees(angles.astype(np.float64)))
    assert list(decode(back).angles) == angles.tolist()
    with pytest.raises(rj.EncodeError):
        encode(encode.holder_type.from_dict({"angles": angles.tolist()[1:]}))


@pytest.mark.parametrize("part", STATES)
def test_commands(part):
    """All joints in the order of the part; the words before them are the schema's."""
    decode, encode = programs(f"{part}_command")
    read, write = typed(f"{part}_command")
    names = list(read(write(write.holder_type.from_dict({}))).to_dict()["angles"])
    assert len(names) == SIZES[part]
    angles = (np.arange(1, SIZES[part] + 1) / 8).astype(np.float32)
    sent = encode(encode.holder_type.from_dict({"angles": angles.tolist()}))
    found = read(sent).to_dict()["angles"]
    assert [found[name] for name in names] == np.degrees(angles.astype(np.float64)).tolist()
    assert list(decode(sent).angles) == angles.tolist()
    if part in ARM:
        captured = messages("yarp3")["icub_rpc_set_poss_16"]
        start = len(captured) - 8 * SIZES[part]
        assert sent[:8] == captured[:8]
        wanted = np.frombuffer(captured[start:], "<f8")
        assert list(decode(captured).angles) == np.radians(wanted).astype(np.float32).tolist()
        assert np.allclose(np.frombuffer(encode(decode(captured))[start:], "<f8"), wanted, rtol=2e-7, atol=0)
        assert encode(decode(captured))[:start] == captured[:start]


def test_one_joint():
    decode, encode = programs("position_command")
    captured = messages("yarp3")["icub_rpc_set_pos_joint"]
    read, _ = typed("position_command")
    values = read(captured).to_dict()
    held = decode(captured)
    assert held.name == bytes([values["joint"]])
    assert held.value == np.radians(values["position"]).astype(np.float32)
    back = read(encode(held)).to_dict()
    assert back["joint"] == values["joint"]
    assert back["position"] == pytest.approx(values["position"], rel=2e-7)
    assert encode(held)[:-8] == captured[:-8]
    _, write = typed("position_command")
    with pytest.raises(rj.DecodeError) as refused:
        decode(write(write.holder_type.from_dict({"joint": 256})))
    assert (refused.value.kind, refused.value.path) == ("range", ".name[0]")
