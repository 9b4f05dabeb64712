"""`python -m rosetta_jit` is `rosetta-jit`."""

from __future__ import annotations

import sys

from rosetta_jit.cli import main

sys.exit(main())
