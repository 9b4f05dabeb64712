"""Functions of several values: what they compute, what undoes them, and what may stand for a group of numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rosetta_jit as rj
from rosetta_jit.language.groups import group_functions
from rosetta_jit.language.resolve.definitions import definitions_of
from tests.language.pairs import BACKENDS, Later, codes, files, pair

XYZW = '(:bottle ("x" :double) ("y" :double) ("z" :double) ("w" :double))'
XYZ = '(:bottle ("x" :double) ("y" :double) ("z" :double))'
ANGLES = "required double roll = 1; required double pitch = 2; required double yaw = 3;"
POINT = "message P { required double x = 1; required double y = 2; required double z = 3; }"
TURN = "message Q { required double x = 1; required double y = 2; required double z = 3; required double w = 4; }"
NINE = "(:list :double (:length 9))"

angles = st.floats(-math.pi, math.pi)
metres = st.floats(-1e4, 1e4)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(each * each for each in q) > 0.01)


def rotation(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """The matrix of three rotations about fixed axes, multiplied one by one."""
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    about_x, about_y = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]]), np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    return np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ about_y @ about_x


def matrix_of(q: list[float]) -> np.ndarray:
    """The matrix of a quaternion of length 1, by what it does to the axes: q e q*."""
    vector, w = np.array(q[:3]), q[3]
    turned = [2 * np.dot(vector, e) * vector + (w * w - vector @ vector) * e + 2 * w * np.cross(vector, e) for e in np.eye(3)]
    return np.array(turned).T


def unit(q: tuple[float, ...]) -> list[float]:
    length = math.sqrt(sum(each * each for each in q))
    return [each / length for each in q]


def one_way(wire, holder, rules):
    texts = files(wire, holder, rules)
    options = {"schema": texts, "encoding": "yarp3", "backend": "interpreter"}
    write = rj.Encoder.of("wire", imports=["wire.bottle-schema"], **options)
    decode = rj.Decoder("m.mapping", **options)

    class OneWay:
        def unpack(self, **values):
            return decode(write(write.holder_type.from_dict(values))).to_dict()

    return OneWay()


def named(values):
    return dict(zip("xyzw", values, strict=False))


def test_definitions_have_types_and_define_each_component():
    for function in group_functions().values():
        defined = {name for name, _ in definitions_of(function.name)}
        assert {each.names[0] for each in function.gives.components} <= defined
        assert len(function.inverses) == len(function.parameters)


# --- rotations -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
def test_angles_and_quaternions(backend):
    both = pair(f'("q" {XYZW})', ANGLES, "rules:\n  .roll, .pitch, .yaw <-> euler(.q)\n", backend)
    for roll, pitch, yaw in ((0.1, -0.2, 0.3), (3.0, 1.5, -3.0), (0.0, 0.0, math.pi), (-1.0, -1.57, 2.0)):
        q = both.pack(roll=roll, pitch=pitch, yaw=yaw)["q"]
        assert np.allclose(matrix_of(list(q.values())), rotation(roll, pitch, yaw), atol=1e-14)
        assert np.allclose(list(both.unpack(q=q).values()), [roll, pitch, yaw], atol=1e-9)


ROTATIONS = Later(pair, f'("q" {XYZW})', ANGLES, "rules:\n  .roll, .pitch, .yaw <-> euler(.q)\n")


@settings(deadline=None)
@given(quaternions, st.floats(0.5, 4))
def test_angles_of_any_quaternion_turn_as_it_does(parts, length):
    q = unit(parts)
    found = ROTATIONS.unpack(q=dict(zip("xyzw", [length * each for each in q], strict=True)))
    assert np.allclose(rotation(**found), matrix_of(q), atol=2e-9)
    assert abs(found["pitch"]) <= math.pi / 2
    assert max(abs(found["roll"]), abs(found["yaw"])) <= math.pi


@settings(deadline=None)
@given(angles, st.floats(-math.pi / 2, math.pi / 2), angles)
def test_angles_come_back_where_the_pitch_is_no_right_angle(roll, pitch, yaw):
    found = ROTATIONS.unpack(**ROTATIONS.pack(roll=roll, pitch=pitch, yaw=yaw))
    assert np.allclose(rotation(**found), rotation(roll, pitch, yaw), atol=2e-9)
    if abs(pitch) < 1.5:
        away = np.array([found["roll"] - roll, found["pitch"] - pitch, found["yaw"] - yaw])
        assert np.allclose(np.abs(np.sin(away / 2)), 0, atol=1e-12)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_where_the_pitch_is_a_right_angle_all_counts_as_yaw(pitch):
    found = ROTATIONS.unpack(**ROTATIONS.pack(roll=0.3, pitch=pitch, yaw=0.5))
    assert found["roll"] == 0.0
    assert np.allclose([found["pitch"], found["yaw"]], [pitch, 0.5 - math.copysign(0.3, pitch)])


def test_four_zeros_turn_nothing():
    assert list(ROTATIONS.unpack(q=dict.fromkeys("xyzw", 0.0)).values()) == [0.0, 0.0, 0.0]


MATRICES = Later(
    pair,
    f'("m" {NINE})',
    "required double x = 1; required double y = 2; required double z = 3; required double w = 4;",
    "rules:\n  .x, .y, .z, .w <-> quaternion_of_matrix(.m)\n",
)


@settings(deadline=None)
@given(quaternions)
def test_matrices_and_quaternions(parts):
    q = unit(parts)
    matrix = MATRICES.pack(**dict(zip("xyzw", q, strict=True)))["m"]
    assert np.allclose(np.reshape(matrix, (3, 3)), matrix_of(q), atol=1e-14)
    found = list(MATRICES.unpack(m=matrix).values())
    assert np.allclose(found, q, atol=1e-14) or np.allclose(found, [-each for each in q], atol=1e-14)


TURNS = Later(
    one_way,
    f'("a" {XYZW}) ("b" {XYZW}) ("v" {XYZ})',
    f"required Q both = 1; required Q back = 2; required P v = 3; }} {TURN} {POINT} message Z {{",
    """unpack-rules:
  .both = compose_rotations(.a, .b)
  .back = invert_rotation(.a)
  .v = rotate_vector(.a, rotate_vector(.b, .v))
