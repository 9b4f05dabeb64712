from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from llvmlite import ir
from numba.core.base import BaseContext
from numba.core.datamodel import models as models
from numba.core.typing.templates import AttributeTemplate, Signature
from numba.types import Type

_Function = TypeVar("_Function", bound=Callable[..., Any])
_Class = TypeVar("_Class", bound=type)

Codegen = Callable[[BaseContext, ir.IRBuilder, Signature, list[ir.Value]], ir.Value]
Implementation = tuple[Signature, Codegen]

def intrinsic(function: Callable[..., Implementation]) -> Callable[..., int]: ...
def register_model(type_: type[Type]) -> Callable[[_Class], _Class]: ...
def infer_getattr(template: type[AttributeTemplate]) -> type[AttributeTemplate]: ...
def lower_getattr_generic(type_: type[Type]) -> Callable[[_Function], _Function]: ...
def lower_setattr_generic(type_: type[Type]) -> Callable[[_Function], _Function]: ...
def lower_builtin(name: str, *types: type[Type]) -> Callable[[_Function], _Function]: ...
def overload(function: Callable[..., Any]) -> Callable[[_Function], _Function]: ...
def overload_method(type_: type[Type], name: str, *, prefer_literal: bool = False) -> Callable[[_Function], _Function]: ...
def box(type_: type[Type]) -> Callable[[_Function], _Function]: ...
def unbox(type_: type[Type]) -> Callable[[_Function], _Function]: ...

class _TypeOf:
    def register(self, class_: type) -> Callable[[_Function], _Function]: ...

typeof_impl: _TypeOf

@dataclass
class NativeValue:
    value: ir.Value
    is_error: ir.Value
    cleanup: Callable[[], None]
