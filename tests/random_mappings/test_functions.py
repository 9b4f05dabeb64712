"""Random expressions with calls of users' functions: each backend gives what Python's functions give, or refuses what they refuse."""

from __future__ import annotations

import random

import numpy as np
import pytest

from tests.random_mappings.arrays import some_arrays
from tests.random_mappings.fields import some_fields
from tests.random_mappings.functions import DECLARED, FUNCTIONS, Calling
from tests.random_mappings.meaning import LEAVES
from tests.random_mappings.test_mappings import OUT, expected, runner, seen, with_values

MESSAGES = 20
RULES = 5


def check_functions(seed, direction, backends):
    rng = random.Random(f"functions {seed}")
    maker = Calling(rng, LEAVES)
    rules = [maker.of(rng.choice(OUT), rng.randrange(1, 4)) for _ in range(RULES)]
    files = with_values(rules, direction)
    files["m.mapping"] = DECLARED + files["m.mapping"]
    functions = {name: each.run for name, each in FUNCTIONS.items()}
    runs = {backend: runner(files, direction, backend, functions=functions) for backend in backends}
    for _ in range(MESSAGES):
        fields = {**some_arrays(rng), **some_fields(rng, LEAVES)}
        with np.errstate(all="ignore"):
            wanted = expected(rules, fields)
        for backend, run in runs.items():
            assert seen(run, fields) == wanted, (seed, backend, files["m.mapping"], fields)


@pytest.mark.parametrize("direction", ["decode", "encode"])
@pytest.mark.parametrize("seed", range(2))
def test_functions(seed, direction):
    check_functions(seed, direction, ["python", "interpreter", "llvm", "numba"])


@pytest.mark.campaign
@pytest.mark.parametrize("block", range(20))
def test_campaign(block):
    for seed in range(100 * block + 1000, 100 * block + 1100):
        for direction in ("decode", "encode"):
            check_functions(seed, direction, ["python", "llvm"] if seed % 10 else ["python", "interpreter", "llvm", "numba"])
