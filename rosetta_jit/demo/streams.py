"""What is played: each recording of each dialect, with the mapping that decodes it."""

from __future__ import annotations

from pathlib import Path

from rosetta_jit.recording import Message, read_messages
from rosetta_jit.startup.dataclass import dataclass

RECORDINGS = Path(__file__).resolve().parent / "recordings"

MAPPINGS = {
    "torso_state": "yarp/icub/torso_state.mapping",
    "left_arm_state": "yarp/icub/left_arm_state.mapping",
    "torso_command": "yarp/icub/torso_command.mapping",
    "cam_left": "yarp/icub/camera_image.mapping",
    "cam_right": "yarp/icub/camera_image.mapping",
    "cam_odd_width": "yarp/icub/camera_image.mapping",
}
"""The shipped mapping of each recording."""

DIALECTS = ("yarp3", "yarp4")


@dataclass(frozen=True, slots=True)
class Stream:
    """One recording: what one port of the robot sent."""

    name: str
    dialect: str
    mapping: str
    messages: tuple[Message, ...]

    @property
    def size_bytes(self) -> int:
        return sum(len(message.data) for message in self.messages)


def load_streams() -> tuple[Stream, ...]:
    """All bundled recordings, unpacked."""
    return tuple(
        Stream(name, dialect, mapping, tuple(read_messages(RECORDINGS / f"icub-{dialect}" / f"{name}.rec.xz")))
        for dialect in DIALECTS
        for name, mapping in MAPPINGS.items()
    )
