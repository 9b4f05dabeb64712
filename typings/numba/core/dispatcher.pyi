from collections.abc import Mapping

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
    overloads: Mapping[object, CompileResult]
