"""SHA-256 as CPython itself has it: to load OpenSSL's, which `hashlib` does, takes longer than all digests of a warm start."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hashlib import sha256 as sha256  # noqa: PLC0414 - what others import from here
else:
    try:
        from _sha2 import sha256  # from CPython 3.12 on
    except ImportError:
        try:
            from _sha256 import sha256
        except ImportError:
            from hashlib import sha256  # noqa: F401 - what others import from here
