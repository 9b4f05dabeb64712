"""A component on RSB: it gets joint angles in radians and images of RST, and sends joint angles as commands. It has never heard of YARP."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

import rosetta_jit as rj


@dataclass
class Seen:
    """What the component got and sent: times in seconds since it began."""

    angles: list[tuple[float, tuple[float, ...]]] = field(default_factory=list)
    commands: list[tuple[float, tuple[float, ...]]] = field(default_factory=list)
    images: int = 0
    image: np.ndarray | None = None


def run(port: int, seconds: float, poses: tuple[tuple[float, float, float], ...]) -> Seen:
    """Command one pose after the other, and watch; ``poses`` in radians."""
    angles, image = rj.Decoder.of("rst.kinematics.JointAngles"), rj.Decoder.of("rst.vision.Image")
    command = rj.Encoder.of("rst.kinematics.JointAngles")
    seen, begun = Seen(), time.monotonic()

    def joints(message: object) -> None:
        seen.angles.append((time.monotonic() - begun, tuple(float(each) for each in angles(message.data).angles)))

    def camera(message: object) -> None:
        found = image(message.data)
        seen.images += 1
        seen.image = np.frombuffer(bytes(found.data), np.uint8).reshape(found.height, found.width, 3)

    with (
        rj.subscribe(f"rsb:/icub/torso?port={port}", joints),
        rj.subscribe(f"rsb:/icub/camera?port={port}", camera),
        rj.publish(f"rsb:/icub/command/torso?port={port}&type=.rst.kinematics.JointAngles") as commands,
    ):
        for pose in poses:
            commands.send(command({"angles": pose}))
            seen.commands.append((time.monotonic() - begun, pose))
            time.sleep(seconds / len(poses))
    return seen
