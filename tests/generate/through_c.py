"""A plugin of pytest by which the decoders and encoders of any tests run in generated C.

pytest -p tests.generate.through_c tests/frameworks
"""

from __future__ import annotations

from collections import Counter

from rosetta_jit.api import programs
from tests.generate.bridge import loaded_in_c

ORIGINAL = programs.loaded_of
COUNTS: Counter[str] = Counter()


def _loaded(request):
    try:
        made = loaded_in_c(request)
    except NotImplementedError:
        COUNTS["left"] += 1
        return ORIGINAL(request)
    COUNTS["in C"] += 1
    return made


def pytest_configure():
    programs.loaded_of = _loaded


def pytest_terminal_summary(terminalreporter):
    terminalreporter.write_line(f"programs: {dict(COUNTS)}")
