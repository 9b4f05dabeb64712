"""Pictures of what was decoded: a camera's frame, and joint angles over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rosetta_jit.file_errors import whole

if TYPE_CHECKING:
    from pathlib import Path

    Angles = np.ndarray[tuple[int, ...], np.dtype[np.float32]]
    Pixels = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]

DATA_SEPARATE, COLOR_BGR = 0, 2  # of rst.vision.Image


class RstImage(Protocol):
    """What is drawn of an `rst.vision.Image`; any holder of that type has it."""

    data: bytes
    width: int
    height: int
    channels: int
    color_mode: int
    data_order: int


def draw_frame(image: RstImage, path: Path) -> Path:
    """Write an `rst.vision.Image` as PNG."""
    from PIL import Image

    with whole(path) as part:
        Image.fromarray(pixels(image)).save(part, format="PNG")
    return path


def pixels(image: RstImage) -> Pixels:
    """The pixels of an `rst.vision.Image`, shape (height, width, 3), red first."""
    data = np.frombuffer(image.data, np.uint8)
    if image.data_order == DATA_SEPARATE:
        interleaved = data.reshape(image.channels, image.height, image.width).transpose(1, 2, 0)
    else:
        interleaved = data.reshape(image.height, image.width, image.channels)
    return np.ascontiguousarray(interleaved[:, :, ::-1] if image.color_mode == COLOR_BGR else interleaved)


def draw_joints(times_s: Sequence[float], angles_rad: Angles, path: Path) -> Path:
    """Plot angles of shape (messages, joints): radians as they lie in the holder, and the degrees that came over the wire."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 7), layout="constrained")
    for row, (angles, unit) in enumerate([(np.degrees(angles_rad), "degrees"), (angles_rad, "radians")], 1):
        axes = figure.add_subplot(2, 1, row)
        axes.plot(times_s, angles, linewidth=1)
        axes.set(xlabel="seconds", ylabel=unit, title=f"{angles.shape[1]} joints, {unit}")
        axes.grid(visible=True, alpha=0.3)
    with whole(path) as part:
        FigureCanvasAgg(figure).print_png(str(part))
    return path
