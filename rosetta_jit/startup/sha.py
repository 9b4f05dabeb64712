"""SHA-256 as CPython itself has it: to load OpenSSL's, which `hashlib` does, takes longer than all digests of a warm start."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hashlib import sha256 as sha256  # noqa: PLC0414 - what others import from here
elif find_spec("_sha2"):  # from CPython 3.12 on
    from _sha2 import sha256
elif find_spec("_sha256"):
    from _sha256 import sha256
else:
    from hashlib import sha256 as sha256  # noqa: PLC0414 - what others import from here
