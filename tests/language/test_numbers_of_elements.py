"""Numbers of elements and of rounds meet floats without a word: none is so large that a float64 rounds it."""

from __future__ import annotations

import numpy as np
import pytest

import rosetta_jit as rj
from rosetta_jit.errors import MappingError

FILES = {
    "lab/msg/Scan.msg": "float32 angle_min\nfloat32 step\nfloat32[] ranges\nint64 first\n",
    "polar.proto": """syntax = "proto3";
message Polar { repeated double x = 1; repeated double bearing = 2; double rms = 3; double share = 4; double all = 5; }""",
}
HEAD = 'import "lab/msg/Scan.msg"\nimport "polar.proto"\ndata-holder: Polar\nwire-schema: lab/msg/Scan\nunpack-rules:\n  ignore rest\n'
RULES = """  .x[] = .ranges[] * cos(.angle_min + index() * .step)
  len(.bearing) = len(.ranges)
  for i from 0 to len(.ranges)
    .bearing[i] = float64(.angle_min) + (i + 1) * float64(.step)
  end
  .rms = sqrt(sum(.ranges[] * .ranges[]) / len(.ranges))
  .share = 1.0 * count(.ranges[] > 1) / (len(.ranges) + 1)
  .all = len(.ranges)
"""


@pytest.mark.parametrize("backend", ["llvm", "python", "interpreter"])
def test_against_numpy(backend: str) -> None:
    files = {**FILES, "polar.mapping": HEAD + RULES}
    decode = rj.Decoder("polar.mapping", schema=files, backend=backend)
    write = rj.Encoder.of("lab/msg/Scan", schema=files, imports=["lab/msg/Scan.msg"])
    ranges = np.array([0.5, 1.5, 2.5], np.float32)
    found = decode(write(write.holder_type.from_dict({"angle_min": -1.0, "step": 0.25, "ranges": ranges})))
    assert np.allclose(found.x, ranges * np.cos(-1.0 + np.arange(3) * 0.25))
    assert list(found.bearing) == [-0.75, -0.5, -0.25]
    assert (found.rms, found.share, found.all) == (np.sqrt(np.sum(ranges * ranges) / 3), 0.5, 3.0)


@pytest.mark.parametrize(
    "rules",
    [
        "  default rest\n  len(.bearing) = 2\n  for i from .first to .first + 2\n    .bearing[i - .first] = i * 0.5\n  end\n",
        "  default rest\n  .all = .first * 0.5\n",
        "  default rest\n  .all = len(.ranges) * len(.ranges) * 0.5\n",
        "  default rest\n  .all = (len(.ranges) + 4294967297) * 0.5\n",
    ],
    ids=["a loop from anywhere", "a field", "a product", "a large sum"],
)
def test_other_integers_take_a_word(rules: str) -> None:
    with pytest.raises(MappingError, match=r"float64\(") as error:
        rj.Decoder("polar.mapping", schema={**FILES, "polar.mapping": HEAD + rules}, backend="python")
    assert "lossy-conversion" in {each.code for each in error.value.diagnostics}
