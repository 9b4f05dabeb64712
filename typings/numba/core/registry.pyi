from typing import Any

from numba.core.dispatcher import Dispatcher

class CPUDispatcher(Dispatcher):
    py_func: Any
    targetoptions: dict[str, Any]
    locals: dict[str, Any]
