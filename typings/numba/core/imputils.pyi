from collections.abc import Callable
from enum import Enum
from typing import Any, TypeVar

from llvmlite import ir
from numba.core.base import BaseContext
from numba.types import Type

_Function = TypeVar("_Function", bound=Callable[..., Any])

class RefType(Enum):
    NEW = 1

class IternextResult:
    def set_valid(self, is_valid: ir.Value) -> None: ...
    def yield_(self, value: ir.Value) -> None: ...

def iternext_impl(ref_type: RefType) -> Callable[[_Function], _Function]: ...
def impl_ret_borrowed(context: BaseContext, builder: ir.IRBuilder, type: Type | None, value: ir.Value) -> ir.Value: ...
def impl_ret_new_ref(context: BaseContext, builder: ir.IRBuilder, type: Type | None, value: ir.Value) -> ir.Value: ...
