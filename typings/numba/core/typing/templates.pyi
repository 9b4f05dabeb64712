from typing import ClassVar

from numba.types import Type

class Signature:
    args: tuple[Type, ...]
    return_type: Type

class AttributeTemplate:
    key: ClassVar[type[Type]]
