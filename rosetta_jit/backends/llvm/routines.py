"""Routines: statements in the place of a call, functions of the kernel's module, or functions that many programs have in common.

What is long and knows nothing of the holder - how to read an integer of many bytes, how to skip a field - is *common*: the same in all
programs. Each such routine is a module of its own, compiled once a machine, and programs only declare it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache

from llvmlite import ir

from rosetta_jit.backends.llvm import stmt as llvm_stmt
from rosetta_jit.backends.llvm.exits import Exit
from rosetta_jit.backends.llvm.expr import expression
from rosetta_jit.backends.llvm.frame import Frame, Parameters, new_function
from rosetta_jit.backends.llvm.lines import Lines
from rosetta_jit.backends.llvm.values import I64, LLVM_TYPES, POINTER, constant
from rosetta_jit.backends.printing import emptied_lanes, statements
from rosetta_jit.kernel.ir import Kernel, Routine
from rosetta_jit.kernel.nodes import Call, For, While
from rosetta_jit.kernel.routines import called_routines, named_lanes
from rosetta_jit.startup.dataclass import dataclass
from rosetta_jit.startup.sha import sha256

MANY = 64
"""Calls of a routine from which on it stays a function: LLVM takes more than linear time on what it inlines."""

SEVERAL = 4
"""The same for a routine that loops whatever it is given: the rounds cost more than the call, and LLVM makes vectors of each loop."""

OFTEN = 16
"""Calls from which on a tiny routine stays a function if it begins with a call: that is made anyway."""

TINY, SHORT = 8, 24
"""Statements up to which a routine is part of its callers: if it does not loop, and if its callers are not many."""

MAX_COMMON = 128
"""Common routines that a process remembers, of some KB each. They differ by the number of the lane for notes."""

Printed = Mapping[str, "ir.Function | Routine"]
"""What calls of a kernel's routines become, by their names: calls of functions, or the routine's statements."""


@dataclass(frozen=True, slots=True)
class Common:
    """A common routine: its symbol, a module that defines it, as text, and what else this module declares."""

    symbol: str
    text: str
    declares: frozenset[str]


def routines_of(module: ir.Module, kernel: Kernel, name: str, *, whole: bool) -> Printed:
    """The routines that a kernel's bodies call; common ones are only declared, unless the module is to be ``whole``."""
    common = {} if whole else _common_routines(kernel)
    calls, printed = _calls(kernel, common), dict[str, "ir.Function | Routine"]()
    for routine in kernel.routines:
        if routine.name in common:
            printed[routine.name] = _empty(module, routine, common[routine.name].symbol)
        elif _is_in_place(routine, calls[routine.name]):
            printed[routine.name] = routine
        elif calls[routine.name]:
            function = printed[routine.name] = _define(_empty(module, routine, f"{name}.{routine.name}"), kernel, routine, printed)
            function.linkage = "internal"
            if calls[routine.name] >= _many(routine):
                function.attributes.add("noinline")
    return printed


def _calls(kernel: Kernel, common: Mapping[str, Common]) -> Counter[str]:
    """How often each routine will be called in what is printed."""
    calls = Counter(each.routine for body in kernel.bodies for each in statements(body) if isinstance(each, Call))
    for routine in reversed(kernel.routines):  # which call those before them
        if routine.name in common or not calls[routine.name]:
            continue
        times = calls[routine.name] if _is_in_place(routine, calls[routine.name]) else 1
        for each in statements(routine.body):
            if isinstance(each, Call):
                calls[each.routine] += times
    return calls


def _is_in_place(routine: Routine, calls: int) -> bool:
    """Whether a routine is printed where it is called. LLVM could do that, but would have results and failures to take apart again."""
    parts = statements(routine.body)
    if calls >= OFTEN and isinstance(routine.body[0], Call):
        return False
    is_tiny = len(parts) <= TINY and not any(isinstance(each, For | While) for each in parts)
    return is_tiny or (len(parts) <= SHORT and calls < _many(routine))


def _many(routine: Routine) -> int:
    """Calls from which on a routine stays a function."""
    return SEVERAL if any(isinstance(each, For | While) for each in routine.body) else MANY


