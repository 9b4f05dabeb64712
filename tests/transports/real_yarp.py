"""YARP's own programs, where YARP_DIR or the path has them."""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path


def program(name):
    """Where a program is; empty where it is not."""
    own = Path(os.environ.get("YARP_DIR", "/nowhere"), "bin", name)
    return str(own) if own.exists() else shutil.which(name) or ""


@cache
def dialect():
    """How these programs write numbers: nothing that they send says it."""
    said = subprocess.run([program("yarp"), "version"], capture_output=True, text=True, check=True, timeout=10).stdout
    return "yarp4" if int(said.split()[-1].split(".")[0]) >= 4 else "yarp3"
