"""Arrays in another order: which element of a field stands where, as axes with steps.

    View = array, Axis*, first, what follows each element          Axis = count, step | count, step, listed numbers

Element `(i, j, …)` of a view is element `first + i * step + j * step + …` of its array; the last axis runs fastest. A plain
array has one axis of step 1. Slices and `reversed` change an axis; `transposed`, `planar` and `rows` split axes and put them in
another order. All numbers are expressions of the mapping, computed when the kernel runs; those that are known fold.

| call                              | gives                                                    | packs as                          |
|-----------------------------------|----------------------------------------------------------|-----------------------------------|
| `reversed(a)`                     | the last element first                                   | `reversed(b)`                     |
| `reversed(a, k)`                  | each group of `k` reversed                               | `reversed(b, k)`                  |
| `permuted(a, [2, 0, 1])`          | each group of 3 in this order                            | `permuted(b, [1, 2, 0])`          |
| `transposed(a, r, c, k)`          | `r` rows of `c` elements of `k`, column by column        | `transposed(b, c, r, k)`          |
| `planar(a, c, k)`                 | channel by channel; `c` channels of `k` lay side by side | `interleaved(b, c, k)`            |
| `interleaved(a, c, k)`            | side by side; `c` channels of `k` lay one after another  | `planar(b, c, k)`                 |
| `rows(a, n, size, stride)`        | `n` rows of `size` that begin `stride` apart, end to end | `padded_rows(b, n, size, stride)` |
| `padded_rows(a, n, size, stride)` | `n` rows, with zeros from `size` to `stride` behind each | `rows(b, n, size, stride)`        |
| `numbers(a, float32, big)`        | the numbers whose bytes these are                        | `number_bytes(b, float32, big)`   |
| `number_bytes(a, float32, big)`   | the bytes of numbers (`language.arrays.number_bytes`)    | `numbers(b, float32, big)`        |
| `upper_triangle(a, n)`            | of `n` rows of `n`, what stands in or right of the diagonal | `symmetric(b, n)`              |
| `symmetric(a, n)`                 | `n` rows of `n` that are the same as its columns         | `upper_triangle(b, n)`            |
"""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

from rosetta_jit.catalogue import layouts as words
from rosetta_jit.language.arrays.array_functions import ARGUMENTS, NUMBERS
from rosetta_jit.language.arrays.counts import ONE, ZERO, LayoutError, folded, minus, over, plus, times
from rosetta_jit.language.arrays.put_back import listed_numbers
from rosetta_jit.language.limits import MAX_LISTED
from rosetta_jit.model.expr import Binary, Call, Each, Expr, Len, List, Literal, Name, Path, Pick, Slice, Step
from rosetta_jit.startup.dataclass import dataclass, replace
from rosetta_jit.startup.late import Late

if TYPE_CHECKING:
    from rosetta_jit.language import folding
else:
    folding = Late("rosetta_jit.language.folding")


@dataclass(frozen=True, slots=True)
class Axis:
    """``count`` elements, ``step`` apart; with ``listed``, those of these numbers times ``step``."""

    count: Expr
    step: Expr
    listed: tuple[int, ...] | None = None


@dataclass(frozen=True, slots=True)
class NumberType:
    """The type of numbers that lie in bytes; the high byte of each comes first where the condition ``big`` holds."""

    name: str
    big: Expr

    @property
    def size(self) -> Literal:
        """How many bytes each number has."""
        return Literal(SIZES[self.name])


@dataclass(frozen=True, slots=True)
class View:
    """Elements of an array in some order, and the steps that follow each. ``refused`` is what must not hold, and why.

    Where the elements are numbers within an array of bytes, ``number`` is their type, and an element begins at the byte that the axes say.
    """

    array: Path
    axes: tuple[Axis, ...]
    first: Expr = ZERO
    rest: tuple[Step, ...] = ()
    refused: tuple[tuple[Expr, str], ...] = ()
    number: NumberType | None = None

    @property
    def total(self) -> Expr:
        """How many elements there are."""
        return reduce(times, (axis.count for axis in self.axes))


def view_of(expr: Path | Call) -> View:
    """What a path to many elements, or a function of one, stands for; raises LayoutError."""
    if isinstance(expr, Path):
        return _of_path(expr)
    if expr.function not in ARGUMENTS:
        raise LayoutError(words.not_an_array(expr.span))
    least, most = ARGUMENTS[expr.function]
    if not least <= len(expr.arguments) <= most:
        raise LayoutError(words.arguments(expr.span, expr.function, least, most, len(expr.arguments)))
    array, *arguments = expr.arguments
    if not isinstance(array, Path | Call):
        raise LayoutError(words.not_an_array(array.span))
    for argument in () if expr.function == NUMBERS else arguments:
        if isinstance(argument, Literal) and (type(argument.value) is not int or argument.value < 1):
            raise LayoutError(words.no_size(argument.span))
    return _called(expr, view_of(array), arguments)


