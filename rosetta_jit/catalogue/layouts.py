"""What can be wrong with rules about whole arrays and their order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from rosetta_jit.catalogue.fields import no_length
from rosetta_jit.catalogue.habits import for_function
from rosetta_jit.catalogue.mapping import shorten
from rosetta_jit.catalogue.suggestions import closest
from rosetta_jit.diagnostics import Diagnostic, Mistake, error
from rosetta_jit.source import Span

FORMS = {
    "reversed": "`reversed(array)` or `reversed(array, group)`",
    "permuted": "`permuted(array, [2, 1, 0])`",
    "transposed": "`transposed(array, rows, columns)`, and behind it the elements of each",
    "planar": "`planar(array, channels)`, and behind it the elements of each",
    "interleaved": "`interleaved(array, channels)`, and behind it the elements of each",
    "rows": "`rows(array, count, size, stride)`",
    "padded_rows": "`padded_rows(array, count, size, stride)`",
    "numbers": "`numbers(bytes, float32)`, and behind it a condition: whether the high byte of each comes first",
    "number_bytes": "`number_bytes(numbers, float32)`, and behind it a condition: whether the high byte of each comes first",
    "upper_triangle": "`upper_triangle(array, size)`",
    "symmetric": "`symmetric(array, size)`",
    "deltas": "`deltas(.ticks)`",
    "running_sums": "`running_sums(.steps)`",
    "repeated": "`repeated(.values, .counts)`",
    "run_values": "`run_values(.cells)`",
    "run_lengths": "`run_lengths(.cells)`",
    "bits": "`bits(.mask)`, or `bits(.mask, true)` where the highest bit of each byte comes first",
    "bit_bytes": "`bit_bytes(.flags)`, or `bit_bytes(.flags, true)` where the first is the highest bit of a byte",
}
"""What a function of arrays takes."""


not_an_array = Mistake(
    "not-an-array",
    "this is no array whose elements could be put in another order",
    help="give it a field: `.a`, `.a[0 to 3]`, `reversed(.a)`; to compute with each element, write `[]` behind both arrays",
)
needs_each = Mistake("needs-each", "this names many elements", "of each of them?", help="write `[]` before it: `.points[0 to 3][].x`")
scalar_needs_each = Mistake("needs-each", "one value for many elements", help="write `[]` behind the elements: `.a[0 to 3][] = 0`")
numbers_of_image = Mistake(
    "image-order",
    "the bytes of an image stand in another order as bytes, not as numbers of several bytes",
    help="`numbers` and `number_bytes` take a field: set one to the image's bytes first",
)
out_of_place = Mistake(
    "many-elements",
    "this stands for many elements, and the rule needs one value",
    help="an array in another order is assigned as a whole: `.a = .b[0 to 3]`, or element by element: `.a[] = 2 * .b[]`",
)


def arguments(span: Span | None, function: str, least: int, most: int, found: int) -> Diagnostic:
    expected = str(least) if least == most else f"{least} or {most}"
    message = f"`{function}` takes an array and numbers, {expected} in all, not {found}"
    return error("arguments", message, span, help_=f"write {FORMS[function]}")


no_size = Mistake(
    "layout-size",
    "a count or a size must be an integer above 0",
    help="write how many elements, rows or channels there are, or a field that says it",
)
filter_without_elements = Mistake(
    "filter",
    "`where` chooses among elements, and no array is read here element by element",
    help="`.near[] = .ranges[] where .ranges[] < 1.0` takes elements; `when` chooses whether a rule runs",
)
filter_order = Mistake(
    "filter",
    "a filter takes the elements of arrays as they lie, and this has another order",
    help="filter plain arrays, slices, and `numbers(.data, float32)`",
)
filter_length = Mistake(
    "filter",
    "how many elements a filter keeps is not known before, and here a length is told",
    help="a filter sets the length of its array: fill one of any length, without a rule for its `len`",
)
other_filter = Mistake(
    "filter",
    "another rule for elements of this array has another `where`, or none",
    help="write the same `where` in all rules for the elements of one array, so that they keep the same ones",
)


def whole_arrays(span: Span | None, function: str, takes: Sequence[str]) -> Diagnostic:
    return error("arguments", f"`{function}` takes {' and '.join(takes)}, as a whole", span, help_=f"write {FORMS[function]}")


def no_number_type(span: Span | None, types: Iterable[str]) -> Diagnostic:
    listed = ", ".join(f"`{each}`" for each in types)
    return error("number-type", "this is no type of numbers", span, notes=(f"types: {listed}",))


scattered_bytes = Mistake(
    "number-bytes",
    "the bytes of these numbers do not lie one behind the other",
    help="put numbers in another order, not their bytes: `planar(numbers(.data, uint16), 3)`",
)
bytes_inside = Mistake(
    "number-bytes",
    "the bytes of numbers cannot be put in another order",
    help="put the numbers in another order: `number_bytes(reversed(.a), float32)`; only `padded_rows` may stand around it",
)
open_triangle = Mistake("layout-size", "the size of a triangle must stand in the text", help="for another size, write loops")
slice_step = Mistake("slice-step", "the step of a slice must be an integer above 0", help="`reversed(.a)` goes backward")
empty_slice = Mistake("slice-range", "the slice ends before it starts", help="`to` is exclusive; `reversed(.a[1 to 5])` goes backward")
of_a_list = Mistake("list-order", "elements that a list names cannot be put in another order", help="write the list in the final order")


def long_list(span: Span | None, limit: int) -> Diagnostic:
    return error("list-length", f"a list of more than {limit} elements", span, help_="use slices or a loop")


def too_many_rules(span: Span | None, limit: int) -> Diagnostic:
    return error("list-length", f"the lists of this block come to more than {limit} elements", span, help_="use slices or a loop")


no_permutation = Mistake(
    "no-permutation",
    "this is not the numbers from 0 on, each once",
    help="`permuted(.a, [2, 1, 0])` names each of 0, 1 and 2 once; `.a[[0, 0, 1]]` selects elements",
)


def no_divisor(span: Span | None, total: int, size: int) -> Diagnostic:
    help_ = f"take as many elements as groups of {size} have: {total - total % size}" if total >= size else "take more elements"
    return error("layout-size", f"{total} elements are no groups of {size}", span, help_=help_)


def not_flat(span: Span | None, function: str) -> Diagnostic:
    loop = "for y from 0 to .h ... .a[y * .w + x] ... end"
    help_ = f"a rule has one such order, as in `planar(rows(...), 3)` or `reversed(transposed(...))`; write others as a loop: `{loop}`"
    return error("layout-order", f"`{function}` does not nest with the order around it, or within it", span, help_=help_)


padded_inside = Mistake(
    "layout-order", "what has padding cannot be put in another order", help="pad at last: `padded_rows(reversed(.a), ...)`"
)
asked_in_order = Mistake(
    "layout-order",
    "a rejection asks the elements of an array as they lie",
    help="write `.a[]`, or a slice of it, in the condition; or write the rejection in a loop: `for i from 0 to len(.a) ... .a[i] ... end`",
)
two_orders = Mistake(
    "layout-order",
    "a rule reads one array in rows or planes, and no other besides",
    help="write two rules: put the array in its order in one, and compute with its elements in another",
)


def no_count(span: Span | None, path: str, whole: str = "", rule: Span | None = None) -> Diagnostic:
    """Elements that nothing says the number of; ``whole`` is an array that the rule reads as a whole."""
    written = "" if rule is None else shorten(rule.source.text[rule.start : rule.end])
    help_ = f"set it: `len({path}) {'<->' if '<->' in written else '='} 3`"
    if whole:
        meant = re.sub(rf"{re.escape(whole)}(?![\w.\[])", f"{whole}[]", written)
        help_ = f"`{whole}[]` is each of the elements there: `{meant}`"
    return error("no-count", f"nothing says how many elements `{path}` has", span, help_=help_)


open_end = Mistake("no-count", "nothing says where this slice ends", help="write its end: `.a[0 to 3]`")
several_layouts = Mistake(
    "several-layouts",
    "a rule for one direction takes one case",
    help="the flag can be set to one; several cases stand in a relation, `.a by .flag <-> { ... }`",
)
same_flag = Mistake(
    "same-layout", "two cases have the same flag", "again here", help="each flag tells one order: correct it, or remove the case"
)
same_order = Mistake(
    "same-layout",
    "two cases have the same elements in the same order",
    "again here",
    help="write how the elements lie where the holder has this flag: `planar(.a, 3)`, `.a`",
)


def length_of_one(span: Span | None, found: str) -> Diagnostic:
    """A length for a place that holds one value: written down, or that of the array that is assigned to it."""
    is_written = span is not None and span.source.text[: span.start].rstrip().endswith("(")
    return no_length(span, found) if is_written else one_value(span)


def one_value(span: Span | None, called: str = "", reductions: Sequence[str] = (), array: str = "") -> Diagnostic:
    """Many elements for a place that holds one value, those of an ``array``; what is ``called`` may be a reduction, misspelt."""
    meant = closest(called, reductions) if called else None
    misspelt = f"did you mean `{meant}`?" if meant else for_function(called)
    if misspelt:
        notes = (f"reductions: {', '.join(sorted(reductions))}",)
        return error("many-elements", f"there is no reduction `{shorten(called)}`", span, "no array", notes=notes, help_=misspelt)
    place, array = (".n", ".a") if not array or span is None else (shorten(span.source.text[span.start : span.end]), shorten(array))
    help_ = f"take one of them, `{place} = {array}[0]`, or one value of all: `{place} = sum({array}[])`"
    return error("many-elements", "many elements are assigned to one value", span, "no array", help_=help_)


UNKNOWN_FLAG = "the mapping has no layout for this"
"""Why a holder is refused whose flag no case names."""

OTHER_COUNT = "the arrays have different lengths"
"""Why a message is refused where two arrays that go together differ."""
