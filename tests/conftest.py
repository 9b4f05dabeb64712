"""No test reads or fills the user's own cache. Each run tries the same random examples; `--hypothesis-profile=default` asks for others."""

from __future__ import annotations

import gc

import pytest
from hypothesis import settings

settings.register_profile("reproducible", derandomize=True)
settings.load_profile("reproducible")


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path_factory.mktemp("kernels")))
        yield


@pytest.fixture(scope="module", autouse=True)
def little_to_collect():
    """Tests that ask for a collection wait for what their module has made, and not for all that the modules before it have."""
    gc.freeze()
