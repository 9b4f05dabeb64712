"""What a mapping becomes, stage by stage, as text that is the same every time: change it knowingly.

UPDATE_GOLDENS=1 python -m pytest tests/test_stages.py
"""

from __future__ import annotations

from pathlib import Path

import pytest

import rosetta_jit as rj
from tests.golden import check_golden

GOLDEN = Path(__file__).resolve().parent / "golden" / "stages"
MAPPINGS = {"torso_state": "yarp3", "camera_image": "yarp4", "torso_command": "yarp2012"}
STAGES = ["model", "codec", "kernel", "python"]


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("name", MAPPINGS)
@pytest.mark.parametrize("direction", ["decode", "encode"])
def test_stage(name, direction, stage):
    program = {"decode": rj.Decoder, "encode": rj.Encoder}[direction]
    made = program(f"yarp/icub/{name}.mapping", encoding=MAPPINGS[name], backend="python")
    check_golden(GOLDEN / f"{name}.{direction}.{stage}", made.stage(stage))


@pytest.mark.parametrize("stage", ["llvm", "asm"])
def test_code_of_this_machine(stage):
    text = rj.Decoder("yarp/icub/torso_state.mapping", encoding="yarp3", backend="llvm").stage(stage)
    assert "kernel" in text


def test_an_unknown_stage_is_named():
    with pytest.raises(ValueError, match="model, codec, kernel"):
        rj.Decoder("yarp/icub/torso_state.mapping", backend="python").stage("soup")
