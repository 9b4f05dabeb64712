"""MD5 as CPython itself has it: to load OpenSSL's, which `hashlib` does, takes a thirtieth of a first compile. No safety depends on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hashlib import md5 as md5  # noqa: PLC0414 - what others import from here
else:
    try:
        from _md5 import md5
    except ImportError:
        from hashlib import md5  # noqa: F401 - what others import from here
