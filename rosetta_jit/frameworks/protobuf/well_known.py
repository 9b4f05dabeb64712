"""Methods that protobuf's package gives its well-known types: `Timestamp.ToDatetime`, `Struct.update`, `FieldMask.Union`, and their kin.

They are the package's own functions, which need nothing of a message but its fields; the package is imported when one is first asked for.
"""

from __future__ import annotations

from typing import Any

_SECONDS = (
    "FromMicroseconds",
    "FromMilliseconds",
    "FromNanoseconds",
    "FromSeconds",
    "ToMicroseconds",
    "ToMilliseconds",
    "ToNanoseconds",
    "ToSeconds",
)
_SUMS = ("__add__", "__radd__", "__rsub__", "__sub__")
_JSON = ("FromJsonString", "ToJsonString")
_ITEMS = ("__delitem__", "__getitem__", "__len__", "__setitem__", "items")
METHODS = {
    "google.protobuf.Any": ("Is", "Pack", "TypeName", "Unpack"),
    "google.protobuf.Duration": (*_SECONDS, *_SUMS, *_JSON, "FromTimedelta", "ToTimedelta", "_NormalizeDuration"),
    "google.protobuf.FieldMask": (
        *_JSON,
        "AllFieldsFromDescriptor",
        "CanonicalFormFromMask",
        "Intersect",
        "IsValidForDescriptor",
        "MergeMessage",
        "Union",
    ),
    "google.protobuf.ListValue": (*_ITEMS, "add_list", "add_struct", "append", "extend"),
    "google.protobuf.Struct": (*_ITEMS, "__iter__", "get_or_create_list", "get_or_create_struct", "keys", "update", "values"),
    "google.protobuf.Timestamp": (*_SECONDS, *_SUMS, *_JSON, "FromDatetime", "GetCurrentTime", "ToDatetime"),
}
"""By the names of the types, those of the methods."""


def methods_of(struct: str) -> dict[str, Any]:
    """The methods of a type, by name; none of any other."""
    return {name: _Theirs(struct, name) for name in METHODS.get(struct, ())}


class _Theirs:
    """A method of a class of the package."""

    def __init__(self, struct: str, name: str) -> None:
        self._struct = struct
        self._name = name

    def __get__(self, instance: object, owner: type) -> Any:
        from google.protobuf.internal.well_known_types import WKTBASES

        found: Any = vars(WKTBASES[self._struct])[self._name]
        return found.__get__(instance, owner)
