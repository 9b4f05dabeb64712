"""Functions of several values, against loops of numba's that a person wrote for the same numbers."""

from __future__ import annotations

import math

import numba
import numpy as np
import pytest

import rosetta_jit as rj
from bench.contest import Contender
from bench.messages import anew
from rosetta_jit.functions.geodesy import ECCENTRICITY
from rosetta_jit.functions.utm import BACKWARD, FORWARD, SCALE, THIRD

CHAPTER = "Rotations and points"
OURS, BY_HAND = "rosetta_jit", "numba, by hand"
AT_MOST = 1.2
COUNT = 10_000
MOUNT = (0.1, 0.2, 0.3, 0.5, 0.5, -0.5, 0.5)
KRUEGER = {
    way: np.array([sum(each * THIRD ** (row + power) for power, each in enumerate(terms)) for row, terms in enumerate(table, 1)])
    for way, table in (("there", FORWARD), ("back", BACKWARD))
}
FILES = {
    "lab/msg/Fix.msg": "float64 latitude\nfloat64 longitude\n",
    "lab/msg/Grid.msg": "float64 easting\nfloat64 northing\n",
    "lab/msg/Way.msg": "Fix[] points\n",
    "lab/msg/Plan.msg": "Grid[] points\n",
    "places.mapping": """import "lab/msg/Way.msg"
import "lab/msg/Plan.msg"
data-holder: lab/msg/Plan
wire-schema: lab/msg/Way
rules:
  .points[] <-> utm(.points[], 32)
""",
    "lab/msg/Quaternion.msg": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "lab/msg/Point.msg": "float64 x\nfloat64 y\nfloat64 z\n",
    "lab/msg/Angles.msg": "float64 roll\nfloat64 pitch\nfloat64 yaw\n",
    "lab/msg/Seen.msg": "Quaternion[] turns\nPoint[] points\n",
    "lab/msg/Held.msg": "Angles[] turns\nPoint[] points\n",
    "turns.mapping": """import "lab/msg/Seen.msg"
import "lab/msg/Held.msg"
data-holder: lab/msg/Held
wire-schema: lab/msg/Seen
rules:
  .turns[] <-> euler(.turns[])
  ignore .points
  default .points
""",
    "points.mapping": """import "lab/msg/Seen.msg"
import "lab/msg/Held.msg"
parameter mount: list of float64
data-holder: lab/msg/Held
wire-schema: lab/msg/Seen
rules:
  .points[] <-> transform_point(mount, .points[])
  ignore .turns
  default .turns
""",
}


@numba.njit
def angles_of(turns, angles):
    for i in range(turns.shape[0]):
        x, y, z, w = turns[i, 0], turns[i, 1], turns[i, 2], turns[i, 3]
        n = x * x + y * y + z * z + w * w
        forward, left = n - 2 * (y * y + z * z), 2 * (x * y + w * z)
        level = math.sqrt(forward * forward + left * left)
        angles[i, 1] = math.atan2(2 * (w * y - z * x), level)
        if level <= 1e-10 * n:
            angles[i, 0], angles[i, 2] = 0.0, math.atan2(2 * w * z, w * w - z * z)
        else:
            angles[i, 0], angles[i, 2] = math.atan2(2 * (w * x + y * z), n - 2 * (x * x + y * y)), math.atan2(left, forward)


@numba.njit
def turns_of(angles, turns):
    for i in range(angles.shape[0]):
        sr, cr = math.sin(angles[i, 0] / 2), math.cos(angles[i, 0] / 2)
        sp, cp = math.sin(angles[i, 1] / 2), math.cos(angles[i, 1] / 2)
        sy, cy = math.sin(angles[i, 2] / 2), math.cos(angles[i, 2] / 2)
        turns[i, 0], turns[i, 1] = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy
        turns[i, 2], turns[i, 3] = cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy


@numba.njit
def moved(mount, points, out):
    x, y, z, w = mount[3], mount[4], mount[5], mount[6]
    double = 2 / (x * x + y * y + z * z + w * w)
    for i in range(points.shape[0]):
        a, b, c = points[i, 0], points[i, 1], points[i, 2]
        p, q, r = double * (y * c - z * b), double * (z * a - x * c), double * (x * b - y * a)
        out[i, 0] = mount[0] + a + w * p + y * r - z * q
        out[i, 1] = mount[1] + b + w * q + z * p - x * r
        out[i, 2] = mount[2] + c + w * r + x * q - y * p


@numba.njit
def grid_of(places, grid, alpha):
    e = math.sqrt(ECCENTRICITY)
    for i in range(places.shape[0]):
        sine, away = math.sin(math.radians(places[i, 0])), math.radians(places[i, 1] - 9)
        t = math.sinh(math.atanh(sine) - e * math.atanh(e * sine))
        xi, eta = math.atan2(t, math.cos(away)), math.asinh(math.sin(away) / math.hypot(t, math.cos(away)))
        x, y = eta, xi
        for j in range(6):
            x += alpha[j] * math.cos(2 * (j + 1) * xi) * math.sinh(2 * (j + 1) * eta)
            y += alpha[j] * math.sin(2 * (j + 1) * xi) * math.cosh(2 * (j + 1) * eta)
        grid[i, 0], grid[i, 1] = 500000 + SCALE * x, SCALE * y


