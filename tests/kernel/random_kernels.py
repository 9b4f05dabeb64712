"""Random kernels for the passes, which the naive lowering might have made."""

from __future__ import annotations

from random import Random

from rosetta_jit.kernel.nodes import (
    Binary,
    Compare,
    Const,
    Fill,
    For,
    Get,
    If,
    Let,
    Load,
    Local,
    Place,
    Require,
    Return,
    SetField,
)
from rosetta_jit.kernel.terms import BEGIN, ROW, add, index, mul
from tests.kernel import kernels
from tests.kernel.kernels import ROW_EXISTS, compare, expect, i64, kernel, need


def random_kernel(seed):
    """A kernel of random fields, loops and branches, which the naive lowering might have made."""
    random = Random(seed)  # no secret depends on it
    body, at, names = [ROW_EXISTS], BEGIN, iter(range(1000))

    def scalar(at, row_offset, site=1, *indices):
        type_, width = random.choice([("u8", 1), ("i16", 2), ("f32", 4), ("f64", 8), ("i64", 8)])
        checks = [need(at, width, site, *indices)]
        if random.random() < 0.3:
            value = Local(type_, f"v{next(names)}")
            checks.append(Let(value.name, Load(type_, at)))
            if type_ in {"u8", "i16", "i64"}:
                checks.append(expect(kernels.Compare("ne", value, Const(type_, 7)), 2, at))
            checks.append(SetField(Place(0, ROW, row_offset), value))
        else:
            checks.append(SetField(Place(0, ROW, row_offset), Load(type_, at, random.choice("<>"))))
        return checks, width

    for _ in range(random.randint(1, 8)):
        kind = random.choice(["scalar", "scalar", "array", "branch", "skip", "fill", "bits", "pair", "elements"])
        offset = 8 * random.randint(0, 7)
        if kind == "scalar":
            made, width = scalar(at, offset)
            body += made
            at = add(at, width)
        elif kind == "array":
            count, gap = random.choice([0, 1, 2, 3, 8, 20]), random.choice([0, 0, 4])
            i, start = i64(f"i{next(names)}"), i64(f"s{next(names)}")
            place = add(kernels.Binary("add", at, mul(i, 8 + gap)), gap) if at != index(0) else mul(i, 8 + gap)
            loop = [need(place, 8, 4, i), SetField(Place(1, kernels.Binary("add", start, i)), Load("i64", place))]
            body += [kernels.Reserve(1, index(count)), Let(start.name, kernels.Used(1)), kernels.Advance(1, index(count))]
            body.append(For(i.name, index(count), tuple(loop)))
            at = add(at, count * (8 + gap))
            body.append(Require(BEGIN, kernels.Binary("sub", at, BEGIN), kernels.fail(1, at)))
        elif kind == "branch":
            flag = i64(f"f{next(names)}")
            then, width = scalar(add(at, 1), offset)
            body += [need(at, 1), Let(flag.name, kernels.Convert("i64", Load("u8", at)))]
            body.append(If(compare("gt", flag, 3), tuple(then)))
            at = add(at, 1)
        elif kind == "skip":
            size, place = i64(f"n{next(names)}"), i64(f"p{next(names)}")
            body += [need(at, 1), Let(size.name, kernels.Convert("i64", Load("u8", at))), need(add(at, 1), size)]
            body.append(Let(place.name, kernels.Binary("add", add(at, 1), size)))
            at = place
        elif kind == "bits":
            place = Place(0, ROW, offset)
            bits = SetField(place, Binary("or", Get("u64", place), Const("u64", 1 << random.randint(0, 63))))
            body += random.choice([(bits,), (Fill(Place(0, ROW), index(64)), bits)])
        elif kind == "pair":
            body += [need(at, 8), *(expect(compare_words(add(at, 4 * n), random), 2, add(at, 4 * n)) for n in range(2))]
            at = add(at, 8)
        elif kind == "elements":
            count = i64(f"c{next(names)}")
            body += [need(at, 1), Let(count.name, kernels.Convert("i64", Load("u8", at)))]
            for n in range(random.randint(2, 5)):
                body.append(expect(Compare("lt", index(n), count), 4, add(at, n), index(n)))
                body.append(SetField(Place(0, ROW, offset), random.choice([count, index(n)])))
            at = add(at, 1)
        else:
            body.append(SetField(Place(0, ROW, offset), Const("i64", random.choice([0, 1, 2**40]))))
    if random.random() < 0.3:
        body.append(expect(kernels.Compare("eq", at, kernels.END), 3, at))
    return kernel((*body, Return(at)))


def compare_words(at, random):
    """Whether four bytes are what they mostly are in random messages."""
    return Compare("eq", Load("i32", at, random.choice("<<<>")), Const("i32", random.choice([0, 0, 0, -1, 7])))
