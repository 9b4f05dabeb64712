"""Values of a holder as JSON, so that reading them back gives the same values.

Bytes stand as ``{"base64": "…"}``; what JSON numbers lack as ``{"float": "nan"}``, ``inf`` or ``-inf``.
"""

from __future__ import annotations

import json
import math
from base64 import b64decode, b64encode
from typing import cast

NON_FINITE = ("nan", "inf", "-inf")


def dump(values: dict[str, object]) -> str:
    """One line of strict JSON."""
    return json.dumps(_plain(values), ensure_ascii=False, allow_nan=False)


def load(text: str) -> object:
    """The inverse of `dump`; ValueError on what is no JSON."""
    return json.loads(text, object_hook=_restored)


def _plain(value: object) -> object:
    match value:
        case dict():
            return {str(key): _plain(item) for key, item in cast("dict[object, object]", value).items()}
        case list() | tuple():
            return [_plain(item) for item in cast("list[object]", value)]
        case bytes():
            return {"base64": b64encode(value).decode("ascii")}
        case float() if not math.isfinite(value):
            return {"float": str(value)}
        case _:
            return value


def _restored(value: dict[str, object]) -> object:
    match value:
        case {"base64": str(text)} if len(value) == 1:
            return b64decode(text, validate=True)
        case {"float": str(text)} if len(value) == 1 and text in NON_FINITE:
            return float(text)
        case _:
            return value
