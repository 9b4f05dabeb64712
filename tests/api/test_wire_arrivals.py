"""`has(.wire)`: rules that ask whether a message of another wire has arrived."""

from __future__ import annotations

import pytest

import rosetta_jit as rj

FILES = {
    "lab/Odom.msg": "float64 x\nfloat64 speed\nstring frame\n",
    "lab/Gps.msg": "float64 x\nbool fixed\n",
    "state.proto": """syntax = "proto3";
message State { double x = 1; string source = 2; bool has_gps = 3; double apart = 4; double shifted = 5; repeated double both = 6; }""",
    "state.mapping": """import "lab/Odom.msg"
import "lab/Gps.msg"
import "state.proto"
data-holder: State
wire-schema odom: lab/Odom
wire-schema gps: lab/Gps
unpack-rules:
  ignore rest
  .has_gps = has(.gps)
  .source = .odom.frame + (" and gps" if has(.gps) else " alone")
  when has(.gps)
    .x = 0.5 * (.odom.x + .gps.x)
  else
    .x = .odom.x
  end
  .apart = .odom.x - .gps.x
  .shifted = .odom.x + (.gps.x if has(.gps) and .gps.fixed else 100.0)
  .both = [.odom.x, .gps.x if has(.gps) else -1.0]
""",
}
ODOM = {"x": 1.0, "speed": 0.5, "frame": "map"}
GPS = {"x": 3.0, "fixed": True}


@pytest.fixture(scope="module", params=["llvm", "python", "interpreter"])
def decode(request: pytest.FixtureRequest) -> rj.Decoders:
    return rj.Decoders("state.mapping", schema=FILES, backend=request.param)


@pytest.fixture(scope="module")
def messages() -> dict[str, bytes]:
    def written(type_: str, values: dict[str, object]) -> bytes:
        write = rj.Encoder.of(type_, schema=FILES, imports=[f"{type_}.msg"])
        return write(write.holder_type.from_dict(values))

    return {"odom": written("lab/Odom", ODOM), "gps": written("lab/Gps", GPS)}


def test_before_and_after_the_other_wire(decode: rj.Decoders, messages: dict[str, bytes]) -> None:
    decode.reset()
    first = decode.odom(messages["odom"]).to_dict()
    assert first == {"x": 1.0, "source": "map alone", "has_gps": False, "apart": 0.0, "shifted": 101.0, "both": [1.0, -1.0]}
    found = decode.gps(messages["gps"]).to_dict()
    assert found == {"x": 2.0, "source": "map alone", "has_gps": True, "apart": -2.0, "shifted": 4.0, "both": [1.0, 3.0]}
    assert decode.odom(messages["odom"]).source == "map and gps"


def test_a_wire_that_is_not_asked_for_is_waited_for(decode: rj.Decoders, messages: dict[str, bytes]) -> None:
    decode.reset()
    found = decode.gps.into(messages["gps"], decode.new())
    assert found.to_dict() == {"x": 0.0, "source": "", "has_gps": True, "apart": 0.0, "shifted": 0.0, "both": [0.0, 3.0]}


def test_reset_forgets_what_has_arrived(decode: rj.Decoders, messages: dict[str, bytes]) -> None:
    decode.gps(messages["gps"])
    decode.reset()
    assert decode.odom(messages["odom"]).shifted == 101.0
