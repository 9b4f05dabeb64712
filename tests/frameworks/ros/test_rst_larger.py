"""The shipped mappings between larger messages of ROS 1 and plain types of RST: bytes of rosbags in, values, and bytes for rosbags."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from tests.frameworks.ros.test_rst_pairs import MATRIX, NARROW, POINTS, ROTATION, STORE, TURN, XYZ, camera, header, numbers, raw, theirs

BACKENDS = ["llvm", "python"]
FLAT = {"x": 1.5, "y": -2.25, "z": 0.0}
POSE = {"translation": XYZ, "rotation": ROTATION}
UNKNOWN = np.array([-1.0] + [0.0] * 8)
UPRIGHT = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
MICROSECONDS = 1_700_000_000_123_456
CELLS = np.array([-1, 0, 100, 50, 25, 0], np.int8)
SAMPLES = np.array([0.5, -1.0, 1e-3], np.float32)


def pose(position=XYZ, turn=TURN):
    return theirs("geometry_msgs/Pose", position=numbers("Point", position), orientation=numbers("Quaternion", turn))


def certain(covariance):
    return theirs("geometry_msgs/PoseWithCovariance", pose=pose(), covariance=np.full(36, covariance))


def origin():
    return pose(dict.fromkeys("xyz", 0.0), UPRIGHT)


def odometry(made=False):
    vectors = {name: numbers("Vector3", dict.fromkeys("xyz", 0.0 if made else 2.0)) for name in ("linear", "angular")}
    moved = theirs("geometry_msgs/TwistWithCovariance", twist=theirs("geometry_msgs/Twist", **vectors), covariance=np.zeros(36))
    place = certain(0.0 if made else 0.5)
    return theirs(
        "nav_msgs/Odometry", header=header(0, "") if made else header(), child_frame_id="" if made else "base", pose=place, twist=moved
    )


def imu(made=False, **fields):
    moved = numbers("Vector3", dict.fromkeys("xyz", 0.0 if made else 2.0))
    values = {
        "header": header(0, "") if made else header(),
        "orientation": numbers("Quaternion", TURN),
        "orientation_covariance": np.zeros(9) if made else np.eye(3).ravel(),
        "angular_velocity": moved,
        "angular_velocity_covariance": UNKNOWN if made else np.eye(3).ravel(),
        "linear_acceleration": moved,
        "linear_acceleration_covariance": UNKNOWN if made else np.eye(3).ravel(),
    }
    return theirs("sensor_msgs/Imu", **{**values, **fields})


def stamped(nanosec, frame, seq):
    stamp = theirs("builtin_interfaces/Time", sec=1_700_000_000, nanosec=nanosec)
    return theirs("std_msgs/Header", seq=seq, stamp=stamp, frame_id=frame)


def point_stamped(made=False):
    at = stamped(123_456_000, "", 0) if made else stamped(123_456_789, "map", 7)
    return theirs("geometry_msgs/PointStamped", header=at, point=numbers("Point", FLAT if made else {**FLAT, "z": 3.0}))


def path(made=False):
    at = stamped(123_456_000, "", 0) if made else stamped(123_456_789, "map", 7)
    place = pose(FLAT, UPRIGHT) if made else pose({**FLAT, "z": 3.0})
    poses = [theirs("geometry_msgs/PoseStamped", header=at, pose=place)] * 2
    return theirs("nav_msgs/Path", header=header(0, "") if made else header(), poses=poses)


def grid_cells(made=False):
    sizes = dict.fromkeys(("cell_width", "cell_height"), 0.0 if made else 0.5)
    return theirs(
        "nav_msgs/GridCells", header=header(0, "") if made else header(), cells=[numbers("Point", each) for each in POINTS], **sizes
    )


def marker(made=False, **fields):
    color = theirs("std_msgs/ColorRGBA", **dict.fromkeys("rgba", 1.0 if made else 0.5))
    size = 0.01 if made else 2.0
    values = {
        "header": header(0, "map") if made else header(),
        "ns": "" if made else "walls",
        "id": 0 if made else 3,
        "type": 8 if made else 4,
        "action": 0,
        "pose": origin() if made else pose(),
        "scale": numbers("Vector3", {"x": size, "y": size, "z": 0.0 if made else 2.0}),
        "color": color,
        "lifetime": theirs("builtin_interfaces/Duration", sec=0 if made else 1, nanosec=0),
        "frame_locked": not made,
        "points": [numbers("Point", each) for each in POINTS],
        "colors": [] if made else [color, color],
        "text": "" if made else "t",
        "mesh_resource": "",
        "mesh_use_embedded_materials": False,
    }
    return theirs("visualization_msgs/Marker", **{**values, **fields})


def grid(made=False, **fields):
    info = theirs(
        "nav_msgs/MapMetaData",
        map_load_time=theirs("builtin_interfaces/Time", sec=0 if made else 5, nanosec=0),
        resolution=1.0 if made else 0.05,
        width=3,
        height=2,
        origin=origin() if made else pose(),
    )
    values = {"header": header(0, "") if made else header(), "info": info, "data": CELLS}
    return theirs("nav_msgs/OccupancyGrid", **{**values, **fields})


def goal(made=False, **fields):
    stamp = theirs("builtin_interfaces/Time", sec=0 if made else 5, nanosec=0)
    return theirs("actionlib_msgs/GoalID", **{"stamp": stamp, "id": "4294967295", **fields})


def poses(made=False):
    return theirs("geometry_msgs/PoseArray", header=header(0, "") if made else header(), poses=[pose(), pose(FLAT, UPRIGHT)])


def channel(name):
    return theirs("sensor_msgs/ChannelFloat32", name=name, values=SAMPLES)


ENTRY = {"point": {"x": 1.5, "y": -2.25}, "timestamp": {"time": MICROSECONDS}}
TURNED = [ROTATION, {"qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0}]
PROJECTION = {f"c{row + 1}{column + 1}": MATRIX[4 * row + column] for row in range(3) for column in range(4)}
CASES = {
    "pose_with_covariance": (POSE, certain(0.5), certain(0.0)),
    "odometry": (POSE, odometry(), odometry(made=True)),
    "imu": (ROTATION, imu(), imu(made=True)),
    "point_stamped": (ENTRY, point_stamped(), point_stamped(made=True)),
    "path": ({"entry": [ENTRY, ENTRY]}, path(), path(made=True)),
    "grid_cells": ({"points": POINTS}, grid_cells(), grid_cells(made=True)),
    "marker": ({"points": POINTS}, marker(), marker(made=True)),
    "occupancy_grid": ({"size": {"m": 2, "n": 3}, "data": {"value": CELLS.tolist()}}, grid(), grid(made=True)),
    "channel_sound": ({"floatbuffer": SAMPLES.tolist()}, channel("left"), channel("")),
    "goal_id": ({"id": 4294967295}, goal(), goal(made=True)),
    "pose_array": ({"position": [XYZ, FLAT], "rotation": TURNED, "name": []}, poses(), poses(made=True)),
}
"""What is held, the message that it is read from, and the message that is written of it."""


@cache
def programs(name, backend):
    return tuple(kind(f"ros1/{name}.mapping", encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CASES)
def test_values_and_back(name, backend):
    held, message, back = CASES[name]
    decode, encode = programs(name, backend)
    found = decode(raw(message))
    assert found.to_dict() == held
    assert encode(found) == raw(back)
    assert encode(encode.holder_type.from_dict(held)) == raw(back)


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_messages_of_two_cameras(backend):
    decode, encode = programs("calibration_matrices", backend)
    left, right = camera(), camera()
    right.P = MATRIX[::-1].copy()
    found = decode(raw(left) + raw(right))
    other = dict(zip(PROJECTION, MATRIX[::-1], strict=True))
    assert found.to_dict() == {"left": PROJECTION, "right": other}
    sent = encode(found)
    assert sent[: len(sent) // 2] == raw(camera(made=True))
    second = STORE.deserialize_ros1(sent[len(sent) // 2 :], "sensor_msgs/msg/CameraInfo")
    assert second.P.tolist() == MATRIX[::-1].tolist()


def picture(encoding, rows, width, *, big=False):
    fields = {"height": len(rows), "width": width, "encoding": encoding, "is_bigendian": int(big), "step": rows.shape[1]}
    return theirs("sensor_msgs/Image", header=header(), **fields, data=rows.ravel())


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("big", [False, True])
def test_disparities(big, backend):
    decode, encode = programs("disparity_image", backend)
    values = np.arange(6.0).reshape(2, 3)
    padded = np.pad(values.astype(">f4" if big else "<f4").view(np.uint8).reshape(2, 12), ((0, 0), (0, 4)))
    rest = {"f": 500.0, "T": 0.1, "min_disparity": 1.0, "max_disparity": 64.0, "delta_d": 0.25}
    window = theirs("sensor_msgs/RegionOfInterest", x_offset=1, y_offset=0, width=2, height=2, do_rectify=True)

    def disparity(image):
        return raw(theirs("stereo_msgs/DisparityImage", header=header(), image=image, valid_window=window, **rest))

    found = decode(disparity(picture("32FC1", padded, 3, big=big)))
    expected = {
        "width": 3,
        "height": 2,
        "channels": 1,
        "depth": "DEPTH_32F",
        "color_mode": "COLOR_GRAYSCALE",
        "data_order": "DATA_INTERLEAVED",
    }
    assert found.to_dict() == {**expected, "data": values.astype("<f4").tobytes()}
    back = STORE.deserialize_ros1(encode(found), "stereo_msgs/msg/DisparityImage")
    assert (back.image.encoding, back.image.step, back.image.data.tobytes()) == ("32FC1", 12, values.astype("<f4").tobytes())
    assert (back.valid_window.width, back.valid_window.height, back.f) == (3, 2, 0.0)
    found.width = 4
    with pytest.raises(rj.EncodeError, match="do not fill the image"):
        encode(found)
    with pytest.raises(rj.DecodeError, match="disparities are 32FC1, not mono8"):
        decode(disparity(picture("mono8", padded, 3)))


@pytest.mark.parametrize("backend", BACKENDS)
def test_images_with_properties(backend):
    decode, encode = programs("image_example", backend)
    for encoding, bits, channels in (
        ("mono8", 8, 1),
        ("bgr8", 8, 3),
        ("rgba8", 8, 4),
        ("16UC1", 16, 1),
        ("rgb16", 16, 3),
        ("32FC1", 32, 1),
    ):
        size = 3 * channels * bits // 8
        for big in (False, True):
            rows = np.arange(2 * (size + 3), dtype=np.uint8).reshape(2, -1)
            pixels = rows[:, :size].reshape(-1, bits // 8)
            pixels = pixels[:, ::-1].tobytes() if big else pixels.tobytes()
            found = decode(raw(picture(encoding, rows, 3, big=big)))
            properties = [{"key": "encoding", "value": encoding}]
            assert found.to_dict() == {"meta_data": properties, "width": 3, "height": 2, "depths": [bits] * channels, "data": pixels}
            back = STORE.deserialize_ros1(encode(found), "sensor_msgs/msg/Image")
            assert (back.encoding, back.step, back.is_bigendian, back.data.tobytes()) == (encoding, size, 0, pixels)
    with pytest.raises(rj.DecodeError, match="the bits of yuv422 are not known"):
        decode(raw(picture("yuv422", rows, 3)))
    found = decode(raw(picture("mono8", rows, 3))).to_dict()
    for change, words in (
        ({"meta_data": []}, 'no element whose `.key` is "encoding"'),
        ({"depths": [16]}, "as many channels of as many bits"),
        ({"width": 4}, "do not fill the image"),
    ):
        with pytest.raises(rj.EncodeError, match=words):
            encode(encode.holder_type.from_dict({**found, **change}))


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_one_of_them_cannot_say_is_refused(backend):
    for name, message, kind in (
        ("imu", imu(orientation_covariance=UNKNOWN), "rejected"),
        ("marker", marker(type=9), "rejected"),
        ("marker", marker(action=2), "rejected"),
        ("occupancy_grid", grid(data=CELLS[1:]), "rejected"),
        ("goal_id", goal(id="seven"), "text"),
    ):
        with pytest.raises(rj.DecodeError) as error:
            programs(name, backend)[0](raw(message))
        assert error.value.kind == kind
    turned = dict.fromkeys(ROTATION, 0.0)
    late = {**ENTRY, "timestamp": {"time": 1 << 63}}
    for name, held, kind in (
        ("odometry", {**POSE, "rotation": turned}, "rejected"),
        ("imu", turned, "rejected"),
        ("point_stamped", late, "range"),
        ("path", {"entry": [ENTRY, late]}, "range"),
        ("occupancy_grid", {"size": {"m": 2, "n": 3}, "data": {"value": [0.5] * 6}}, "range"),
        ("occupancy_grid", {"size": {"m": 2, "n": 3}, "data": {"value": [0.0] * 5}}, "rejected"),
        ("pose_array", {"position": [XYZ], "rotation": [], "name": []}, "rejected"),
        ("pose_array", {"position": [XYZ], "rotation": [turned], "name": []}, "rejected"),
    ):
        encode = programs(name, backend)[1]
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict(held))
        assert error.value.kind == kind


def test_what_rst_lacks_is_given():
    sizes = {"cell_width": 0.25, "cell_height": 0.5}
    encode = rj.Encoder("ros1/grid_cells.mapping", encoding="ros1", parameters=sizes, backend="python")
    back = STORE.deserialize_ros1(encode(encode.holder_type.from_dict({"points": [NARROW]})), "nav_msgs/msg/GridCells")
    assert (back.cell_width, back.cell_height) == (0.25, 0.5)
