"""A unit as an object file and one header, whose part behind ``#ifdef NAME_IMPLEMENTATION`` calls what is in the object.

The kernels there have the words of `kernel.state` as their holder: the calls fill them in, and read what they say.
"""

from __future__ import annotations

from rosetta_jit.backends.entry.any_machine import TargetError, object_for
from rosetta_jit.backends.printing import Writer
from rosetta_jit.catalogue import generate as words
from rosetta_jit.errors import SchemaError
from rosetta_jit.generate.c.holder.lanes import Lanes
from rosetta_jit.generate.c.language import as_c
from rosetta_jit.generate.c.printing.functions import Attempt, Printed
from rosetta_jit.generate.c.state import MEMBERS
from rosetta_jit.generate.unit import Role, Unit, kind_of
from rosetta_jit.kernel import state
from rosetta_jit.kernel.ir import Kernel

SIGNATURE = "int64_t {name}(const unsigned char *bytes, int64_t begin, int64_t end, int64_t *state, int64_t row);"
"""What an encoder writes to is the message of its caller, who does not have it as a constant."""


def files_for(unit: Unit, triple: str, cpu: str) -> dict[str, str | bytes]:
    """``NAME.h`` and ``NAME.o``.

    Raises
    ------
    SchemaError
        There is no object for such a machine, or the mapping calls functions that its user writes.
    """
    for function in unit.functions:
        raise SchemaError((words.not_in_object(function.name),))
    kernels = {symbol(unit.name, role): kernel for role, kernel in unit.kernels.items()}
    try:
        code = object_for(kernels, triple, cpu)
    except TargetError as error:
        raise SchemaError((words.no_target(triple, str(error)),)) from error
    texts = as_c(unit, print_call)
    header, source = texts[f"{unit.name}.h"], texts[f"{unit.name}.c"]
    calls = source.replace(f'#include "{unit.name}.h"\n', "")
    macro = f"{unit.name.upper()}_IMPLEMENT"
    refused = f'#ifdef __cplusplus\n#error "what follows is C: define {macro}ATION in a file of C"\n#else\n'
    guarded = f"#if defined({macro}ATION) && !defined({macro}ED)\n#define {macro}ED\n{refused}\n{calls}\n#endif\n#endif\n"
    return {f"{unit.name}.h": f"{header}\n{guarded}", f"{unit.name}.o": code}


def symbol(name: str, role: Role) -> str:
    """What a kernel is called in the object."""
    return f"{name}_{role}_kernel"


def print_call(kernel: Kernel, lanes: Lanes, role: Role) -> Printed:
    """A function that calls the kernel in the object."""
    writer, name, decodes = Writer(), symbol(lanes.prefix, role), kernel.direction == "decode"
    hidden, own = range(len(lanes.all) - lanes.own), range(1, lanes.own)
    writer.line(SIGNATURE.format(name=name))
    writer.line()
    parameters = ("holder", "failure") if role == "size" else ("holder", "bytes", "end", "failure")
    declared = {
        "holder": f"{'' if decodes else 'const '}{lanes.prefix}_holder *holder",
        "bytes": "const unsigned char *bytes",
        "end": "int64_t end",
        "failure": "struct failure *failure",
    }
    writer.line(f"static int64_t {role}_message({', '.join(declared[each] for each in parameters)})")
    with writer.indented("{"):
        writer.line(f"int64_t state[{state.state_words(kernel.lanes)}] = {{0}};")
        writer.line(f"int64_t hidden[{state.LANE_WORDS * max(1, len(hidden) - 1)}] = {{0}};")
        _give_lanes(writer, kernel, lanes, decodes=decodes)
        if kernel.registers:
            _pointer(writer, f"state[{state.REGISTERS}]", "registers", f"holder->state->{MEMBERS[kind_of(role)]}", "int64_t")
        writer.line(f"const int64_t result = {name}({'NULL, 0, INT64_C(1) << 60' if role == 'size' else 'bytes, 0, end'}, state, 0);")
        _tell_failure(writer, kernel, lanes)
        for lane in own if decodes else ():
            writer.line(f"holder->{lanes.rows(lane)}.used = state[{state.lane_word(lane, state.USED)}];")
        writer.line("return result;")
    writer.line("}")
    attempt = Attempt(f"{role}_message", parameters)
    support = frozenset(("failure", "bytes_of") if hidden else ("failure",))
    return Printed(writer.text(), (attempt,), tuple(range(len(kernel.sites))), support, frozenset(hidden))


