"""Clouds of points of ROS 1 as RST's: fields between others, padded rows, either byte order, against numpy."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS1_NOETIC)
BACKENDS = ["llvm", "numba", "python", "interpreter"]
FLOAT32, UINT16 = 7, 4


def theirs(name, /, **fields):
    return STORE.types[name](**fields)


def field(name, offset, datatype=FLOAT32, count=1):
    return theirs("sensor_msgs/msg/PointField", name=name, offset=offset, datatype=datatype, count=count)


FIELDS = [field("x", 2), field("y", 6), field("z", 12), field("ring", 0, UINT16)]


def cloud(points, *, big=False, padding=0, fields=FIELDS, **changed):
    """A message, and the coordinates as float32."""
    order = ">" if big else "<"
    kind = np.dtype(
        {"names": ["ring", "x", "y", "z"], "formats": [f"{order}u2", *[f"{order}f4"] * 3], "offsets": [0, 2, 6, 12], "itemsize": 19}
    )
    height, width, _ = points.shape
    rows = np.zeros((height, width), kind)
    rows["ring"] = 0xABCD
    for axis, name in enumerate("xyz"):
        rows[name] = points[:, :, axis]
    data = np.pad(rows.view(np.uint8).reshape(height, 19 * width), ((0, 0), (0, padding)), constant_values=0xFF)
    stamp = theirs("builtin_interfaces/msg/Time", sec=5, nanosec=6)
    made = {
        "header": theirs("std_msgs/msg/Header", seq=3, stamp=stamp, frame_id="lidar"),
        "height": height,
        "width": width,
        "fields": fields,
        "is_bigendian": big,
        "point_step": 19,
        "row_step": data.shape[1],
        "data": data.ravel(),
        "is_dense": True,
    }
    message = theirs("sensor_msgs/msg/PointCloud2", **{**made, **changed})
    return bytes(STORE.serialize_ros1(message, message.__msgtype__))


def programs(backend):
    return tuple(kind("ros1/point_cloud2.mapping", encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))


def random_points(height, width):
    points = np.random.default_rng(height).normal(size=(height, width, 3)).astype(np.float32)
    points[0, 0] = np.nan, np.inf, -0.0
    return points


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("big", [False, True], ids=["little", "big"])
@pytest.mark.parametrize("padding", [0, 5])
def test_points(big, padding, backend):
    decode, encode = programs(backend)
    points = random_points(3, 4)
    found = decode(cloud(points, big=big, padding=padding))
    held = np.array([[point.x, point.y, point.z] for point in found.points], np.float32)
    assert held.tobytes() == points.tobytes()
    back = STORE.deserialize_ros1(encode(found), "sensor_msgs/msg/PointCloud2")
    assert (back.height, back.width, back.point_step, back.row_step, back.is_bigendian, back.is_dense) == (1, 12, 12, 144, False, False)
    assert [(each.name, each.offset, each.datatype, each.count) for each in back.fields] == [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1)]
    assert bytes(back.data) == points.tobytes()
    assert [each.x for each in decode(encode(found)).points][1:] == [each.x for each in found.points][1:]


@pytest.mark.parametrize("backend", BACKENDS)
def test_clouds_without_points(backend):
    decode, encode = programs(backend)
    found = decode(cloud(np.zeros((0, 4, 3))))
    assert len(found.points) == 0
    assert len(decode(encode(found)).points) == 0


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("changed", "kind"),
    [
        ({"fields": FIELDS[:2]}, "rejected"),
        ({"fields": [*FIELDS[1:], FIELDS[0]]}, "rejected"),
        ({"fields": [field("x", 2, UINT16), *FIELDS[1:]]}, "rejected"),
        ({"fields": [field("x", 2, count=2), *FIELDS[1:]]}, "rejected"),
        ({"fields": [field("x", 2), field("y", 6), field("z", 16)]}, "index"),
        ({"fields": [field("x", (1 << 32) - 1), *FIELDS[1:]]}, "index"),
        ({"point_step": 20}, "rejected"),
        ({"row_step": 1 << 31}, "index"),
        ({"width": 5}, "rejected"),
        ({"data": np.zeros(0, np.uint8)}, "index"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_clouds_that_are_not_what_they_say(changed, kind, backend):
    decode, _ = programs(backend)
    with pytest.raises(rj.DecodeError) as error:
        decode(cloud(random_points(2, 4), **changed))
    assert error.value.kind == kind
