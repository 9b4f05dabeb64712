from collections.abc import Sequence

from llvmlite import ir
from numba.core.datamodel import DataModelManager
from numba.types import Type

class StructModel:
    def __init__(self, manager: DataModelManager, type_: Type, members: Sequence[tuple[str, Type]]) -> None: ...
    def from_argument(self, builder: ir.IRBuilder, value: object) -> object: ...
