from collections.abc import Hashable

from numba.core.typing.templates import Signature

class Type:
    name: str
    def __init__(self, name: str) -> None: ...
    def __call__(self, *args: Type) -> Signature: ...
    @property
    def key(self) -> Hashable: ...

class CPointer(Type):
    def __init__(self, dtype: Type) -> None: ...

class EphemeralPointer(CPointer): ...

class MemInfoPointer(Type):
    def __init__(self, dtype: Type) -> None: ...

class Integer(Type): ...
class Boolean(Type): ...

class Tuple(Type):
    def __init__(self, types: tuple[Type, ...]) -> None: ...

class Buffer(Type):
    dtype: Type
    ndim: int
    layout: str

class Array(Buffer):
    def __init__(self, dtype: Type, ndim: int, layout: str, readonly: bool = False) -> None: ...

class StringLiteral(Type):
    literal_value: str

class IterableType(Type): ...

class SimpleIteratorType(Type):
    def __init__(self, name: str, yield_type: Type | None) -> None: ...

int8: Type
uint8: Type
int16: Type
uint16: Type
int32: Type
uint32: Type
int64: Type
uint64: Type
intp: Type
void: Type
voidptr: Type

boolean: Type
float32: Type
float64: Type
