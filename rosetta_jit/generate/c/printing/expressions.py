"""Kernel expressions as C expressions of exactly their type.

C computes narrow integers as `int`, so that what is narrower than that is cast back. What C leaves undefined or to the implementation, as
shifts of negative numbers, goes through the other signedness or through a function of `support.c`.
"""

from __future__ import annotations

from string import Template
from typing import TYPE_CHECKING, assert_never

from rosetta_jit.generate.c.holder.within import element_of
from rosetta_jit.generate.c.printing.literals import constant
from rosetta_jit.generate.c.words import C_ROWS, C_TYPES
from rosetta_jit.generate.parentheses import bare
from rosetta_jit.kernel import nodes
from rosetta_jit.kernel.arithmetic import FLOATS, SIGNED
from rosetta_jit.kernel.terms import END, type_of

if TYPE_CHECKING:
    from rosetta_jit.generate.c.printing.scope import Scope

BITWISE = {"and": "&", "or": "|", "xor": "^", "shr": ">>"}
OPERATORS = {"add": "+", "wrapping_add": "+", "sub": "-", "mul": "*", "div": "/", "rem": "%", **BITWISE}
LOGICAL = {"and": "&&", "or": "||", "xor": "!="}
COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
OF_FLOATS = {"abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil", "trunc": "trunc", "rint": "rint"}
"""Functions of `math.h`; those of single precision end in ``f``."""
FMOD = {"rem": "fmod"}


def expression(scope: Scope, expr: nodes.Expr) -> str:
    """The text of an expression; one with an operator stands in parentheses."""
    match expr:
        case nodes.Const(type_, value):
            return constant(scope, type_, value)
        case nodes.Local(_, name):
            return scope.takes("end") if name == END.name else scope.locals.identifier(name)
        case nodes.Load(type_, at, order):
            return _loaded(scope, type_, expression(scope, at), order)
        case nodes.Get(type_, place):
            return read(scope, type_, place)
        case nodes.Used() | nodes.Capacity() | nodes.HostValue() | nodes.Register():
            return _about_the_holder(scope, expr)
        case nodes.Unary(function, operand):
            return _unary(scope, function, type_of(operand), _wide(scope, operand))
        case nodes.Binary(op, left, right):
            return _binary(scope, op, left, right)
        case nodes.Compare(op, left, right):
            return f"({' '.join(_operands(scope, left, COMPARISONS[op], right))})"
        case nodes.Fits(op, left, right):
            return f"{scope.calls(f'fits_{op}')}({expression(scope, left)}, {expression(scope, right)})"
        case nodes.Convert(type_, operand):
            return _convert(scope, type_, operand)
        case nodes.Bits(type_, operand):
            return _bits(scope, type_, operand)
        case nodes.Select(condition, then, otherwise):
            chosen = f"({expression(scope, condition)} ? {expression(scope, then)} : {expression(scope, otherwise)})"
            return _cast(scope, C_TYPES[type_of(then)], chosen) if nodes.WIDTH[type_of(then)] < 4 else chosen
        case nodes.IsText(address, size):
            return _is_text(scope, address, size)
        case nodes.Nearest() | nodes.Digits() | nodes.Scale():
            return _decimal(scope, expr)
        case nodes.Lookup(type_, values, index):
            return f"{scope.table(type_, values)}[{bare(expression(scope, index))}]"
        case _:
            assert_never(expr)


def _is_text(scope: Scope, address: nodes.Address, size: nodes.Expr) -> str:
    """Whether bytes are a text. In C++ the header that all units share says so, at once of ASCII."""
    arguments = ", ".join((*location(scope, address), expression(scope, size)))
    if scope.lanes.dialect == "c++":
        return f"(rosetta_jit::detail::is_ascii({arguments}) || rosetta_jit::detail::is_text({arguments}))"
    return f"{scope.calls('is_text')}({arguments})"


def _about_the_holder(scope: Scope, expr: nodes.Known) -> str:
    match expr:
        case nodes.Used(lane):
            return scope.used(lane)
        case nodes.Capacity(lane):
            return scope.capacity(lane)
        case nodes.HostValue(what):
            return f"{scope.takes('holder')}->{what}"
        case nodes.Register(number):
            return scope.register(number)
        case _:
            assert_never(expr)


def _is_wide(expr: nodes.Expr) -> bool:
    """Whether C takes what is printed for more than an int."""
    match expr:
        case nodes.Const(type_, value):
            return type_ in ("i64", "u64") and not -(2**31) < value < 2**31
        case nodes.Binary(op, left, right):
            return _is_wide(left) or (op != "shr" and _is_wide(right))
        case nodes.Select(_, then, otherwise):
            return _is_wide(then) or _is_wide(otherwise)
        case _:
            return True


