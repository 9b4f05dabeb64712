"""The shipped mappings between plain types of ROS 1 and RST: bytes of rosbags in, values by numpy, and the same bytes back."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj

pytest.importorskip("rosbags")

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS1_NOETIC)
BACKENDS = ["llvm", "python", "interpreter"]
XYZ = {"x": 1.5, "y": -2.25, "z": 1e-3}
NARROW = {name: float(np.float32(value)) for name, value in XYZ.items()}
TORQUES = {name: float(np.float32(100.0 * value)) for name, value in zip("abc", XYZ.values(), strict=True)}
TURN = {"x": 0.5, "y": -0.5, "z": 0.1, "w": 0.7}
ROTATION = {f"q{name}": value for name, value in TURN.items()}
POINTS = [NARROW, {"x": 0.0, "y": -0.0, "z": float("inf")}]
MATRIX = np.arange(12) * 1.5 - 4.0
WINDOW = {"x_offset": 4, "y_offset": 5, "height": 6, "width": 7}
BOX = {"top_left": {"x": 4, "y": 5}, "width": 7, "height": 6}
EFFORTS = [0.5, -3.0, 1e-3]


def theirs(name, /, **fields):
    package, _, short = name.partition("/")
    return STORE.types[f"{package}/msg/{short}"](**fields)


def raw(message):
    return bytes(STORE.serialize_ros1(message, message.__msgtype__))


def header(sec=5, frame="camera"):
    stamp = theirs("builtin_interfaces/Time", sec=sec, nanosec=0)
    return theirs("std_msgs/Header", seq=sec, stamp=stamp, frame_id=frame)


def numbers(name, values=XYZ):
    return theirs(f"geometry_msgs/{name}", **values)


def points():
    return [numbers("Point32", point) for point in POINTS]


def window(*, rectified=False, **fields):
    return theirs("sensor_msgs/RegionOfInterest", do_rectify=rectified, **{**WINDOW, **fields})


def camera(made=False):
    """Information of a camera, or that which is made of a matrix."""
    square = MATRIX.astype(np.float32).reshape(3, 4)[:, :3].ravel().astype(float)
    nothing = {"header": header(0, ""), "distortion_model": "", "D": np.zeros(0), "width": 0, "height": 0}
    measured = {"header": header(), "distortion_model": "plumb_bob", "D": np.ones(5), "width": 640, "height": 480}
    flat = dict.fromkeys(WINDOW, 0)
    return theirs(
        "sensor_msgs/CameraInfo",
        **(nothing if made else measured),
        K=square if made else np.arange(9.0),
        R=np.eye(3).ravel(),
        P=MATRIX,
        binning_x=0 if made else 2,
        binning_y=0,
        roi=window(**flat) if made else window(),
    )


def cloud(made=False):
    channels = [] if made else [theirs("sensor_msgs/ChannelFloat32", name="intensity", values=np.ones(2, np.float32))]
    return theirs("sensor_msgs/PointCloud", header=header(0, "") if made else header(), points=points(), channels=channels)


def joints(*, made=False, **fields):
    arrays = {name: np.array(fields.get(name, [] if made else [9.0])) for name in ("position", "velocity", "effort")}
    return theirs("sensor_msgs/JointState", header=header(0, "") if made else header(), name=fields.get("name", []), **arrays)


def trajectory(made=False):
    rest = {name: np.array([] if made else [1.0]) for name in ("velocities", "accelerations", "effort")}
    after = theirs("builtin_interfaces/Duration", sec=0 if made else 3, nanosec=0)
    return theirs("trajectory_msgs/JointTrajectoryPoint", positions=np.float32(EFFORTS).astype(float), time_from_start=after, **rest)


def twice(message):
    return message, message


ANGLES = {"angles": np.float32(EFFORTS).tolist()}
NAMED = [{"name": name, "value": value} for name, value in zip([b"a", b""], [0.5, -0.25], strict=True)]
CASES = {
    "point_translation": (XYZ, *twice(numbers("Point"))),
    "point_vec3d": (XYZ, *twice(numbers("Point"))),
    "point32_vec3d": (NARROW, *twice(numbers("Point32"))),
    "vector3_translation": (XYZ, *twice(numbers("Vector3"))),
    "vector3_vec3d": (XYZ, *twice(numbers("Vector3"))),
    "vector3_forces": (NARROW, numbers("Vector3"), numbers("Vector3", NARROW)),
    "rotation": (ROTATION, *twice(numbers("Quaternion", TURN))),
    "pose": (
        {"translation": XYZ, "rotation": ROTATION},
        *twice(theirs("geometry_msgs/Pose", position=numbers("Point"), orientation=numbers("Quaternion", TURN))),
    ),
    "transform": (
        {"translation": XYZ, "rotation": ROTATION},
        *twice(theirs("geometry_msgs/Transform", translation=numbers("Vector3"), rotation=numbers("Quaternion", TURN))),
    ),
    "polygon": ({"points": POINTS}, *twice(theirs("geometry_msgs/Polygon", points=points()))),
    "point_cloud": ({"points": POINTS}, cloud(), cloud(made=True)),
    "camera_matrix": (
        {f"c{row + 1}{column + 1}": MATRIX[4 * row + column] for row in range(3) for column in range(4)},
        camera(),
        camera(made=True),
    ),
    "region_of_interest": (BOX, window(rectified=True), window()),
    "joint_positions": (
        {"joints": NAMED},
        joints(name=["a", ""], position=[0.5, -0.25]),
        joints(made=True, name=["a", ""], position=[0.5, -0.25]),
    ),
    "joint_angles": (
        {"angles": [0.5, -0.25, 8.0]},
        joints(name=["torso_roll", "neck", "torso_pitch", "torso_yaw"], position=[-0.25, 1.0, 8.0, 0.5], velocity=[1.0]),
        joints(made=True, name=["torso_yaw", "torso_roll", "torso_pitch"], position=[0.5, -0.25, 8.0]),
    ),
    "joint_torques": (ANGLES, joints(effort=EFFORTS), joints(made=True, effort=np.float32(EFFORTS).astype(float))),
    "trajectory_point": (ANGLES, trajectory(), trajectory(made=True)),
    "meta_data": ({"key": "k", "value": "é"}, *twice(theirs("diagnostic_msgs/KeyValue", key="k", value="é"))),
}
"""What is held, the message that it is read from, and the message that is written of it."""


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CASES)
def test_values_and_back(name, backend):
    held, message, back = CASES[name]
    decode, encode = (kind(f"ros1/{name}.mapping", encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))
    found = decode(raw(message))
    assert found.to_dict() == held
    assert encode(found) == raw(back)
    assert encode(encode.holder_type.from_dict(held)) == raw(back)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ["vector3_torques", "wrench"])
def test_torques_are_in_newton_centimetres(name, backend):
    decode, encode = (kind(f"ros1/{name}.mapping", encoding="ros1", backend=backend) for kind in (rj.Decoder, rj.Encoder))
    vector = numbers("Vector3")
    message = vector if name == "vector3_torques" else theirs("geometry_msgs/Wrench", force=vector, torque=vector)
    held = TORQUES if name == "vector3_torques" else {"forces": NARROW, "torques": TORQUES}
    found = decode(raw(message))
    assert found.to_dict() == held
    back = STORE.deserialize_ros1(encode(found), message.__msgtype__)
    torque = back if name == "vector3_torques" else back.torque
    assert [torque.x, torque.y, torque.z] == pytest.approx(list(XYZ.values()), rel=1e-7)


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_one_of_them_cannot_say_is_refused(backend):
    def program(kind, name):
        return kind(f"ros1/{name}.mapping", encoding="ros1", backend=backend)

    for name, message in (("joint_torques", joints(effort=[])), ("region_of_interest", window(x_offset=1 << 31))):
        with pytest.raises(rj.DecodeError) as error:
            program(rj.Decoder, name)(raw(message))
        assert error.value.kind in {"rejected", "range"}
    unknown = dict.fromkeys(ROTATION, 0.0)
    for name, held in (
        ("rotation", unknown),
        ("pose", {"translation": XYZ, "rotation": unknown}),
        ("transform", {"translation": XYZ, "rotation": unknown}),
        ("region_of_interest", {**BOX, "top_left": {"x": -1, "y": 0}}),
    ):
        encode = program(rj.Encoder, name)
        with pytest.raises(rj.EncodeError) as error:
            encode(encode.holder_type.from_dict(held))
        assert error.value.kind in {"rejected", "range"}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("name", "parameters", "wanted"),  # as PROJ computes them
    [
        ("nav_sat_fix", {"origin": [52.0, 8.5, 100.0]}, [1373.2821437, 1112.8860393, 29.7553353]),
        ("nav_sat_fix_utm", {"zone": 32}, [467055.1744721, 5762259.2026191, 130.0]),
    ],
)
def test_places_from_a_satellite_receiver(name, parameters, wanted, backend):
    options = {"encoding": "ros1", "backend": backend, "parameters": parameters}
    decode, encode = rj.Decoder(f"ros1/{name}.mapping", **options), rj.Encoder(f"ros1/{name}.mapping", **options)

    def fix(status=0, **place):
        state = theirs("sensor_msgs/NavSatStatus", status=status, service=1)
        covariance = {"position_covariance": np.eye(3).ravel(), "position_covariance_type": 2}
        return theirs("sensor_msgs/NavSatFix", header=header(), status=state, **place, **covariance)

    place = {"latitude": 52.01, "longitude": 8.52, "altitude": 130.0}
    found = decode(raw(fix(**place)))
    assert [found.x, found.y, found.z] == pytest.approx(wanted, abs=2e-7)
    back = STORE.deserialize_ros1(encode(found), "sensor_msgs/msg/NavSatFix")
    assert {name: getattr(back, name) for name in place} == pytest.approx(place, abs=1e-9)
    with pytest.raises(rj.DecodeError) as error:
        decode(raw(fix(status=-1, **place)))
    assert error.value.kind == "rejected"
    if "zone" in parameters:
        with pytest.raises(rj.DecodeError) as far:
            decode(raw(fix(**place | {"latitude": 5.0, "longitude": 90.0})))
        assert far.value.kind == "rejected"
        assert "far from zone 32" in str(far.value)
