from numba.core.typing.templates import Signature

class Type:
    def __call__(self, *args: Type) -> Signature: ...

class CPointer(Type):
    def __init__(self, dtype: Type) -> None: ...

class Array(Type):
    dtype: Type

uint8: Type
int64: Type
intp: Type

boolean: Type
float32: Type
float64: Type