def _of_path(path: Path) -> View:
    start = next((number for number, step in enumerate(path.steps) if isinstance(step, Slice | Pick | Each)), len(path.steps))
    array = replace(path, steps=path.steps[:start])
    view = View(array, (Axis(Len(array, path.span), ONE),))
    for number, step in enumerate(path.steps[start:], start):
        match step:
            case Slice():
                view = _sliced(view, step)
            case Pick(indices):
                view = _picked(view, indices, step)
            case Each():
                return replace(view, rest=path.steps[number + 1 :])
            case _:
                raise LayoutError(words.needs_each(step.span))
    return view


def _sliced(view: View, slice_: Slice) -> View:
    (axis,) = view.axes
    if axis.listed is not None:
        raise LayoutError(words.of_a_list(slice_.span))
    slice_ = replace(slice_, step=folding.folded(slice_.step))
    stop = axis.count if slice_.stop is None else slice_.stop
    if isinstance(slice_.step, Literal) and not (isinstance(slice_.step.value, int) and slice_.step.value > 0):
        raise LayoutError(words.slice_step(slice_.step.span))
    count, refused = minus(stop, slice_.start), view.refused
    if slice_.step != ONE:
        count = Binary("/", plus(count, minus(slice_.step, ONE)), slice_.step, slice_.span)
    known = [part.value for part in (slice_.start, stop) if isinstance(part, Literal) and isinstance(part.value, int)]
    match known:
        case [start, end] if end < start:
            raise LayoutError(words.empty_slice(slice_.span))
        case [_, _]:
            count = folded(count)
        case _:
            refused = (*refused, (Binary("<", stop, slice_.start, slice_.span), "the slice ends before it starts"))
    if not isinstance(slice_.step, Literal):
        refused = (*refused, (Binary("<", slice_.step, ONE, slice_.span), "the step of a slice is below 1"))
    return replace(
        view,
        axes=(Axis(count, times(axis.step, slice_.step)),),
        first=plus(view.first, times(slice_.start, axis.step)),
        refused=refused,
    )


def _picked(view: View, indices: tuple[int, ...], step: Pick) -> View:
    (axis,) = view.axes
    if axis.listed is not None:
        raise LayoutError(words.of_a_list(step.span))
    return replace(view, axes=(_listed(indices, axis.step, step),))


def _listed(indices: tuple[int, ...], step: Expr, where: Pick | List | Call) -> Axis:
    if len(indices) > MAX_LISTED:
        raise LayoutError(words.long_list(where.span, MAX_LISTED))
    return Axis(Literal(len(indices)), step, indices)


def _called(call: Call, view: View, arguments: list[Expr]) -> View:
    match call.function, arguments:
        case "reversed", []:
            return _reversed(view, range(len(view.axes)))
        case "reversed", [group]:
            return _reversed(_split(view, (group,), call), [-1])
        case "permuted", [order]:
            return _permuted(view, order, call)
        case "planar", [channels, *size]:
            return _planar(view, channels, *(size or [ONE]), call=call)
        case "interleaved", [channels, *size]:
            return _interleaved(view, channels, *(size or [ONE]), call=call)
        case "transposed", [rows, columns, *size]:
            return _transposed(view, rows, columns, *(size or [ONE]), call=call)
        case "rows", [count, size, stride]:
            return _rows(view, count, size, stride, call)
        case "numbers", _:
            return _numbers(view, number_type(call), call)
        case "upper_triangle" | "symmetric" as function, [size]:
            return _triangle(view, size, call, is_upper=function == "upper_triangle")
        case "number_bytes", _:
            raise LayoutError(words.bytes_inside(call.span))
        case _:
            raise LayoutError(words.padded_inside(call.span))


def _reversed(view: View, numbers: range | list[int]) -> View:
    axes, first = list(view.axes), view.first
    for number in numbers:
        axis = axes[number]
        if axis.listed is not None:
            axes[number] = replace(axis, listed=axis.listed[::-1])
            continue
        first = plus(first, times(minus(axis.count, ONE), axis.step))
        axes[number] = Axis(axis.count, folded(Binary("*", Literal(-1), axis.step, axis.step.span)))
    return replace(view, axes=tuple(axes), first=first)


def _permuted(view: View, order: Expr, call: Call) -> View:
    numbers = listed_numbers(order)
    if sorted(numbers) != list(range(len(numbers))) or not numbers:
        raise LayoutError(words.no_permutation(order.span))
    split = _split(view, (Literal(len(numbers)),), call)
    *outer, last = split.axes
    assert isinstance(order, List)
    listed = last.listed
    chosen = numbers if listed is None else tuple(listed[number] for number in numbers)  # groups that are permuted already
    return replace(split, axes=(*outer, _listed(chosen, last.step, order)))