def _operands(scope: Scope, left: nodes.Expr, operator: str, right: nodes.Expr) -> tuple[str, str, str]:
    """Both sides of an operator, of which one has the type of both."""
    return expression(scope, left) if _is_wide(right) else _wide(scope, left), operator, expression(scope, right)


def _binary(scope: Scope, op: str, left: nodes.Expr, right: nodes.Expr) -> str:
    type_ = type_of(left)
    if type_ == "bool" and op in LOGICAL:
        return f"({expression(scope, left)} {LOGICAL[op]} {expression(scope, right)})"
    if op in ("min", "max"):
        return f"{scope.calls(f'{op}_{type_}')}({expression(scope, left)}, {expression(scope, right)})"
    if type_ in FLOATS and op in ("rem", "atan2"):
        scope.calls("math")
        return f"{FMOD.get(op, op)}{'f' if type_ == 'f32' else ''}({expression(scope, left)}, {expression(scope, right)})"
    if op in ("shl", "shr"):
        return _shifted(scope, op, type_, _wide(scope, left), expression(scope, right))
    return _narrowed(scope, type_, f"({' '.join(_operands(scope, left, OPERATORS[op], right))})")


def _wide(scope: Scope, expr: nodes.Expr) -> str:
    """An expression that C takes for what it is."""
    if isinstance(expr, nodes.Const):
        return constant(scope, expr.type, expr.value, wide=True)
    text = expression(scope, expr)
    return text if _is_wide(expr) or type_of(expr) not in ("i64", "u64") else _cast(scope, C_TYPES[type_of(expr)], text)


def _shifted(scope: Scope, op: str, type_: nodes.Scalar, left: str, right: str) -> str:
    """High bits that leave are those of an unsigned number: of a signed one C does not say what becomes of it."""
    if op == "shr":
        return _narrowed(scope, type_, f"({left} >> {right})")
    unsigned = "uint64_t" if nodes.WIDTH[type_] == 8 else "uint32_t"
    shifted = f"({_cast(scope, unsigned, left)} << {right})"
    return shifted if C_TYPES[type_] == unsigned else _cast(scope, C_TYPES[type_], shifted)


def _narrowed(scope: Scope, type_: nodes.Scalar, text: str) -> str:
    """C computes what is narrower than an int as an int."""
    return _cast(scope, C_TYPES[type_], text) if nodes.WIDTH[type_] < 4 and type_ != "bool" else text


def _cast(scope: Scope, name: str, value: str) -> str:
    """A value as one of another type: headers of C++ have casts that compilers do not warn of."""
    return f"static_cast<{name}>({bare(value)})" if scope.lanes.shared else f"({name}){value}"


def _unary(scope: Scope, function: str, type_: nodes.Scalar, value: str) -> str:
    match function:
        case "not" if type_ == "bool":
            return f"(!{value})"
        case "not":
            return _narrowed(scope, type_, f"(~{value})")
        case "neg":
            return _narrowed(scope, type_, f"(-{value})")
        case "abs" if type_ in SIGNED:
            return f"{scope.calls(f'abs_{type_}')}({value})"
        case _ if type_ not in FLOATS:
            return value
        case _:
            scope.calls("math")
            return f"{OF_FLOATS.get(function, function)}{'f' if type_ == 'f32' else ''}({value})"


def _convert(scope: Scope, target: nodes.Scalar, operand: nodes.Expr) -> str:
    source, value = type_of(operand), expression(scope, operand)
    if target == source:
        return value
    if target == "bool":
        return f"({value} != {constant(scope, source, 0)})"
    if source in FLOATS and target not in FLOATS:
        return f"{scope.calls(f'{target}_of_{source}')}({value})"
    return _cast(scope, C_TYPES[target], value)


def _bits(scope: Scope, target: nodes.Scalar, operand: nodes.Expr) -> str:
    source, value = type_of(operand), expression(scope, operand)
    if source == target:
        return value
    width = 8 * nodes.WIDTH[source]
    if source in FLOATS:
        value = f"{scope.calls(f'bits_of_f{width}')}({value})"
        return value if target == f"u{width}" else _cast(scope, C_TYPES[target], value)
    if target in FLOATS:
        return f"{scope.calls(f'float{width}_of')}({_cast(scope, f'uint{width}_t', value)})"
    return _cast(scope, C_TYPES[target], value)


