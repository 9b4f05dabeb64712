"""The files of routes that the pages show run: docs/yarp-to-ros2.md, docs/ros1-to-ros2.md and docs/rsb.md."""

from __future__ import annotations

import re
from contextlib import contextmanager
from pathlib import Path

import pytest

import rosetta_jit as rj
from rosetta_jit.bridge.checking import checked
from rosetta_jit.bridge.running import Running
from tests.transports.free import free_port, until
from tests.transports.name_server import NameServer
from tests.transports.ros_master import Master

DOCS = Path(__file__).resolve().parents[2] / "docs"
DOMAIN = "domain=77"


def files_of(page):
    return re.findall(r"```toml\n(.*?)```", (DOCS / page).read_text("utf-8"), re.DOTALL)


@contextmanager
def running(folder, text, *places):
    """The bridge of a file, each address of which that holds the first of a pair gets the options of the second."""
    for part, options in places:
        text = re.sub(rf'"({re.escape(part)}[^"?]*)(\??)([^"]*)"', rf'"\1?\3&{options}"', text).replace("?&", "?")
    (folder / "robot.toml").write_text(text)
    said = []
    bridge = Running(checked(str(folder / "robot.toml")), said.append)
    try:
        yield bridge
    finally:
        bridge.stop(0.5)
    assert not said


def test_the_robot_on_yarp_is_seen_by_ros_2(tmp_path):
    pytest.importorskip("cyclonedds")
    names = NameServer()
    server = f"server=127.0.0.1:{names.port}"
    (mapping,) = re.findall(r'MAPPING = """\n(.*?)"""', (DOCS / "yarp-to-ros2.md").read_text("utf-8"), re.DOTALL)
    (tmp_path / "torso.mapping").write_text(mapping)
    (text,) = files_of("yarp-to-ros2.md")
    topic = f"ros2-dds:/joint_states?type=sensor_msgs/msg/JointState&{DOMAIN}"
    try:
        with (
            running(tmp_path, text.replace("rate = 50", ""), ("yarp:", server), ("ros2-dds:", DOMAIN)) as bridge,
            rj.publish(f"yarp:/icub/torso/state:o?{server}") as robot,
            rj.subscribe(topic) as ros,
        ):
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
        names.close()


def test_topics_of_ros_1_and_ros_2_meet(tmp_path):
    pytest.importorskip("cyclonedds")
    master = Master()
    one, two = f"master={master.uri}", DOMAIN
    (text,) = files_of("ros1-to-ros2.md")
    imu = rj.Encoder.of("sensor_msgs/Imu", encoding="ros1")
    twist = rj.Encoder.of("geometry_msgs/msg/Twist", encoding="cdr")
    halves = {"decode": {"encoding": "cdr"}, "encode": {"encoding": "ros1"}}
    announced = rj.Bridge.of("sensor_msgs/msg/Imu", "sensor_msgs/Imu", **halves).announced("ros1")
    try:
        with (
            running(tmp_path, text, ("ros1:", one), ("ros2-dds:", two)) as bridge,
            rj.publish(f"ros1:/imu?{one}&name=/robot", **announced) as robot,
            rj.subscribe(f"ros1:/cmd_vel?{one}&name=/wheels") as wheels,
            rj.subscribe(f"ros2-dds:/imu?type=sensor_msgs/msg/Imu&{two}") as seen,
            rj.publish(f"ros2-dds:/cmd_vel?type=geometry_msgs/msg/Twist&{two}") as driver,
        ):
            bridge.start()
            until(lambda: robot.connections and wheels.connections and seen.connections and driver.connections)
            robot.send(imu({"header": {"seq": 9, "stamp": {"secs": 7, "nsecs": 8}}, "angular_velocity": {"z": 1.5}}))
            found = rj.Decoder.of("sensor_msgs/msg/Imu")(seen.take(5).data)
            assert (found.header.stamp.sec, found.header.stamp.nanosec, found.angular_velocity.z) == (7, 8, 1.5)
            driver.send(twist({"linear": {"x": 0.25}}))
            command = wheels.take(5)
            assert command.type == "geometry_msgs/Twist"
            assert rj.Decoder.of("geometry_msgs/Twist", encoding="ros1")(command.data).linear.x == 0.25
    finally:
        master.close()


def test_components_on_rsb_see_and_command_a_robot_on_yarp(tmp_path):
    names, port = NameServer(), free_port()
    server, bus = f"server=127.0.0.1:{names.port}", f"port={port}"
    asked = []
    try:
        with (
            running(tmp_path, files_of("rsb.md")[0], ("yarp:", server), ("rsb:", bus)) as bridge,
            rj.publish(f"yarp:/icub/torso/state:o?{server}") as robot,
            rj.serve(f"yarp:/icub/torso/rpc:i?{server}", lambda message: asked.append(bytes(message.data)) or b""),
            rj.subscribe(f"rsb:/icub/torso?host=localhost&{bus}&patient=yes&role=client") as seen,
            rj.publish(f"rsb:/icub/command/torso?host=localhost&{bus}&patient=yes&role=client&type=.rst.kinematics.JointAngles") as command,
        ):
            bridge.start()
            until(lambda: robot.connections and seen.connections and command.connections)
            robot.send(rj.Encoder("yarp/icub/torso_state.mapping", encoding="yarp3")({"angles": [0.5, 0.0, -0.25]}))
            event = seen.take(5)
            assert (event.channel, event.type) == ("/icub/torso/", ".rst.kinematics.JointAngles")
            assert list(rj.Decoder.of("rst.kinematics.JointAngles")(event.data).angles) == pytest.approx([0.5, 0.0, -0.25])
            command.send(rj.Encoder.of("rst.kinematics.JointAngles")({"angles": [0.25, 0.0, 1.0]}))
            until(lambda: asked)
            assert asked == [rj.Encoder("yarp/icub/torso_command.mapping", encoding="yarp3")({"angles": [0.25, 0.0, 1.0]})]
    finally:
        names.close()
