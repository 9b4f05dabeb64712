from collections.abc import Callable

from llvmlite import ir
from numba.core.base import BaseContext
from numba.core.typing.templates import Signature

Codegen = Callable[[BaseContext, ir.IRBuilder, Signature, list[ir.Value]], ir.Value]
Implementation = tuple[Signature, Codegen]

def intrinsic(function: Callable[..., Implementation]) -> Callable[..., int]: ...