""",
)


@settings(deadline=None)
@given(quaternions, quaternions, st.tuples(metres, metres, metres))
def test_rotations_of_vectors_and_of_rotations(first, second, vector):
    a, b = unit(first), unit(second)
    found = TURNS.unpack(a=named(a), b=named(b), v=named(vector))
    assert np.allclose(matrix_of(list(found["both"].values())), matrix_of(a) @ matrix_of(b), atol=1e-13)
    assert np.allclose(matrix_of(list(found["back"].values())), matrix_of(a).T, atol=1e-13)
    assert np.allclose(list(found["v"].values()), matrix_of(a) @ matrix_of(b) @ vector, rtol=1e-11, atol=1e-8)


# --- poses -----------------------------------------------------------------------------------------------------------------

POSE = f'(:bottle ("position" {XYZ}) ("orientation" {XYZW}))'
RST_POSE = """message T { required double x = 1; required double y = 2; required double z = 3; }
message R { required double qw = 1; required double qx = 2; required double qy = 3; required double qz = 4; }
message Pose { required T translation = 1; required R rotation = 2; }"""
MOUNT = "[0.1, -0.2, 0.3, 0.5, 0.5, -0.5, 0.5]"


def pose(position, q):
    return {"position": named(position), "orientation": named(q)}


@pytest.mark.parametrize("backend", [*BACKENDS, "llvm"])
def test_poses_move_between_frames(backend):
    rules = f"rules:\n  .p <-> compose_poses({MOUNT}, .p)\n"
    both = pair(f'("p" {POSE})', f"required Pose p = 1; }} {RST_POSE} message Z {{", rules, backend)
    q = unit((0.1, -0.2, 0.4, 0.8))
    found = both.unpack(p=pose([1.0, 2.0, 3.0], q))["p"]
    mount = matrix_of([0.5, 0.5, -0.5, 0.5])
    assert np.allclose(list(found["translation"].values()), mount @ [1.0, 2.0, 3.0] + [0.1, -0.2, 0.3], atol=1e-14)
    turned = [found["rotation"][each] for each in ("qx", "qy", "qz", "qw")]
    assert np.allclose(matrix_of(turned), mount @ matrix_of(q), atol=1e-14)
    back = both.pack(p=found)["p"]
    assert np.allclose([*back["position"].values(), *back["orientation"].values()], [1.0, 2.0, 3.0, *q], atol=1e-14)


def test_a_pose_after_a_fixed_one_and_its_inverse():
    rules = f"rules:\n  .p <-> invert_pose(compose_poses(.p, {MOUNT}))\n"
    both = pair(f'("p" {POSE})', f"required Pose p = 1; }} {RST_POSE} message Z {{", rules)
    q = unit((0.3, 0.2, -0.4, 0.7))
    back = both.pack(**both.unpack(p=pose([1.0, 2.0, 3.0], q)))["p"]
    assert np.allclose([*back["position"].values(), *back["orientation"].values()], [1.0, 2.0, 3.0, *q], atol=1e-14)


def test_a_pose_of_parts_that_stand_apart():
    rules = "rules:\n  .p <-> pose(.at, .q)\n"
    both = pair(f'("at" {XYZ}) ("q" {XYZW})', f"required Pose p = 1; }} {RST_POSE} message Z {{", rules)
    values = {"at": named([1.0, 2.0, 3.0]), "q": named([0.0, 0.6, 0.0, 0.8])}
    assert both.pack(**both.unpack(**values)) == values


def test_each_point_of_an_array():
    rules = f"rules:\n  .points[] <-> transform_point({MOUNT}, .points[])\n"
    both = pair(f'("points" (:list {XYZ}))', f"repeated P points = 1; }} {POINT} message Z {{", rules)
    points = np.arange(12.0).reshape(4, 3)
    found = both.unpack(points=[named(each) for each in points])["points"]
    wanted = points @ matrix_of([0.5, 0.5, -0.5, 0.5]).T + [0.1, -0.2, 0.3]
    assert np.allclose([list(each.values()) for each in found], wanted, atol=1e-14)
    back = both.pack(points=found)["points"]
    assert np.allclose([list(each.values()) for each in back], points, atol=1e-13)


# --- places on the Earth ---------------------------------------------------------------------------------------------------

FIX = '("lat" :double) ("lon" :double) ("alt" :double)'
LOCAL = Later(
    pair,
    FIX,
    "required double east = 1; required double north = 2; required double up = 3;",
    "rules:\n  .east, .north, .up <-> enu([.lat, .lon, .alt], [52.0, 8.5, 100.0])\n",
)


@pytest.mark.parametrize(
    ("place", "wanted"),
    [
        ((52.0, 8.5, 100.0), (0.0, 0.0, 0.0)),
        ((52.0, 8.5, 250.0), (0.0, 0.0, 150.0)),
        ((52.01, 8.52, 130.0), (1373.2821437, 1112.8860393, 29.7553353)),
        ((-33.9, 151.2, 20.0), (3211417.0796809, 1164933.5967682, -11747737.3802798)),
        ((89.9, -170.0, 5000.0), (-292.6090383, 3946243.1435175, -1358724.4309743)),
    ],
)
def test_east_north_and_up(place, wanted):
    """The last three as PROJ computes them: `+proj=cart +ellps=WGS84`, then `+proj=topocentric`."""
    assert np.allclose(list(LOCAL.unpack(**dict(zip(("lat", "lon", "alt"), place, strict=True))).values()), wanted, rtol=0, atol=2e-7)


@settings(deadline=None)
@given(st.floats(-89.9, 89.9), st.floats(-179.9, 179.9), st.floats(-1e4, 1e6))
def test_places_come_back(lat, lon, alt):
    back = LOCAL.pack(**LOCAL.unpack(lat=lat, lon=lon, alt=alt))
    assert abs(back["lat"] - lat) < 1e-10
    assert abs(back["lon"] - lon) < 1e-10 / math.cos(math.radians(lat))
    assert abs(back["alt"] - alt) < 1e-6


FROM = Later(
    one_way,
    f'{FIX} ("origin" :double)',
    "required double east = 1; required double north = 2; required double up = 3;",
    "unpack-rules:\n  .east, .north, .up = enu([.lat, .lon, .alt], [.origin, 8.5, 100.0])\n",
)


@pytest.mark.parametrize("lat", [90.0000001, -91.0, 450.0, math.inf, math.nan])
def test_beyond_the_poles_there_is_no_place(lat):
    assert all(map(math.isnan, LOCAL.unpack(lat=lat, lon=8.5, alt=100.0).values()))
    assert all(map(math.isnan, FROM.unpack(lat=1.0, lon=8.5, alt=100.0, origin=lat).values()))


@pytest.mark.parametrize("lat", [90.0, -90.0])
def test_the_poles_are_places(lat):
    back = LOCAL.pack(**LOCAL.unpack(lat=lat, lon=8.5, alt=100.0))
    assert (back["lat"], back["alt"]) == pytest.approx((lat, 100.0), abs=1e-6)


UTM = {
    zone: Later(
        pair,
        '("lat" :double) ("lon" :double)',
        "required double x = 1; required double y = 2;",
        f"rules:\n  .x, .y <-> utm([.lat, .lon], {zone})\n",
        "llvm",
    )
    for zone in (32, -60)
}
GRID = [
    (32, (52.0, 8.5), (465674.8325450392, 5761156.235698992)),
    (32, (60.0, 5.0), (276979.92640100635, 6658157.202407252)),
    (-60, (-33.9, 178.2), (610950.1770188404, 6248283.651076244)),
    (32, (0.0, 9.0), (500000.0, 0.0)),
    (32, (84.0, 14.9), (568734.617344993, 9331616.57901011)),
    (32, (-45.0, 6.0), (263553.9738987921, -4987329.504698914)),
]


@pytest.mark.parametrize(("zone", "place", "wanted"), GRID)
def test_zones_of_utm(zone, place, wanted):
    """As PROJ 9.5 computes them: `+proj=utm +ellps=WGS84`, with `+south` in zone -60."""
    found = UTM[zone].unpack(lat=place[0], lon=place[1])
    assert np.allclose(list(found.values()), wanted, rtol=0, atol=5e-8)
    assert np.allclose(list(UTM[zone].pack(**found).values()), place, rtol=0, atol=1e-12)


@settings(deadline=None)
@given(st.floats(-89.9, 89.9), st.floats(-30, 30))
def test_places_come_back_from_their_zone(lat, away):
    lon = (177 + away + 180) % 360 - 180
    back = UTM[-60].pack(**UTM[-60].unpack(lat=lat, lon=lon))
    assert abs(back["lat"] - lat) < 1e-12
    assert abs((back["lon"] - lon + 180) % 360 - 180) < 1e-12 / math.cos(math.radians(lat))


def test_poles_are_in_all_zones_and_longitudes_turn_round():
    at_pole = UTM[32].unpack(lat=90.0, lon=77.0)
    assert np.allclose(list(at_pole.values()), [500000.0, 9997964.943], rtol=0, atol=1e-3)
    assert UTM[32].pack(**at_pole)["lat"] == pytest.approx(90.0, abs=1e-12)
    assert UTM[-60].unpack(lat=10.0, lon=-179.0)["x"] == pytest.approx(UTM[-60].unpack(lat=10.0, lon=181.0)["x"], abs=1e-8)
    assert UTM[-60].pack(x=1.1e6, y=1e7)["lon"] < -170


ZONED = Later(
    pair,
    '("lat" :double (:unit :radian)) ("lon" :double (:unit :degree)) ("zone" :int)',
    "required double east = 1; required double north = 2;",
    "unpack-rules:\n  .east, .north = utm([.lat, .lon], .zone)\n"
    "pack-rules:\n  .lat, .lon = geodetic_of_utm([.east, .north], zone)\n  .zone = zone\n",
    head="parameter zone: int64 = 32\n",
)


@pytest.mark.parametrize(
    ("lat", "lon", "zone"),
    [(50.0, 9.0, 61), (50.0, 9.0, 0), (0.0, 60.0, 32), (math.nan, 9.0, 32), (50.0, math.inf, 32), (91.0, 9.0, 32), (-1e9, 9.0, 32)],
)
def test_far_from_a_zone_there_is_no_number(lat, lon, zone):
    found = ZONED.unpack(lat=math.radians(lat), lon=lon, zone=zone)
    assert all(map(math.isnan, found.values()))


def test_a_zone_is_a_field_or_a_parameter():
    place, grid = GRID[0][1:]
    values = {"lat": math.radians(place[0]), "lon": place[1], "zone": 32}
    found = ZONED.unpack(**values)
    assert np.allclose(list(found.values()), grid, rtol=0, atol=5e-8)
    assert ZONED.pack(**found) == pytest.approx(values, abs=1e-13)
    assert all(math.isnan(value) for name, value in ZONED.pack(east=7e6, north=0.0).items() if name != "zone")


# --- what stands for a group -------------------------------------------------------------------------------------------------


def test_one_angle_of_three():
    both = pair('("yaw" :double)', f"required Q q = 1; }} {TURN} message Z {{", "rules:\n  .q <-> quaternion(0.0, 0.0, .yaw)\n")
    assert np.isclose(both.pack(**both.unpack(yaw=0.75))["yaw"], 0.75)


def test_angles_are_converted_to_the_units_of_fields():
    wire = '("roll" :double (:unit :degree)) ("pitch" :double (:unit :degree)) ("yaw" :double (:unit :degree))'
    both = pair(wire, f"required Q q = 1; }} {TURN} message Z {{", "rules:\n  .q <-> quaternion(.roll, .pitch, .yaw)\n")
    found = both.unpack(roll=90.0, pitch=0.0, yaw=0.0)["q"]
    assert np.allclose(list(found.values()), [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)])
    assert np.allclose(list(both.pack(q=found).values()), [90.0, 0.0, 0.0])


def test_what_is_in_metres_is_no_angle():
    assert codes(
        '("roll" :double (:unit :m)) ("pitch" :double) ("yaw" :double)',
        f"required Q q = 1; }} {TURN} message Z {{",
        "unpack-rules:\n  .q = quaternion(.roll, .pitch, .yaw)\n",
    ) == ["unit"]


def test_arrays_of_any_length_are_asked_for_theirs():
    both = pair('("m" (:list :double))', f"required Q q = 1; }} {TURN} message Z {{", "rules:\n  .q <-> quaternion_of_matrix(.m)\n")
    assert both.unpack(m=[1.0, 0, 0, 0, 1, 0, 0, 0, 1])["q"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    assert both.pack(q=named([0.0, 0.0, 0.0, 2.0]))["m"] == [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
    with pytest.raises(rj.DecodeError) as error:
        both.unpack(m=[1.0] * 8)
    assert (error.value.kind, "takes 9 elements" in str(error.value)) == ("rejected", True)


def test_components_become_float32_by_a_word():
    holder = "required float roll = 1; required float pitch = 2; required float yaw = 3;"
    rules = "rules:\n  .roll, .pitch, .yaw <-> float32(euler(.q))\n"
    both = pair(f'("q" {XYZW})', holder, rules)
    assert both.unpack(**both.pack(roll=0.5, pitch=0.25, yaw=-0.125)) == {"roll": 0.5, "pitch": 0.25, "yaw": -0.125}
    assert codes(f'("q" {XYZW})', holder, rules.replace("float32", "")) == ["lossy-conversion"]


def test_one_group_or_another():
    rules = "unpack-rules:\n  .roll, .pitch, .yaw = euler(.q if .q.w >= 0 else [0.0, 0.0, 0.0, 1.0])\n"
    found = one_way(f'("q" {XYZW})', ANGLES, rules)
    assert list(found.unpack(q=named([0.0, 0.0, 1.0, -1.0])).values()) == [0.0, 0.0, 0.0]
    assert np.allclose(list(found.unpack(q=named([0.0, 0.0, 1.0, 1.0])).values()), [0.0, 0.0, math.pi / 2])


def test_one_number_of_a_group():
    found = one_way(f'("q" {XYZW})', "required double yaw = 1;", "unpack-rules:\n  .yaw = 2 * euler(.q).yaw\n")
    assert math.isclose(found.unpack(q=named([0.0, 0.0, 1.0, 1.0]))["yaw"], math.pi)


def test_a_parameter_that_is_a_group():
    texts = files(f'("v" {XYZ})', f"required P v = 1; }} {POINT} message Z {{", "rules:\n  .v <-> transform_point(mount, .v)\n")
    texts["m.mapping"] = "parameter mount: list of float64\n" + texts["m.mapping"]
    options = {"schema": texts, "encoding": "yarp3", "backend": "interpreter"}
    encode = rj.Encoder("m.mapping", parameters={"mount": [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]}, **options)
    decode = rj.Decoder("m.mapping", parameters={"mount": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]}, **options)
    assert decode(encode(encode.holder_type.from_dict({"v": named([5.0, 5.0, 5.0])}))).to_dict() == {"v": named([4.0, 3.0, 2.0])}
    with pytest.raises(rj.MappingError) as error:
        rj.Decoder("m.mapping", parameters={"mount": [1.0, 2.0]}, **options)
    assert [each.code for each in error.value.diagnostics] == ["group-size"]


def test_several_places_and_a_list():
    found = pair('("a" :double) ("b" :double)', "required double x = 1; required double y = 2;", "rules:\n  .x, .y <-> [.b, .a + 1.0]\n")
    assert found.unpack(a=1.0, b=5.0) == {"x": 5.0, "y": 2.0}
    assert found.pack(x=5.0, y=2.0) == {"a": 1.0, "b": 5.0}


def test_what_cannot_be_turned_round():
    wire = f'("p" {POSE}) ("v" {XYZ})'
    holder = f"required P v = 1; }} {POINT} message Z {{"
    assert codes(wire, holder, "rules:\n  .v <-> transform_point(.p, .v)\n") == ["several-fields"]
    assert codes(f'("q" {XYZW})', "required double x = 1;", "rules:\n  .x <-> euler(.q).yaw\n") == ["no-inverse"]
    assert codes(wire, holder, "rules:\n  .v <-> transform_point(.p, [1.0, 0.0, 0.0])\n  ignore .v\n") == ["no-inverse"]


def test_laws_name_what_does_not_come_back():
    laws = ROTATIONS.decode.mapping.laws
    assert {loss.place for loss in laws.messages.losses} == {".q.x", ".q.y", ".q.z", ".q.w"}
    assert all("negative" in loss.why for loss in laws.messages.losses)
    assert all("half a turn" in loss.why for loss in laws.holders.losses)


def test_integers_are_the_nearest_ones():
    rules = "rules:\n  .q <-> quaternion(0.0, radians(.pitch * 0.01), radians(.yaw * 0.01))\n"
    both = pair('("pitch" :int) ("yaw" :int)', f"required Q q = 1; }} {TURN} message Z {{", rules)
    for pitch, yaw in ((8999, -17999), (-1, 1), (1234, 5678)):
        assert both.pack(**both.unpack(pitch=pitch, yaw=yaw)) == {"pitch": pitch, "yaw": yaw}


def test_a_misspelt_function_of_several_values_is_all_that_is_told():
    files = {
        "lab/msg/Q.msg": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
        "lab/msg/A.msg": "Q q\n",
        "r.proto": 'syntax = "proto2"; message R { required double roll = 1; required double pitch = 2; required double yaw = 3; }',
        "r.mapping": 'import "lab/msg/A.msg"\nimport "r.proto"\ndata-holder: R\nwire-schema: lab/msg/A\nunpack-rules:\n'
        "  .roll, .pitch, .yaw = eulr(.q)\n",
    }
    with pytest.raises(rj.MappingError, match="did you mean `euler`") as raised:
        rj.Decoder("r.mapping", schema=files)
    assert [each.code for each in raised.value.diagnostics] == ["no-group"]
