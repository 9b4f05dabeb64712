"""The demo's parts: recordings that can be read, pictures, the table."""

from __future__ import annotations

import errno
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from rosetta_jit.cli import demo, main
from rosetta_jit.demo.pictures import draw_frame, draw_joints
from rosetta_jit.demo.play import Played, Report, dynamic_reader, table
from rosetta_jit.demo.streams import load_streams

PIXELS = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)


def test_what_it_draws_with_is_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(demo, "find_spec", lambda name: None if name == "matplotlib" else name)
    assert main(["demo", "--output", str(tmp_path)]) == 1
    assert capsys.readouterr().err == "error: the demo draws with matplotlib: pip install 'rosetta-jit[demo]'\n"
    assert not any(tmp_path.iterdir())


def test_every_bundled_message_is_a_bottle():
    streams = load_streams()
    assert [len(stream.messages) for stream in streams] == [500, 500, 50, 8, 8, 4] * 2
    for stream in streams:
        read = dynamic_reader(stream.dialect)
        for message in (stream.messages[0], stream.messages[-1]):
            assert read(message.data).items


@pytest.mark.parametrize(
    ("data", "data_order", "color_mode"),
    [(PIXELS, 1, 1), (PIXELS[:, :, ::-1], 1, 2), (PIXELS.transpose(2, 0, 1), 0, 1), (PIXELS[:, :, ::-1].transpose(2, 0, 1), 0, 2)],
)
def test_a_frame_is_drawn_from_any_order(tmp_path, data, data_order, color_mode):
    image = SimpleNamespace(data=data.tobytes(), width=6, height=4, channels=3, data_order=data_order, color_mode=color_mode)
    with Image.open(draw_frame(image, tmp_path / "frame.png")) as drawn:
        assert np.array_equal(np.asarray(drawn), PIXELS)


def test_joints_are_plotted(tmp_path):
    angles = np.linspace(-1, 1, 20, dtype=np.float32).reshape(10, 2)
    with Image.open(draw_joints(list(range(10)), angles, tmp_path / "joints.png")) as drawn:
        assert drawn.size[0] > 500


def test_the_table_has_a_line_a_stream():
    streams = load_streams()[:2]
    text = table(Report(tuple(Played(stream, 30.0, 3000.0, 120.0, 1.5) for stream in streams), ()))
    lines = text.splitlines()
    assert len(lines) == 4
    assert {len(line) for line in lines} == {len(lines[0])}
    assert lines[2].split() == ["torso_state", "yarp3", "500", "16,000", "30", "3,000", "100", "x", "120.0", "1.5"]


@pytest.mark.parametrize("draw", [draw_frame, draw_joints])
def test_a_picture_that_does_not_fit_leaves_no_file(tmp_path, monkeypatch, draw):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Image.Image, "save", full)
    image = SimpleNamespace(data=bytes(12), width=2, height=2, channels=3, color_mode=2, data_order=1)
    arguments = (image,) if draw is draw_frame else (range(3), np.zeros((3, 2), np.float32))
    with pytest.raises(OSError, match="No space left") as found:
        draw(*arguments, tmp_path / "picture.png")
    assert found.value.filename == str(tmp_path / "picture.png")
    assert not list(tmp_path.iterdir())
