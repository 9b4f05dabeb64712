"""Names of the standard library that printed classes and functions use."""
# ruff: noqa: F401, N812 - they use them, not this module
# pyright: reportUnusedImport=false

from __future__ import annotations

import builtins as _builtins
import math
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count as _count
from operator import index as _index
from struct import Struct
from struct import error as _StructError
from struct import iter_unpack as _unpack_each
from struct import pack as _pack
from struct import unpack_from as _unpack
from typing import Any
