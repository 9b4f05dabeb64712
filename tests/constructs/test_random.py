"""Random mappings have every construct: the texts of many are looked at, and none is compiled.

The generators ask for programs of their mappings; here these are replaced by one that keeps the text and goes no further.
"""

from __future__ import annotations

from unittest.mock import MagicMock

import pytest

import rosetta_jit as rj
from tests.constructs.contained import EVERY, contained
from tests.random_mappings import test_functions as functions
from tests.random_mappings import test_mappings as mappings
from tests.random_mappings import test_relations as relations
from tests.random_mappings import test_sequences as sequences
from tests.random_mappings import test_several_wires as several
from tests.random_mappings import test_state as state
from tests.random_mappings import test_wires as wires

SEEDS, OF_RELATIONS = 50, 800
ELSEWHERE = {
    "tests/language/test_functions.py": ("acos", "asin", "atan", "atan2", "cos", "sin", "tan", "isfinite", "isnan", "others"),
    "tests/language/test_groups.py": (
        *("component", "pose", "position", "orientation", "compose_poses", "invert_pose", "transform_point", "quaternion", "euler"),
        *("quaternion_of_matrix", "rotation_matrix", "compose_rotations", "invert_rotation", "rotate_vector"),
        *("enu", "geodetic", "utm", "geodetic_of_utm"),
    ),
    "tests/lowering/test_compressed.py": (
        "compress",
        "decompress",
        *(f"image_{each}" for each in ("width", "height", "channels", "depth")),
    ),
    "tests/lowering/test_colours.py": ("rgb_of", "yuv_of"),
    "tests/language/test_counters.py": ("now", "counter"),
    "tests/language/test_number_bytes.py": ("int8_at", "byte"),
    "tests/language/test_text_inverses.py": ("until_nul",),
    "tests/language/test_same_names.py": ("renamed", "the rest"),
    "tests/language/test_edition.py": ("edition",),
    "tests/language/test_rounding.py": ("rounding",),
    "tests/operations/test_nine_operations.py": ("to depth",),
    "tests/runtime/test_shipped_growth.py": ("limit",),
    "tests/language/test_signals.py": ("signal_bytes",),
    "tests/language/test_sequences.py": ("run_lengths", "run_values"),
    "tests/language/test_image_orders.py": ("padded_rows",),
}
"""What no random mapping writes down, and which test has random or hostile values of it. Some are what relations are packed by."""


class FoundError(Exception):
    """The text of a mapping is kept."""


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    found: list[str] = []

    def keep(_mapping: str, *, schema: dict[str, str], **_options: object) -> None:
        found.extend(text for name, text in schema.items() if name.endswith(".mapping"))
        raise FoundError

    for name in ("Decoder", "Encoder", "Decoders"):
        monkeypatch.setattr(rj, name, MagicMock(side_effect=keep))
    return found


def ask(check, *arguments: object) -> None:
    with pytest.raises(FoundError):
        check(*arguments, ["llvm"])


def test_random_mappings_have_every_construct(texts):
    for seed in range(SEEDS):
        for direction in ("decode", "encode"):
            ask(functions.check_functions, seed, direction)
            ask(mappings.check_values, seed, direction)
            ask(mappings.check_arrays, seed, direction, "ros1")
        ask(wires.check_wires, seed, *wires.pair_of(seed))
        for check in (sequences.check_sequences, state.check_state, several.check_several_wires):
            ask(check, seed)
    for seed in range(OF_RELATIONS):
        ask(relations.check_relations, seed, relations.pair_of(seed))
    found = {construct for text in texts for construct in contained(text)}
    elsewhere = {name if name in EVERY else f"function {name}" for names in ELSEWHERE.values() for name in names}
    assert EVERY - found - elsewhere == set()
    assert elsewhere <= EVERY