def _planar(view: View, channels: Expr, size: Expr, *, call: Call) -> View:
    split = _split(view, (channels, size), call)
    *outer, channel, part = split.axes
    return replace(split, axes=_kept(channel, *outer, part))


def _interleaved(view: View, channels: Expr, size: Expr, *, call: Call) -> View:
    axis = _flat(view, call)
    pixels = over(axis.count, times(channels, size), call)
    apart = times(size, axis.step)
    axes = Axis(pixels, apart), Axis(channels, times(pixels, apart)), Axis(size, axis.step)
    return replace(view, axes=_kept(*axes))


def _transposed(view: View, rows: Expr, columns: Expr, size: Expr, *, call: Call) -> View:
    axis = _flat(view, call)
    apart, total = times(size, axis.step), times(times(rows, columns), size)
    axes = Axis(columns, apart), Axis(rows, times(columns, apart)), Axis(size, axis.step)
    refused = () if total == axis.count else ((Binary("!=", axis.count, total, call.span), "rows times columns are not all elements"),)
    return replace(view, axes=_kept(*axes), refused=(*view.refused, *refused))


def _rows(view: View, count: Expr, size: Expr, stride: Expr, call: Call) -> View:
    axis = _flat(view, call)
    axes = Axis(count, times(stride, axis.step)), Axis(size, axis.step)
    refused = () if stride == size else ((Binary("<", stride, size, call.span), "the rows overlap"),)
    return replace(view, axes=axes, refused=(*view.refused, *refused))


SIZES = {f"{kind}{bits}": bits // 8 for kind in ("int", "uint", "float") for bits in (8, 16, 32, 64) if kind != "float" or bits >= 32}
"""The types of numbers that lie in bytes, and how many bytes each has."""


def number_type(call: Call) -> NumberType:
    """The type that `numbers` or `number_bytes` names."""
    _, name, *big = call.arguments
    if not isinstance(name, Name) or name.name not in SIZES:
        raise LayoutError(words.no_number_type(name.span, SIZES))
    return NumberType(name.name, big[0] if big else Literal(value=False, span=call.span))


def _numbers(view: View, number: NumberType, call: Call) -> View:
    """Each group of so many bytes as one element, which begins where the group does."""
    *outer, last = view.axes
    if view.number is not None or last.listed is not None or last.step != ONE or view.rest:
        raise LayoutError(words.scattered_bytes(call.span))
    return replace(view, axes=_kept(*outer, Axis(over(last.count, number.size, call), number.size)), number=number)


def _triangle(view: View, size: Expr, call: Call, *, is_upper: bool) -> View:
    """The elements of a triangle of a square, row by row; or of the square that has it twice."""
    axis = _flat(view, call)
    if not isinstance(size, Literal):
        raise LayoutError(words.open_triangle(size.span))
    count = range(int(size.value))
    places = [(row, column) for row in count for column in count if row <= column]
    if is_upper:
        numbers = tuple(row * len(count) + column for row, column in places)
        total = len(count) ** 2
    else:
        numbers = tuple(places.index((min(row, column), max(row, column))) for row in count for column in count)
        total = len(places)
    wrong = (
        () if axis.count == Literal(total) else ((Binary("!=", axis.count, Literal(total), call.span), f"there are not {total} elements"),)
    )
    return replace(view, axes=(_listed(numbers, axis.step, call),), refused=(*view.refused, *wrong))


def _flat(view: View, call: Call) -> Axis:
    """The only axis of a view."""
    match view.axes:
        case (Axis(_, _, None) as axis,):
            return axis
        case _:
            raise LayoutError(words.not_flat(call.span, call.function))


def _split(view: View, sizes: tuple[Expr, ...], call: Call) -> View:
    """The last axis as one of groups and one for each size within; an axis of such a size is one of them as it is."""
    outer = [*view.axes]
    inner: list[Axis] = []
    for size in reversed(sizes):
        last = outer.pop()
        if last.count == size and outer:
            inner.insert(0, last)
            continue
        if last.listed is not None:
            raise LayoutError(words.of_a_list(call.span))
        inner.insert(0, Axis(size, last.step))
        outer.append(Axis(over(last.count, size, call), times(size, last.step)))
    return replace(view, axes=(*outer, *inner))


def _kept(*axes: Axis) -> tuple[Axis, ...]:
    """The axes without those of one element; one is left."""
    kept = tuple(axis for axis in axes if axis.count != ONE)
    return kept or axes[:1]
