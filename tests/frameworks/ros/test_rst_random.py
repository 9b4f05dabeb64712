"""The pairs of larger messages of ROS 1 and RST, from bytes of rosbags with random values: each value, and the bytes that go back."""

from __future__ import annotations

import random

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from tests.frameworks.ros.test_rst_pairs import STORE, raw, theirs, window

MESSAGES = 20
CHANNELS = {"mono8": (1, 8), "rgb8": (3, 8), "bgra8": (4, 8), "mono16": (1, 16), "rgb16": (3, 16), "32FC1": (1, 32)}


class Peer:
    """Random messages of the peer, each beside what RST holds of it."""

    def __init__(self, seed):
        self.rng, self.numbers = random.Random(seed), np.random.default_rng(seed)

    def number(self):
        return self.rng.choice([self.rng.uniform(-1e3, 1e3), 0.0, -0.0, 1e-30, 1e30])

    def some(self, make):
        return [make() for _ in range(self.rng.randrange(4))]

    def stamp(self):
        return theirs("builtin_interfaces/Time", sec=self.rng.randrange(2**31), nanosec=self.rng.randrange(10**9))

    def header(self):
        return theirs("std_msgs/Header", seq=self.rng.randrange(2**32), stamp=self.stamp(), frame_id=self.rng.choice(["", "map", "é"]))

    def point(self, name="Point"):
        return theirs(f"geometry_msgs/{name}", x=self.number(), y=self.number(), z=self.number())

    def turn(self):
        return theirs("geometry_msgs/Quaternion", x=self.number(), y=self.number(), z=self.number(), w=self.rng.uniform(0.1, 1))

    def pose(self):
        return theirs("geometry_msgs/Pose", position=self.point(), orientation=self.turn())

    def certain(self):
        return theirs("geometry_msgs/PoseWithCovariance", pose=self.pose(), covariance=self.numbers.normal(size=36))

    def image(self, encoding):
        channels, bits = CHANNELS[encoding]
        width, height, big = self.rng.randrange(5), self.rng.randrange(4), self.rng.randrange(2)
        size, step = channels * bits // 8, width * channels * bits // 8 + self.rng.randrange(3)
        rows = self.numbers.integers(0, 256, (height, step)).astype(np.uint8)
        fields = {"height": height, "width": width, "encoding": encoding, "is_bigendian": big, "step": step, "data": rows.ravel()}
        pixels = rows[:, : width * size].reshape(-1, bits // 8)
        return theirs("sensor_msgs/Image", header=self.header(), **fields), (pixels[:, ::-1] if big else pixels).tobytes()

    # --- pairs ---

    def pose_with_covariance(self):
        message = self.certain()
        return message, placed(message.pose)

    def odometry(self):
        moved = theirs("geometry_msgs/Twist", linear=self.point("Vector3"), angular=self.point("Vector3"))
        twist = theirs("geometry_msgs/TwistWithCovariance", twist=moved, covariance=self.numbers.normal(size=36))
        message = theirs("nav_msgs/Odometry", header=self.header(), child_frame_id="base", pose=self.certain(), twist=twist)
        return message, placed(message.pose.pose)

    def point_stamped(self):
        message = theirs("geometry_msgs/PointStamped", header=self.header(), point=self.point())
        return message, {"timestamp": {"time": microseconds(message.header)}, "point": narrow(message.point, "xy")}

    def path(self):
        poses = self.some(lambda: theirs("geometry_msgs/PoseStamped", header=self.header(), pose=self.pose()))
        held = [{"timestamp": {"time": microseconds(each.header)}, "point": narrow(each.pose.position, "xy")} for each in poses]
        return theirs("nav_msgs/Path", header=self.header(), poses=poses), {"entry": held}

    def disparity_image(self):
        image, data = self.image("32FC1")
        least = {"min_disparity": 0.5, "max_disparity": 9.0, "delta_d": 0.25, "f": 1.5, "T": 2.5}
        message = theirs("stereo_msgs/DisparityImage", header=self.header(), image=image, valid_window=window(), **least)
        colors = {"channels": 1, "depth": "DEPTH_32F", "color_mode": "COLOR_GRAYSCALE", "data_order": "DATA_INTERLEAVED"}
        return message, {"width": image.width, "height": image.height, **colors, "data": data}

    def image_example(self):
        encoding = self.rng.choice(list(CHANNELS))
        message, data = self.image(encoding)
        channels, bits = CHANNELS[encoding]
        known = {"meta_data": [{"key": "encoding", "value": encoding}], "depths": [bits] * channels}
        return message, {"width": message.width, "height": message.height, **known, "data": data}

    def imu(self):
        names = ("orientation_covariance", "angular_velocity_covariance", "linear_acceleration_covariance")
        covariances = {name: self.numbers.normal(size=9) for name in names}
        moved = {name: self.point("Vector3") for name in ("angular_velocity", "linear_acceleration")}
        message = theirs("sensor_msgs/Imu", header=self.header(), orientation=self.turn(), **covariances, **moved)
        return message, turned(message.orientation)

    def grid_cells(self):
        cells = self.some(self.point)
        message = theirs("nav_msgs/GridCells", header=self.header(), cell_width=0.5, cell_height=0.25, cells=cells)
        return message, {"points": [narrow(each, "xyz") for each in cells]}

    def occupancy_grid(self):
        height, width = self.rng.randrange(4), self.rng.randrange(4)
        info = {"map_load_time": self.stamp(), "resolution": 0.5, "width": width, "height": height, "origin": self.pose()}
        data = self.numbers.integers(-1, 101, height * width).astype(np.int8)
        message = theirs("nav_msgs/OccupancyGrid", header=self.header(), info=theirs("nav_msgs/MapMetaData", **info), data=data)
        return message, {"size": {"m": height, "n": width}, "data": {"value": data.astype(float).tolist()}}

    def channel_sound(self):
        values = self.numbers.normal(size=5).astype(np.float32)
        return theirs("sensor_msgs/ChannelFloat32", name="left", values=values), {"floatbuffer": values.tolist()}

    def marker(self):
        points, color = self.some(self.point), theirs("std_msgs/ColorRGBA", r=0.1, g=0.2, b=0.3, a=0.4)
        shown = {"pose": self.pose(), "scale": self.point("Vector3"), "color": color, "colors": [color], "frame_locked": True}
        named = {"ns": "n", "id": 3, "text": "t", "mesh_resource": "m", "mesh_use_embedded_materials": True}
        lifetime = theirs("builtin_interfaces/Duration", sec=1, nanosec=2)
        type_ = self.rng.randrange(4, 9)
        fields = {"header": self.header(), "type": type_, "action": 0, "lifetime": lifetime, "points": points}
        return theirs("visualization_msgs/Marker", **fields, **shown, **named), {"points": [narrow(each, "xyz") for each in points]}

    def goal_id(self):
        number = self.rng.randrange(2**32)
        return theirs("actionlib_msgs/GoalID", stamp=self.stamp(), id=str(number)), {"id": number}

    def pose_array(self):
        poses = self.some(self.pose)
        places, turns = [placed(each)["translation"] for each in poses], [turned(each.orientation) for each in poses]
        return theirs("geometry_msgs/PoseArray", header=self.header(), poses=poses), {"position": places, "rotation": turns, "name": []}


def narrow(point, names):
    return {name: float(np.float32(getattr(point, name))) for name in names}


def turned(turn):
    return {f"q{name}": getattr(turn, name) for name in "xyzw"}


def placed(pose):
    return {"translation": {name: getattr(pose.position, name) for name in "xyz"}, "rotation": turned(pose.orientation)}


def microseconds(header):
    return header.stamp.sec * 1_000_000 + header.stamp.nanosec // 1000


def plain(value):
    """A value that is the same as another one if it is to the bit."""
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if isinstance(value, float):
        return np.float64(value).tobytes()
    return [plain(each) for each in value] if isinstance(value, list) else value.decode("latin-1") if isinstance(value, bytes) else value


PAIRS = (
    *("pose_with_covariance", "odometry", "point_stamped", "path", "disparity_image", "image_example", "imu"),
    *("grid_cells", "occupancy_grid", "channel_sound", "marker", "goal_id", "pose_array"),
)


@pytest.mark.parametrize("name", PAIRS)
def test_each_value_and_back(name):
    peer = Peer(PAIRS.index(name))
    decode, encode = (kind(f"ros1/{name}.mapping", encoding="ros1") for kind in (rj.Decoder, rj.Encoder))
    for _ in range(MESSAGES):
        message, held = getattr(peer, name)()
        found = decode(raw(message)).to_dict()
        assert plain(found) == plain(held)
        packed = encode(encode.holder_type.from_dict(found))
        read = STORE.deserialize_ros1(packed, message.__msgtype__)
        assert raw(read) == packed
        assert plain(decode(packed).to_dict()) == plain(held)
