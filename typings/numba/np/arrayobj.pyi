from collections.abc import Sequence

from llvmlite import ir
from numba.core.cgutils import StructProxy

def populate_array(
    array: StructProxy, data: ir.Value, shape: Sequence[ir.Value], strides: Sequence[ir.Value], itemsize: ir.Value, meminfo: ir.Value
) -> None: ...
