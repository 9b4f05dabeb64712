"""What turns the messages of a route into others."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rosetta_jit.bridge.configuration import Translation

    Translate = Callable[[Any], bytes]


def translator(translation: Translation, search_path: tuple[str, ...]) -> Translate | None:
    """The compiled bridge of a route; None where bytes pass as they are.

    Raises
    ------
    ReportError
        The mapping, a type or an option is wrong.
    TypeError
        An option is of another kind.
    """
    if not translation.text:
        return None
    from rosetta_jit.api.bridges import Bridge

    given: dict[str, Any] = json.loads(translation.text)
    if "between" in given:
        return Bridge.between(*given["between"])
    options: dict[str, Any] = {side: {"search_path": search_path, **given.get(side, {})} for side in ("decode", "encode")}
    one, other = given.get("decode_mapping"), given.get("encode_mapping")
    if one is None and other is None and "decode_type" in given:
        return Bridge.of(given["decode_type"], given.get("encode_type"), **options)
    types = {key: given[key] for key in ("decode_type", "encode_type") if key in given}
    return Bridge(one, other, **options, **types)
