"""SHA-256 as CPython itself has it: to load OpenSSL's, which `hashlib` does, takes longer than all digests of a warm start."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hashlib import sha256 as sha256  # noqa: PLC0414 - what others import from here
else:
    try:
        if sys.version_info >= (3, 12):
            from _sha2 import sha256
        else:
            from _sha256 import sha256
    except ImportError:
        from hashlib import sha256  # noqa: F401 - what others import from here
