"""No test reads or fills the user's own cache."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROSETTA_JIT_CACHE_DIR", str(tmp_path_factory.mktemp("kernels")))
        yield
