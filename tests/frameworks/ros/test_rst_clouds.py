"""Clouds of points of ROS 1 as RST's: fields between others, padded rows, either byte order, against numpy."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS1_NOETIC)
BACKENDS = ["llvm", "python", "interpreter"]
FLOAT32, FLOAT64, UINT16 = 7, 8, 4


def theirs(name, /, **fields):
    return STORE.types[name](**fields)


def field(name, offset, datatype=FLOAT32, count=1):
    return theirs("sensor_msgs/msg/PointField", name=name, offset=offset, datatype=datatype, count=count)


FIELDS = [field("x", 2), field("y", 6), field("z", 12), field("ring", 0, UINT16)]


def cloud(points, *, big=False, padding=0, fields=FIELDS, layout=FIELDS, kind="f4", size=19, **changed):
    """A message whose points lie as a layout says, and its fields tell."""
    order = ">" if big else "<"
    kind = np.dtype(
        {
            "names": [each.name for each in layout],
            "formats": [f"{order}u2" if each.name == "ring" else f"{order}{kind}" for each in layout],
            "offsets": [each.offset for each in layout],
            "itemsize": size,
        }
    )
    height, width, _ = points.shape
    rows = np.zeros((height, width), kind)
    if "ring" in kind.fields:
        rows["ring"] = 0xABCD
    for axis, name in enumerate("xyz"):
        rows[name] = points[:, :, axis]
    data = np.pad(rows.view(np.uint8).reshape(height, size * width), ((0, 0), (0, padding)), constant_values=0xFF)
    stamp = theirs("builtin_interfaces/msg/Time", sec=5, nanosec=6)
    made = {
        "header": theirs("std_msgs/msg/Header", seq=3, stamp=stamp, frame_id="lidar"),
        "height": height,
        "width": width,
        "fields": fields,
        "is_bigendian": big,
        "point_step": size,
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


ORDERS = {
    "colours first": ([field("rgb", 0), field("intensity", 4), field("z", 8), field("y", 12), field("x", 16)], "f4", 24),
    "doubles": ([field("z", 0, FLOAT64), field("ring", 8, UINT16), field("x", 10, FLOAT64), field("y", 18, FLOAT64)], "f8", 26),
}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("big", [False, True], ids=["little", "big"])
@pytest.mark.parametrize("order", ORDERS)
def test_fields_in_any_order(order, big, backend):
    fields, kind, size = ORDERS[order]
    decode, _ = programs(backend)
    points = random_points(2, 3)
    found = decode(cloud(points, big=big, fields=fields, layout=fields, kind=kind, size=size))
    held = np.array([[point.x, point.y, point.z] for point in found.points], np.float32)
    assert np.array_equal(held, points.reshape(-1, 3), equal_nan=True)


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
        ({"fields": [*FIELDS[:2], FIELDS[3]]}, "rejected"),
        ({"fields": [*FIELDS, FIELDS[1]]}, "index"),
        ({"fields": [field("x", 2, FLOAT64), *FIELDS[1:]]}, "rejected"),
        ({"fields": [field("x", 2, UINT16), *FIELDS[1:]]}, "rejected"),
        ({"fields": [field("x", 2, count=2), *FIELDS[1:]]}, "rejected"),
        ({"fields": [field("x", 2), field("y", 6), field("z", 16)]}, "index"),
        ({"fields": [field("x", (1 << 32) - 1), *FIELDS[1:]]}, "index"),
        ({"point_step": 20}, "rejected"),
        ({"row_step": 1 << 31}, "index"),
        ({"width": 5}, "rejected"),
        ({"data": np.zeros(0, np.uint8)}, "rejected"),
        ({"point_step": 0}, "rejected"),
        ({"point_step": 0, "row_step": 0, "width": 1 << 20}, "rejected"),
        ({"width": 0, "row_step": 0, "height": (1 << 32) - 1}, "rejected"),
        ({"width": 0, "height": (1 << 32) - 1}, "rejected"),
        ({"point_step": 1, "row_step": 1 << 20, "width": 1 << 20}, "count"),
    ],
    ids=lambda value: str(value)[:20],
)
def test_clouds_that_are_not_what_they_say(changed, kind, backend):
    decode, _ = programs(backend)
    with pytest.raises(rj.DecodeError) as error:
        decode(cloud(random_points(2, 4), **changed))
    assert error.value.kind == kind