def _empty(module: ir.Module, routine: Routine, name: str) -> ir.Function:
    """A function that returns 0 and a routine's results, or the number of the failure and its offset."""
    outcome = ir.LiteralStructType([I64] * (1 + max(1, len(routine.results))))
    signature = ir.FunctionType(outcome, [POINTER, I64, I64, POINTER, *(LLVM_TYPES[each.type] for each in routine.parameters)])
    return new_function(module, signature, name, ("buffer", "begin", "end", "state", *(each.name for each in routine.parameters)))


def _define(function: ir.Function, kernel: Kernel, routine: Routine, printed: Printed) -> ir.Function:
    """Print a routine's statements into its function."""
    outcome = function.function_type.return_type
    entry = Lines(function.append_basic_block("entry"))
    first = function.append_basic_block("body")
    parameters = Parameters(*function.args[:4], row=constant(0))
    done, failed = Exit.new(entry, "done", len(routine.results)), Exit.new(entry, "failed", 2)
    lanes, emptied = (kernel.strides, kernel.lanes), emptied_lanes(kernel)
    frame = Frame(function.module, entry, entry.beside(first), parameters, *lanes, {}, done, failed, emptied, printed)
    frame.locals.update(zip(("begin", "end"), function.args[1:3], strict=True))
    frame.locals.update(zip((each.name for each in routine.parameters), function.args[4:], strict=True))
    llvm_stmt.block(frame, routine.body)
    frame.done.enter(frame.builder, [expression(frame, each) for each in routine.results])
    entry.branch(first)
    _give(frame.done, outcome, (constant(0), *frame.done.phis))
    if failed.is_reached:
        _give(failed, outcome, failed.phis)
    else:
        failed.drop()
    return function


def _give(target: Exit, outcome: ir.Type, values: Sequence[ir.Value]) -> None:
    builder = ir.IRBuilder(target.block)
    whole: ir.Value = ir.Constant(outcome, None)
    for number, value in enumerate(values):
        whole = builder.insert_value(whole, value, number)
    builder.ret(whole)


# --- common routines ---------------------------------------------------------------------------------------------------

_declared: dict[str, Common] = {}
"""Those that programs of this process have declared of late, by their symbols."""


def common_routine(symbol: str) -> Common | None:
    """The common routine of a symbol; None if it stands for something else."""
    return _declared.get(symbol)


def _common_routines(kernel: Kernel) -> dict[str, Common]:
    """The routines of a kernel that are common, by their names: they know no lane but the one for notes, behind those of the fields."""
    notes = kernel.lanes - 1
    strides = (*[0] * notes, *kernel.strides[notes:])
    knowing, known, common = set[str](), dict[str, Routine](), dict[str, Common]()
    for routine in kernel.routines:
        called = called_routines(routine.body)
        known[routine.name] = routine
        if any(lane < notes for lane in named_lanes(routine)) or not knowing.isdisjoint(called):
            knowing.add(routine.name)
        elif len(statements(routine.body)) > SHORT:
            below = _below(called, known)
            common[routine.name] = _common(routine, tuple(each for each in kernel.routines if each.name in below), strides, kernel.lanes)
    for each in common.values():
        _declared.setdefault(each.symbol, each)
    while len(_declared) > MAX_COMMON + len(common):
        _declared.pop(next(iter(_declared)), None)
    return common


def _below(called: Sequence[str], known: Mapping[str, Routine]) -> set[str]:
    """The names of routines that are called, and of those that they call, and so on."""
    found, waiting = set[str](), [*called]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += called_routines(known[name].body)
    return found


@lru_cache(maxsize=MAX_COMMON)
def _common(routine: Routine, below: tuple[Routine, ...], strides: tuple[int, ...], lanes: int) -> Common:
    """A routine that calls others, as a module of its own, for kernels of so many lanes of the holder's."""
    around = Kernel(routine.name, "size", strides, (routine.body,), (), below, hidden=len(strides) - lanes)  # which empties no lane
    module = ir.Module("routine")
    printed = routines_of(module, around, "routine", whole=False)
    function = _define(_empty(module, routine, "routine"), around, routine, printed)
    text = str(module)
    symbol = f"rosetta_{routine.name}_{sha256(text.encode()).hexdigest()[:16]}"
    declares = frozenset(each.name for each in module.functions if not each.blocks)
    return Common(symbol, text.replace(function.get_reference(), f'@"{symbol}"'), declares)
