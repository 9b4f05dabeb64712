"""Videos that `yarpdatadumper --type video` keeps in place of images, read by OpenCV (extra `videos`): `video.mkv` or `video.avi`.

A line of `data.log` names a frame by the number of the line: `frame_00000007`. The dumper begins the video when two images wait for it, so
the first lines may have no frame; `timecodes.log` has a line for each frame, behind one that names its form.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING, Any

from rosetta_jit.catalogue import logs as words
from rosetta_jit.errors import LogError
from rosetta_jit.logs.limits import MAX_PIXELS

if TYPE_CHECKING:
    from pathlib import Path

FRAME = re.compile(rb"frame_(\d{8,10})")
FILES = "video.mkv", "video.avi"
MATROSKA, RIFF = b"\x1a\x45\xdf\xa3", b"RIFF"
"""How such files begin. FFmpeg takes a list of addresses for a video, too, whatever its name, and would open these."""

WINDOW = 1 << 20


class VideoError(ValueError):
    """A video that cannot be read, or not as far as a frame: nor can what follows."""


class Frames:
    """The frames of a folder's video, each by the number of its line. They are cheap in their order: a video is read forwards."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._video: Any = None
        self._next = self._without = 0

    def pixels(self, number: int) -> tuple[int, int, bytes]:
        """Width, height, and the colours of a frame, row by row.

        Raises
        ------
        ValueError
            The video begins later.
        VideoError
            The video ends before, or there is none.
        LogError
            OpenCV is not installed.
        """
        video: Any = self._video
        if video is None or number - self._without < self._next:
            video = self._video = self._opened()
        place = number - self._without
        if place < 0:
            raise ValueError(f"the video begins with frame {self._without}")
        while self._next < place and video.grab():
            self._next += 1
        frame: Any = video.read()[1] if self._next == place else None
        if frame is None or frame.ndim != 3:
            raise VideoError(f"the video has no frame {number}")
        self._next += 1
        return frame.shape[1], frame.shape[0], frame[:, :, ::-1].tobytes()  # OpenCV's colours are blue, green, red

    def _opened(self) -> Any:
        """The video, of which nothing is read."""
        path = next((self._folder / name for name in FILES if (self._folder / name).is_file()), None)
        if path is None:
            raise VideoError(f"there is no {' or '.join(FILES)}")
        with path.open("rb") as file:
            begin = file.read(12)
        if not begin.startswith(MATROSKA) and not (begin.startswith(RIFF) and begin.endswith(b"AVI ")):
            raise VideoError(f"{path.name} is no Matroska or AVI file")
        try:
            cv: Any = import_module("cv2")
        except ImportError:
            raise LogError((words.needs(str(path), "opencv-python-headless", "videos"),)) from None
        video: Any = cv.VideoCapture(str(path), cv.CAP_FFMPEG)
        width, height = (video.get(each) for each in (cv.CAP_PROP_FRAME_WIDTH, cv.CAP_PROP_FRAME_HEIGHT))
        if not video.isOpened() or not 0 < width * height <= MAX_PIXELS:
            raise VideoError(f"{path.name} has no frames of at most {MAX_PIXELS} pixels")
        self._next, self._without = 0, self._lines_without_frame()
        return video

    def _lines_without_frame(self) -> int:
        """How many lines were written before the video was begun."""
        timecodes = self._folder / "timecodes.log"
        if not timecodes.is_file():
            return 0
        return max(0, _lines(self._folder / "data.log") - (_lines(timecodes) - 1))


def _lines(path: Path) -> int:
    with path.open("rb") as file:
        return sum(each.count(b"\n") for each in iter(lambda: file.read(WINDOW), b""))
