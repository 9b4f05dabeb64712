"""Holders that behave as the Python classes that omniidl writes for omniORBpy do.

What differs, and why: sequences of numbers are numpy arrays and those of octets bytes, where omniORBpy has lists and strings; and an
enumerator is read as its number, and can be assigned as its name.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from rosetta_jit.model.types import Enum, Ref, Union
from rosetta_jit.runtime.holder import PLAIN, Family, Holder, Manners


class Structure(Holder):
    """A struct or union of CORBA.

    Parameters
    ----------
    *values
        Every member in order, or none; of a union the discriminator and the value.
    **fields
        Of a union, one case by its name.
    """

    __slots__ = ()

    begins_alike_ = True

    members_: ClassVar[tuple[str, ...]] = ()
    union_: ClassVar[Union | None] = None

    def __init__(self, *values: Any, **fields: Any) -> None:
        super().__init__()
        if values and (fields or len(values) != len(self.members_)):
            raise TypeError(f"{type(self).__name__} takes {len(self.members_)} values: {', '.join(self.members_)}")
        for name, value in (*zip(self.members_, values, strict=False), *fields.items()):
            setattr(self, name, value)

    def _case(self) -> str | None:
        """The name of the case that the discriminator of a union tells."""
        assert self.union_ is not None
        return next((each.name for each in self.union_.cases if self.has(each.name)), None)

    @property
    def _v(self) -> Any:
        """The value of a union, whichever case it is; None where there is none."""
        case = self._case() if self.union_ is not None else None
        return None if case is None else getattr(self, case)

    @_v.setter
    def _v(self, value: Any) -> None:
        case = self._case() if self.union_ is not None else None
        if case is None:
            raise AttributeError("the discriminator tells no case")
        setattr(self, case, value)


def members(family: Family) -> dict[str, Any]:
    """What a class has besides its fields: the names that a constructor takes, and the enumerators of its enums."""
    struct = family.struct
    union = next((each.type for each in struct.fields if isinstance(each.type, Union)), None)
    enums = [family.schema.types[each.type.name] for each in struct.fields if isinstance(each.type, Ref)]
    words = {word: number for enum in enums if isinstance(enum, Enum) for word, number in enum.values}
    taken = {each.name for each in struct.fields}
    return {
        **{word: number for word, number in words.items() if word not in taken and not hasattr(Structure, word)},
        **{each.name: each.value for each in struct.constants if not hasattr(Structure, each.name)},
        "members_": tuple(each.name for each in struct.fields) if union is None else ("_d", "_v"),
        "union_": union,
        "_NP_RepositoryId": f"IDL:{struct.name.replace('::', '/')}:1.0",
    }


OMNIORB = Manners(
    Structure,
    np.ndarray,
    PLAIN.sequence,
    PLAIN.mapping,
    assigns_whole=True,
    members=members,
    place="rosetta_jit.frameworks.corba.manners:OMNIORB",
)
"""The manners of omniORBpy's classes."""
