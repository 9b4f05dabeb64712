"""The simulator of `simulator.cpp` on ports of ours, for machines without YARP: the same messages and the same commands."""

from __future__ import annotations

import sys
import time

import numpy as np

import rosetta_jit as rj

STEP_S, SPEED_DEG = 0.02, 40.0


class Torso:
    """Three joints that move to where they are told to."""

    def __init__(self) -> None:
        self.angles, self.wanted = np.zeros(3), np.zeros(3)
        self._command = rj.Decoder.of("yarp.icub.torso.command", encoding="yarp3", imports=["yarp/icub/torso_command.bottle-schema"])
        schema = {"usecase/reply.bottle-schema": '"usecase.reply"\n( ("answer" :vocab) )'}
        self._ok = rj.Encoder.of("usecase.reply", encoding="yarp3", schema=schema)

    def obey(self, message: object) -> bytes:
        """Answer a command."""
        angles = self._command(message.data).angles
        self.wanted = np.array([angles.yaw, angles.roll, angles.pitch])
        return self._ok({"answer": int.from_bytes(b"ok", "little")})

    def move(self) -> None:
        """One step."""
        left = self.wanted - self.angles
        self.angles = self.angles + np.clip(left, -SPEED_DEG * STEP_S, SPEED_DEG * STEP_S)


def picture(angle: float) -> np.ndarray:
    """What the camera sees, shape (120, 160, 3)."""
    y, x = np.mgrid[:120, :160]
    arm = np.abs(x - int(80 + angle)) < 6
    return np.where(arm[..., None], [255, 120, 0], np.stack([x, y, np.full_like(x, 90)], axis=-1)).astype(np.uint8)


def main(port: str) -> None:
    """Play until killed."""
    torso, server = Torso(), f"?server=127.0.0.1:{port}"
    joints = rj.Encoder.of("yarp.icub.torso.state", encoding="yarp3", imports=["yarp/icub/torso_state.bottle-schema"])
    image = rj.Encoder("yarp/icub/camera_image.mapping", encoding="yarp3")
    see = rj.Encoder.of("rst.vision.Image").new()
    see.width, see.height, see.channels = 160, 120, 3
    see.data_order = see.DATA_INTERLEAVED
    with (
        rj.publish(f"yarp:/icub/torso/state:o{server}") as state,
        rj.publish(f"yarp:/icub/cam/left{server}") as camera,
        rj.serve(f"yarp:/icub/torso/rpc:i{server}", torso.obey),
    ):
        step = 0
        while True:
            torso.move()
            state.send(joints(dict(zip(("yaw", "roll", "pitch"), torso.angles.tolist(), strict=True))))
            if step % 5 == 0:
                see.data = picture(torso.angles[0]).tobytes()
                camera.send(image(see))
            step += 1
            time.sleep(STEP_S)


if __name__ == "__main__":
    main(sys.argv[1])
