"""Routes that join the messages of several sources, over sockets of this machine."""

from __future__ import annotations

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.checking import checked, lines
from rosetta_jit.bridge.running import Running
from tests.transports.free import free_port, until

FILES = {
    "both.proto": """syntax = "proto3";
message Place { double x = 1; } message Speed { double v = 1; }
message Motion { double x = 1; double v = 2; int64 seen = 3; }""",
    "motion.mapping": """import "both.proto"
data-holder: Motion
wire-schema place: Place
wire-schema speed: Speed
state seen: int64 = 0
unpack-rules:
  .x = .place.x
  .v = .speed.v
  .seen = seen
  state seen = seen + 1
  reject "too fast" when .speed.v > 100.0
""",
}


def types(name, kind):
    return kind.of(name, schema=FILES, imports=["both.proto"], encoding="protobuf")


PLACE, SPEED, MOTION = types("Place", rj.Encoder), types("Speed", rj.Encoder), types("Motion", rj.Decoder)


def route(place, speed, target, *rest):
    sources = f'{{ place = "tcp:{place}", speed = "tcp:{speed}" }}'
    return "\n".join(["[[route]]", 'name = "motion"', f"sources = {sources}", f'target = "tcp:{target}"', *rest, ""])


@pytest.fixture
def configured(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)

    def write(text):
        (tmp_path / "bridge.toml").write_text(text)
        return str(tmp_path / "bridge.toml")

    return write


@pytest.mark.parametrize("on", ["", "speed"])
def test_what_several_sources_send_goes_on_together(configured, on):
    places, speeds, target = free_port(), free_port(), free_port()
    path = configured(route(places, speeds, target, 'mapping = "motion.mapping"', *([f'on = "{on}"'] if on else [])))
    said = []
    bridge = Running(checked(path), said.append)
    with rj.subscribe(f"tcp:{target}") as listener:
        bridge.start()
        try:
            with rj.publish(f"tcp:{places}") as place, rj.publish(f"tcp:{speeds}") as speed:
                place.send(PLACE({"x": 1.0}))
                until(lambda: bridge.snapshot()[0]["taken"] == 1)
                speed.send(SPEED({"v": 2.0}))
                assert MOTION(listener.take(5).data).to_dict() == {"x": 1.0, "v": 2.0, "seen": 1}
                place.send(PLACE({"x": 3.0}))
                if not on:
                    assert MOTION(listener.take(5).data).to_dict() == {"x": 3.0, "v": 2.0, "seen": 2}
                until(lambda: bridge.snapshot()[0]["taken"] == 3)
                speed.send(SPEED({"v": 1e3}))
                until(lambda: bridge.snapshot()[0]["failed"])
                place.send(PLACE({"x": 4.0}))
                until(lambda: bridge.snapshot()[0]["taken"] == 5)
                speed.send(SPEED({"v": 5.0}))
                assert MOTION(listener.take(5).data).to_dict() == {"x": 4.0, "v": 5.0, "seen": 4}
            found = bridge.snapshot()[0]
            assert (found["sent"], found["dropped"], sum(found["failed"].values())) == (2 if on else 3, {}, 1)
            assert found["state"] == {"decode.seen": 5, "age.place": 1, "age.speed": 0}
            assert any("too fast" in line for line in said)
        finally:
            bridge.stop(0.2)


def test_a_rate_holds_for_what_goes_on(configured):
    places, speeds, target = free_port(), free_port(), free_port()
    path = configured(route(places, speeds, target, 'mapping = "motion.mapping"', "rate = 0.01"))
    bridge = Running(checked(path), lambda _: None)
    with rj.subscribe(f"tcp:{target}") as listener:
        bridge.start()
        try:
            with rj.publish(f"tcp:{places}") as place, rj.publish(f"tcp:{speeds}") as speed:
                for number in range(3):
                    place.send(PLACE({"x": float(number)}))
                until(lambda: bridge.snapshot()[0]["taken"] == 3)
                speed.send(SPEED({"v": 2.0}))
                assert MOTION(listener.take(5).data).to_dict() == {"x": 2.0, "v": 2.0, "seen": 3}
                for number in (3.0, 4.0):
                    speed.send(SPEED({"v": number}))
                until(lambda: bridge.snapshot()[0]["dropped"] == {"above its rate": 1})
        finally:
            bridge.stop(0.2)


def test_what_a_file_says_of_sources(configured):
    shown = lines(checked(configured(route(9001, 9002, 9003, 'mapping = "motion.mapping"', 'on = "speed"'))))
    assert shown[1:3] == ["  from tcp:9001 (place)", "  from tcp:9002 (speed)"]
    assert "       behind messages of speed, once all have come" in shown


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (route(1, 2, 3), "a `mapping` of several wires"),
        (route(1, 2, 3, 'mapping = "motion.mapping"', 'on = "x"'), "one of the names in `sources`"),
        (route(1, 2, 3, 'mapping = "motion.mapping"', 'source = "tcp:4"'), "one of `source` and `sources`"),
        (route(1, 2, 3, 'mapping = "motion.mapping"').replace("speed =", "spied ="), "no address for wire `speed`"),
        (route(1, 2, 3, 'mapping = "motion.mapping"').replace("speed = ", 'more = "tcp:5", speed = '), "has no wire `more`"),
        (route(1, 2, 3, 'mapping = "motion.mapping"').replace('"tcp:2"', "2"), "addresses by the names of wires"),
        (route(1, 2, 3, 'mapping = "motion.mapping"').replace("tcp:2", "nothing:2"), "nothing"),
        (route(1, 2, 3, 'mapping = "yarp/icub/torso_state.mapping"'), "one wire, which has no name"),
        ('[[route]]\nsource = "tcp:1"\ntarget = "tcp:2"\nmapping = "motion.mapping"\n', "several wires"),
    ],
)
def test_mistakes(configured, text, said):
    with pytest.raises(rj.BridgeError, match=said):
        checked(configured(text))
