from collections.abc import Callable
from typing import Any, overload

from numba import types as types
from numba.core.dispatcher import Dispatcher
from numba.core.typing.templates import Signature

@overload
def njit(
    signature: Signature,
    *,
    error_model: str = "python",
    nogil: bool = False,
    no_cpython_wrapper: bool = False,
    no_cfunc_wrapper: bool = False,
) -> Callable[[Callable[..., Any]], Dispatcher]: ...
@overload
def njit(*, error_model: str = "python", nogil: bool = False, forceinline: bool = False) -> Callable[[Callable[..., Any]], Dispatcher]: ...