@numba.njit
def places_of(grid, places, beta):
    e = math.sqrt(ECCENTRICITY)
    for i in range(grid.shape[0]):
        eta, xi = (grid[i, 0] - 500000) / SCALE, grid[i, 1] / SCALE
        x, y = eta, xi
        for j in range(6):
            x -= beta[j] * math.cos(2 * (j + 1) * xi) * math.sinh(2 * (j + 1) * eta)
            y -= beta[j] * math.sin(2 * (j + 1) * xi) * math.cosh(2 * (j + 1) * eta)
        conformal = math.sin(y) / math.hypot(math.sinh(x), math.cos(y))
        t = conformal
        for _ in range(3):
            h = math.sqrt(1 + t * t)
            s = math.sinh(e * math.atanh(e * t / h))
            found = t * math.sqrt(1 + s * s) - s * h
            t += (conformal - found) / math.sqrt(1 + found * found) * (1 + (1 - ECCENTRICITY) * t * t) / ((1 - ECCENTRICITY) * h)
        places[i, 0], places[i, 1] = math.degrees(math.atan(t)), 9 + math.degrees(math.atan2(math.sinh(x), math.cos(y)))


def message():
    """Quaternions and points, as arrays and as the message of both."""
    numbers = np.random.default_rng(0)
    turns, points = numbers.normal(size=(COUNT, 4)), numbers.normal(size=(COUNT, 3))
    write = rj.Encoder.of("lab/msg/Seen", schema=FILES, imports=["lab/msg/Seen.msg"])
    fields = {
        "turns": [dict(zip("xyzw", map(float, each), strict=True)) for each in turns],
        "points": [dict(zip("xyz", map(float, each), strict=True)) for each in points],
    }
    return turns, points, write(write.holder_type.from_dict(fields))


JOBS = ("quaternions to angles", "angles to quaternions", "points in another frame")


@pytest.mark.parametrize("job", JOBS)
def test_against_numba(job, effort, compare, record):
    turns, points, sent = message()
    name = "points.mapping" if job == JOBS[2] else "turns.mapping"
    options = {"schema": FILES, "parameters": {"mount": list(MOUNT)} if job == JOBS[2] else {}}
    decode, encode = rj.Decoder(name, **options), rj.Encoder(name, **options)
    angles, mount = np.empty((COUNT, 3)), np.array(MOUNT)
    angles_of(turns, angles)
    held = decode(sent)
    by_hand, arguments = {
        JOBS[0]: (angles_of, (turns, angles.copy())),
        JOBS[1]: (turns_of, (angles, turns.copy())),
        JOBS[2]: (moved, (mount, points, points.copy())),
    }[job]
    by_hand(*arguments)

    def ours():
        if job == JOBS[1]:
            return effort.call(encode.into, held, bytearray(len(encode(held))))
        return effort.call(rj.Decoder(name, **options), anew(sent))

    outcome = compare(
        CHAPTER,
        job,
        [
            Contender(OURS, "ours", "a message decoded or encoded", effort.placed(ours)),
            Contender(BY_HAND, "peer", "an array, from another", effort.placed(lambda: effort.call(by_hand, *arguments))),
        ],
    )
    record(f"{job}, {COUNT}", outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba", f"{outcome.took(OURS).median / 1000:.1f} µs")


PLACES = ("places to a zone of UTM", "places from a zone of UTM")


@pytest.mark.parametrize("job", PLACES)
def test_places(job, effort, compare, record):
    numbers = np.random.default_rng(0)
    places = np.stack([numbers.uniform(-80, 84, COUNT), numbers.uniform(6, 12, COUNT)], axis=1)
    options = {"schema": FILES, "encoding": "ros1"}
    sent = np.uint32(COUNT).tobytes() + places.tobytes()
    decode, encode = rj.Decoder("places.mapping", **options), rj.Encoder("places.mapping", **options)
    held, grid, again = decode(sent), np.empty((COUNT, 2)), np.empty((COUNT, 2))
    grid_of(places, grid, KRUEGER["there"])
    places_of(grid, again, KRUEGER["back"])
    assert np.allclose(np.frombuffer(encode(held), np.float64, offset=4).reshape(-1, 2), places, rtol=0, atol=1e-11)
    assert np.allclose([[each.easting, each.northing] for each in held.points], grid, rtol=0, atol=1e-6)

    def by_hand():
        return grid_of(places, grid, KRUEGER["there"]) if job == PLACES[0] else places_of(grid, again, KRUEGER["back"])

    def ours():
        if job == PLACES[1]:
            return effort.call(encode.into, held, bytearray(len(sent)))
        return effort.call(rj.Decoder("places.mapping", **options), anew(sent))

    contenders = [
        Contender(OURS, "ours", "a message decoded or encoded", effort.placed(ours)),
        Contender(BY_HAND, "peer", "an array, from another", effort.placed(lambda: effort.call(by_hand))),
    ]
    outcome = compare(CHAPTER, job, contenders)
    record(f"{job}, {COUNT}", outcome.ratio(OURS, BY_HAND), AT_MOST, "x numba", f"{outcome.took(OURS).median / 1000:.1f} µs")
