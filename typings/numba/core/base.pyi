from collections.abc import Callable

from llvmlite import ir
from numba.types import Type

class Made:
    data: ir.Value

class BaseContext:
    def make_array(self, array: Type) -> Callable[[BaseContext, ir.IRBuilder, ir.Value], Made]: ...
    def get_value_type(self, type: Type) -> ir.Type: ...