def _decimal(scope: Scope, expr: nodes.Nearest | nodes.Digits | nodes.Scale) -> str:
    scope.calls("decimals")
    match expr:
        case nodes.Nearest(address, size, exponent):
            memory, start = location(scope, address)
            return f"nearest({memory}, {start}, {expression(scope, size)}, {expression(scope, exponent)})"
        case nodes.Digits(value, None):
            return f"shortest_digits({expression(scope, value)}, {_is_single(value)})"
        case nodes.Digits(value, places):
            return f"fixed_digits({expression(scope, value)}, {places})"
        case nodes.Scale(value):
            return f"shortest_scale({expression(scope, value)}, {_is_single(value)})"
        case _:
            assert_never(expr)


def _is_single(value: nodes.Expr) -> str:
    return "true" if type_of(value) == "f32" else "false"


# --- memory ------------------------------------------------------------------------------------------------------------


def _loaded(scope: Scope, type_: nodes.Scalar, at: str, order: str) -> str:
    return f"{scope.calls(f'load_{type_}{_suffix(type_, order)}')}({scope.takes('bytes')} + {at})"


def _suffix(type_: nodes.Scalar, order: str) -> str:
    """The byte order in the name of a function; single bytes have none."""
    return "" if nodes.WIDTH[type_] == 1 else "_le" if order == "<" else "_be"


def store(scope: Scope, at: nodes.Expr, value: nodes.Expr, order: str) -> str:
    """A statement that writes a scalar to the message."""
    type_ = type_of(value)
    name = scope.calls(f"store_{type_}{_suffix(type_, order)}")
    return f"{name}({scope.takes('bytes')} + {expression(scope, at)}, {expression(scope, value)});"


def read(scope: Scope, type_: nodes.Scalar, place: nodes.Place) -> str:
    """A field of a row: by its name, or where the schema has no such field by its bytes."""
    named = _field(scope, place, type_)
    if named is not None:
        return f"({named} != 0)" if type_ == "bool" else named
    return f"{scope.calls(f'get_{type_}')}({', '.join(location(scope, place))})"


def written(scope: Scope, place: nodes.Place, value: nodes.Expr) -> str:
    """A statement that sets a field of a row."""
    type_, text = type_of(value), expression(scope, value)
    named = _field(scope, place, type_)
    if named is None:
        return f"{scope.calls(f'set_{type_}')}({', '.join(location(scope, place))}, {text});"
    if type_ == "bool":
        return f"{named} = (uint8_t)({bare(text)} ? 1 : 0);"
    return f"{named} = {bare(text)};"


def list_within(scope: Scope, lane: int, row: nodes.Expr) -> tuple[str, str]:
    """What shows the list within another one that a row is in, and the number of its element."""
    within = scope.lanes.within[lane]
    found = element_of(row, within)
    assert found is not None, row
    start, number = (bare(expression(scope, each)) for each in found)
    return f"{within.view}::at({start})", number


def _field(scope: Scope, place: nodes.Place, type_: nodes.Scalar) -> str | None:
    if place.lane in scope.lanes.within:
        view, number = list_within(scope, place.lane, place.row)
        shown = scope.lanes.shown.get((place.lane, place.offset), f"$list[$index]{scope.lanes.path(place.lane, place.offset, type_)}")
        return Template(shown).substitute(type=C_ROWS[type_], index=number, list=view)
    row = bare(expression(scope, place.row))
    found = scope.lanes.field(place.lane, row, place.offset, type_)
    shown = None if found is None else scope.lanes.shown.get((place.lane, place.offset))
    if shown is None or place.lane:
        scope.rows(place.lane)
    if shown is None:
        return found
    scope.takes("given_object")
    return Template(shown).substitute(type=C_ROWS[type_], index=row)


def location(scope: Scope, address: nodes.Address) -> tuple[str, str]:
    """Memory, and the number of a byte in there."""
    match address:
        case nodes.Wire(at):
            return scope.takes("bytes"), bare(expression(scope, at))
        case nodes.Place(lane, row, offset):
            stride = 1 if lane in scope.lanes.addressed else scope.lanes.stride(lane)
            start = _scaled(scope, row, stride)
            if offset:
                start = str(offset) if start == "0" else f"{start} + {offset}"
            if lane in scope.lanes.addressed:
                return f"reinterpret_cast<const unsigned char *>(static_cast<std::uintptr_t>({start}))", "0"
            return scope.rows(lane), start
        case _:
            assert_never(address)


def _scaled(scope: Scope, row: nodes.Expr, stride: int) -> str:
    if isinstance(row, nodes.Const):
        return str(int(row.value) * stride)
    text = expression(scope, row)
    return bare(text) if stride == 1 else f"{text} * {stride}"
