"""Plain objects of the types that are measured: dataclasses with slots, as somebody would write them who needs no framework.

Their lists are Python's. A function beside each class makes one of plain values, as `to_dict` of a holder gives them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    Plain = Mapping[str, Any]


def _zeros() -> list[float]:
    return [0.0] * 9


@dataclass(slots=True)
class Time:
    sec: int = 0
    nanosec: int = 0


@dataclass(slots=True)
class Header:
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass(slots=True)
class Vector3:
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True)
class Quaternion:
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 0.0


@dataclass(slots=True)
class Imu:
    header: Header = field(default_factory=Header)
    orientation: Quaternion = field(default_factory=Quaternion)
    orientation_covariance: list[float] = field(default_factory=_zeros)
    angular_velocity: Vector3 = field(default_factory=Vector3)
    angular_velocity_covariance: list[float] = field(default_factory=_zeros)
    linear_acceleration: Vector3 = field(default_factory=Vector3)
    linear_acceleration_covariance: list[float] = field(default_factory=_zeros)


@dataclass(slots=True)
class JointState:
    header: Header = field(default_factory=Header)
    name: list[str] = field(default_factory=list[str])
    position: list[float] = field(default_factory=list[float])
    velocity: list[float] = field(default_factory=list[float])
    effort: list[float] = field(default_factory=list[float])


@dataclass(slots=True)
class Pose:
    position: Vector3 = field(default_factory=Vector3)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass(slots=True)
class PoseArray:
    header: Header = field(default_factory=Header)
    poses: list[Pose] = field(default_factory=list[Pose])


def header(plain: Plain) -> Header:
    return Header(Time(**plain["stamp"]), plain["frame_id"])


def imu(plain: Plain) -> Imu:
    return Imu(
        header(plain["header"]),
        Quaternion(**plain["orientation"]),
        plain["orientation_covariance"],
        Vector3(**plain["angular_velocity"]),
        plain["angular_velocity_covariance"],
        Vector3(**plain["linear_acceleration"]),
        plain["linear_acceleration_covariance"],
    )


def joint_state(plain: Plain) -> JointState:
    return JointState(header(plain["header"]), plain["name"], plain["position"], plain["velocity"], plain["effort"])


def pose_array(plain: Plain) -> PoseArray:
    poses = [Pose(Vector3(**each["position"]), Quaternion(**each["orientation"])) for each in plain["poses"]]
    return PoseArray(header(plain["header"]), poses)
