"""What can be wrong with rules about whole arrays and their order."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rosetta_jit.catalogue.habits import for_function
from rosetta_jit.catalogue.mapping import error, shorten
from rosetta_jit.catalogue.spelling import closest

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rosetta_jit.diagnostics import Diagnostic
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


def not_an_array(span: Span | None) -> Diagnostic:
    """A value that is not an array in some order."""
    help_ = "give it a field: `.a`, `.a[0 to 3]`, `reversed(.a)`; to compute with each element, write `[]` behind both arrays"
    return error("not-an-array", "this is no array whose elements could be put in another order", span, help_=help_)


def needs_each(span: Span | None) -> Diagnostic:
    """Many elements where one is meant."""
    return error("needs-each", "this names many elements", span, "of each of them?", help_="write `[]` before it: `.points[0 to 3][].x`")


def scalar_needs_each(span: Span | None) -> Diagnostic:
    """One value for many elements."""
    return error("needs-each", "one value for many elements", span, help_="write `[]` behind the elements: `.a[0 to 3][] = 0`")


def numbers_of_image(span: Span | None) -> Diagnostic:
    """Numbers in the bytes that a function of images makes or takes."""
    message = "the bytes of an image stand in another order as bytes, not as numbers of several bytes"
    return error("image-order", message, span, help_="`numbers` and `number_bytes` take a field: set one to the image's bytes first")


def out_of_place(span: Span | None) -> Diagnostic:
    """Many elements where a rule cannot use them."""
    help_ = "an array in another order is assigned as a whole: `.a = .b[0 to 3]`, or element by element: `.a[] = 2 * .b[]`"
    return error("many-elements", "this stands for many elements, and the rule needs one value", span, help_=help_)


def arguments(span: Span | None, function: str, least: int, most: int, found: int) -> Diagnostic:
    """A wrong number of arguments."""
    expected = str(least) if least == most else f"{least} or {most}"
    message = f"`{function}` takes an array and numbers, {expected} in all, not {found}"
    return error("arguments", message, span, help_=f"write {FORMS[function]}")


def no_size(span: Span | None) -> Diagnostic:
    """A count that is none."""
    help_ = "write how many elements, rows or channels there are, or a field that says it"
    return error("layout-size", "a count or a size must be an integer above 0", span, help_=help_)


def filter_without_elements(span: Span | None) -> Diagnostic:
    """A condition on elements where there are none."""
    help_ = "`.near[] = .ranges[] where .ranges[] < 1.0` takes elements; `when` chooses whether a rule runs"
    return error("filter", "`where` chooses among elements, and no array is read here element by element", span, help_=help_)


def filter_order(span: Span | None) -> Diagnostic:
    """A filter of an array in another order."""
    help_ = "filter plain arrays, slices, and `numbers(.data, float32)`"
    return error("filter", "a filter takes the elements of arrays as they lie, and this has another order", span, help_=help_)


def filter_length(span: Span | None) -> Diagnostic:
    """A filter that fills an array whose length is known."""
    help_ = "a filter sets the length of its array: fill one of any length, without a rule for its `len`"
    return error("filter", "how many elements a filter keeps is not known before, and here a length is told", span, help_=help_)


def other_filter(span: Span | None) -> Diagnostic:
    """Rules for the elements of one array that keep different ones."""
    return error(
        "filter",
        "another rule for elements of this array has another `where`, or none",
        span,
        help_="write the same `where` in all rules for the elements of one array, so that they keep the same ones",
    )


def whole_arrays(span: Span | None, function: str, takes: Sequence[str]) -> Diagnostic:
    """Arguments of a function that makes an array of others."""
    return error("arguments", f"`{function}` takes {' and '.join(takes)}, as a whole", span, help_=f"write {FORMS[function]}")


def no_number_type(span: Span | None, types: Iterable[str]) -> Diagnostic:
    """Bytes of numbers that are of no type."""
    listed = ", ".join(f"`{each}`" for each in types)
    return error("number-type", "this is no type of numbers", span, notes=(f"types: {listed}",))


def scattered_bytes(span: Span | None) -> Diagnostic:
    """Numbers whose bytes do not lie one behind the other."""
    help_ = "put numbers in another order, not their bytes: `planar(numbers(.data, uint16), 3)`"
    return error("number-bytes", "the bytes of these numbers do not lie one behind the other", span, help_=help_)


def bytes_inside(span: Span | None) -> Diagnostic:
    """Bytes of numbers within another order."""
    help_ = "put the numbers in another order: `number_bytes(reversed(.a), float32)`; only `padded_rows` may stand around it"
    return error("number-bytes", "the bytes of numbers cannot be put in another order", span, help_=help_)


def open_triangle(span: Span | None) -> Diagnostic:
    """A triangle of a size that is not known when the mapping is compiled."""
    return error("layout-size", "the size of a triangle must stand in the text", span, help_="for another size, write loops")


def slice_step(span: Span | None) -> Diagnostic:
    """A slice that does not go forward."""
    return error("slice-step", "the step of a slice must be an integer above 0", span, help_="`reversed(.a)` goes backward")


def empty_slice(span: Span | None) -> Diagnostic:
    """A slice whose end lies before its start."""
    return error("slice-range", "the slice ends before it starts", span, help_="`to` is exclusive; `reversed(.a[1 to 5])` goes backward")


def of_a_list(span: Span | None) -> Diagnostic:
    """Elements of elements that a list names."""
    return error("list-order", "elements that a list names cannot be put in another order", span, help_="write the list in the final order")


def long_list(span: Span | None, limit: int) -> Diagnostic:
    """More listed elements than each rule of its own is worth."""
    return error("list-length", f"a list of more than {limit} elements", span, help_="use slices or a loop")


def too_many_rules(span: Span | None, limit: int) -> Diagnostic:
    """Lists in lists, whose product is large."""
    return error("list-length", f"the lists of this block come to more than {limit} elements", span, help_="use slices or a loop")


def no_permutation(span: Span | None) -> Diagnostic:
    """A list that leaves out numbers or repeats them."""
    help_ = "`permuted(.a, [2, 1, 0])` names each of 0, 1 and 2 once; `.a[[0, 0, 1]]` selects elements"
    return error("no-permutation", "this is not the numbers from 0 on, each once", span, help_=help_)


def no_divisor(span: Span | None, total: int, size: int) -> Diagnostic:
    """Groups that do not come out even."""
    help_ = f"take as many elements as groups of {size} have: {total - total % size}" if total >= size else "take more elements"
    return error("layout-size", f"{total} elements are no groups of {size}", span, help_=help_)


def not_flat(span: Span | None, function: str) -> Diagnostic:
    """A function of an array that is already in rows or planes."""
    help_ = "use it first: `planar(rows(...), 3)`"
    return error("layout-order", f"`{function}` needs an array that no other function has put in rows or planes", span, help_=help_)


def padded_inside(span: Span | None) -> Diagnostic:
    """Padding that something else is done to."""
    help_ = "pad at last: `padded_rows(reversed(.a), ...)`"
    return error("layout-order", "what has padding cannot be put in another order", span, help_=help_)


def asked_in_order(span: Span | None) -> Diagnostic:
    """A rejection for elements of arrays that do not lie in one row."""
    help_ = (
        "write `.a[]`, or a slice of it, in the condition; or write the rejection in a loop: `for i from 0 to len(.a) ... .a[i] ... end`"
    )
    return error("layout-order", "a rejection asks the elements of an array as they lie", span, help_=help_)


def two_orders(span: Span | None) -> Diagnostic:
    """Several arrays in a rule, one of them in rows or planes."""
    help_ = "write two rules: put the array in its order in one, and compute with its elements in another"
    return error("layout-order", "a rule reads one array in rows or planes, and no other besides", span, help_=help_)


def no_count(span: Span | None, path: str, whole: str = "", rule: Span | None = None) -> Diagnostic:
    """Elements that nothing says the number of; ``whole`` is an array that the rule reads as a whole."""
    written = "" if rule is None else shorten(rule.source.text[rule.start : rule.end])
    help_ = f"set it: `len({path}) {'<->' if '<->' in written else '='} 3`"
    if whole:
        meant = re.sub(rf"{re.escape(whole)}(?![\w.\[])", f"{whole}[]", written)
        help_ = f"`{whole}[]` is each of the elements there: `{meant}`"
    return error("no-count", f"nothing says how many elements `{path}` has", span, help_=help_)


def open_end(span: Span | None) -> Diagnostic:
    """A slice to the last element of an array that is being filled, by nothing that has a length."""
    return error("no-count", "nothing says where this slice ends", span, help_="write its end: `.a[0 to 3]`")


def several_layouts(span: Span | None) -> Diagnostic:
    """Two cases in a rule for one direction."""
    help_ = "the flag can be set to one; several cases stand in a relation, `.a by .flag <-> { ... }`"
    return error("several-layouts", "a rule for one direction takes one case", span, help_=help_)


def same_flag(span: Span | None) -> Diagnostic:
    """One flag for two orders."""
    return error(
        "same-layout", "two cases have the same flag", span, "again here", help_="each flag tells one order: correct it, or remove the case"
    )


def same_order(span: Span | None) -> Diagnostic:
    """Two flags for one order: the pixels of one of them are not as its flag says."""
    help_ = "write how the elements lie where the holder has this flag: `planar(.a, 3)`, `.a`"
    return error("same-layout", "two cases have the same elements in the same order", span, "again here", help_=help_)


def one_value(span: Span | None, called: str = "", reductions: Sequence[str] = ()) -> Diagnostic:
    """Many elements for a place that holds one value; what is ``called`` with them may be a reduction, misspelt."""
    meant = closest(called, reductions) if called else None
    misspelt = f"did you mean `{meant}`?" if meant else for_function(called)
    if misspelt:
        notes = (f"reductions: {', '.join(sorted(reductions))}",)
        return error("many-elements", f"there is no reduction `{shorten(called)}`", span, "no array", notes=notes, help_=misspelt)
    help_ = "take one of them, `.n = .a[0]`, or one value of all: `.n = sum(.a[])`"
    return error("many-elements", "many elements are assigned to one value", span, "no array", help_=help_)


UNKNOWN_FLAG = "the mapping has no layout for this"
"""Why a holder is refused whose flag no case names."""

OTHER_COUNT = "the arrays have different lengths"
"""Why a message is refused where two arrays that go together differ."""
