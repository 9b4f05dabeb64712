"""The file of docs/yarp-to-ros2.md runs: what a port of YARP sends is read from a topic of ROS 2."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.checking import checked
from rosetta_jit.bridge.running import Running
from tests.transports.free import until
from tests.transports.name_server import NameServer

PAGE = Path(__file__).resolve().parents[2] / "docs" / "yarp-to-ros2.md"
DOMAIN = "&domain=77"


def test_the_robot_is_seen_by_ros_2(tmp_path):
    pytest.importorskip("cyclonedds")
    page, names = PAGE.read_text("utf-8"), NameServer()
    server = f"?server=127.0.0.1:{names.port}"
    (mapping,), (text,) = re.findall(r'MAPPING = """\n(.*?)"""', page, re.DOTALL), re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (tmp_path / "torso.mapping").write_text(mapping)
    text = text.replace("state:o", f"state:o{server}").replace('/joint_states"', f'/joint_states?{DOMAIN[1:]}"').replace("rate = 50", "")
    (tmp_path / "robot.toml").write_text(text)
    said = []
    bridge = Running(checked(str(tmp_path / "robot.toml")), said.append)
    topic = f"ros2-dds:/joint_states?type=sensor_msgs/msg/JointState{DOMAIN}"
    try:
        with rj.publish(f"yarp:/icub/torso/state:o{server}") as robot, rj.subscribe(topic) as ros:
            bridge.start()
            until(lambda: robot.connections and ros.connections)
            encode = rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp3")
            decode = rj.Decoder.of("sensor_msgs/msg/JointState")
            for number in range(5):
                robot.send(encode({"angles": [0.1 * number, 0.0, 1.0]}))
                found = decode(ros.take(5).data)
                assert list(found.name) == ["torso_yaw", "torso_roll", "torso_pitch"]
                assert list(found.position) == pytest.approx([0.1 * number, 0.0, 1.0])
    finally:
        bridge.stop(0.5)
        names.close()
    assert not said
