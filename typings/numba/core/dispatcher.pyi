from collections.abc import Mapping
from typing import Any

class Library:
    def get_llvm_str(self) -> str: ...

class FunctionDescriptor:
    mangled_name: str

class Signature:
    return_type: object

class CompileResult:
    signature: Signature
    library: Library
    fndesc: FunctionDescriptor

class Dispatcher:
    def __call__(self, *args: object) -> Any: ...
    overloads: Mapping[object, CompileResult]