def _give_lanes(writer: Writer, kernel: Kernel, lanes: Lanes, *, decodes: bool) -> None:
    """The words of the holder's lanes, of the scratch lane behind them, and of those that the holder does not have."""
    _pointer(writer, f"state[{state.lane_word(0, state.ADDRESS)}]", "rows_0", "&holder->message")
    writer.line(f"state[{state.lane_word(0, state.CAPACITY)}] = 1;")
    writer.line(f"state[{state.lane_word(0, state.USED)}] = 1;")
    for lane in range(1, lanes.own):
        member = f"holder->{lanes.rows(lane)}"
        _pointer(writer, f"state[{state.lane_word(lane, state.ADDRESS)}]", f"rows_{lane}", f"{member}.rows")
        writer.line(f"state[{state.lane_word(lane, state.CAPACITY)}] = {member}.capacity;")
        if not decodes:
            writer.line(f"state[{state.lane_word(lane, state.USED)}] = {member}.used;")
    for number in range(len(lanes.all) - lanes.own):
        first = (
            f"state[{state.lane_word(lanes.own, state.ADDRESS)}]"
            if number == 0
            else f"hidden[{state.LANE_WORDS * (number - 1) + state.ADDRESS}]"
        )
        room = (
            f"state[{state.lane_word(lanes.own, state.CAPACITY)}]"
            if number == 0
            else f"hidden[{state.LANE_WORDS * (number - 1) + state.CAPACITY}]"
        )
        _pointer(writer, first, f"scratch_{number}", f"holder->scratch[{number}].bytes")
        writer.line(f"{room} = holder->scratch[{number}].size{f' / {lanes.stride(lanes.own)}' if number == 0 else ''};")
    _pointer(writer, f"state[{state.HIDDEN}]", "hidden_words", "hidden", "int64_t")
    writer.line(f"state[{state.HIDDEN_COUNT}] = {kernel.hidden};")
    writer.line(f"state[{state.NOW}] = holder->now;")
    writer.line(f"state[{state.NUMBER}] = holder->number;")


def _pointer(writer: Writer, word: str, name: str, value: str, type_: str = "void") -> None:
    """A word that holds an address, whatever the size of addresses is."""
    writer.line(f"const {type_} *const {name} = {value};")
    writer.line(f"memcpy(&{word}, &{name}, sizeof {name});")


def _tell_failure(writer: Writer, kernel: Kernel, lanes: Lanes) -> None:
    with writer.indented("if (result < 0) {"):
        writer.line("failure->site = (ptrdiff_t)(-1 - result);")
        writer.line(f"failure->offset = state[{state.ERROR_OFFSET}];")
        writer.line(f"memcpy(failure->indices, &state[{state.ERROR_INDICES}], {state.INDEX_WORDS} * sizeof state[0]);")
    writer.line("}")
    with writer.indented("if (result == -1) {"):
        writer.line(f"failure->offset = state[{state.GROW_LANE}];")
        writer.line(f"failure->indices[0] = state[{state.GROW_ROWS}];")
        if len(lanes.all) > lanes.own:
            with writer.indented(f"if (failure->offset == {lanes.own}) {{"):
                writer.line(f"failure->indices[0] = bytes_of(failure->indices[0], {kernel.strides[lanes.own]});")
            writer.line("}")
    writer.line("}")
