"""A plugin of pytest for the benchmarks of any checkout: what they found, as JSON, in the file that KEPT_REPORT names.

pytest-benchmark writes none where no test has timed a function by it.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any


def pytest_sessionfinish(session: Any) -> None:
    found: dict[str, Any] = {}
    session.config.hook.pytest_benchmark_update_json(config=session.config, benchmarks=[], output_json=found)
    Path(os.environ["KEPT_REPORT"]).write_text(json.dumps(found["rosetta_jit"]), "utf-8")
