"""Random declarations that lcm-gen takes, and random values of them."""

from __future__ import annotations

from dataclasses import dataclass

from hypothesis import strategies as st

INTEGERS = {"int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64}
PRIMITIVES = (*INTEGERS, "float", "double", "string", "boolean", "byte")
PACKAGE = "random_types"


@dataclass(frozen=True)
class Member:
    type: str
    name: str
    sizes: tuple[int | str, ...]
    written: tuple[str, ...]


@dataclass(frozen=True)
class Declared:
    """A struct: its fields, and which of them tell sizes."""

    name: str
    members: tuple[Member, ...]
    constants: tuple[tuple[str, str, str], ...]
    text: str

    @property
    def counts(self):
        return {size for member in self.members for size in member.sizes if isinstance(size, str)}


names = st.from_regex(r"[a-z_][A-Za-z0-9_]{0,11}", fullmatch=True).filter(lambda name: not keyword_or_own(name))


def keyword_or_own(name):
    import keyword

    reserved = {*PRIMITIVES, "self", "buf", "encode", "decode", "get_hash", "struct", "enum", "const", "package", "BytesIO"}
    return keyword.iskeyword(name) or name in reserved or name.startswith("__") or name in {"_encode_one", "_decode_one"}


@st.composite
def structs(draw, name, flat, deep):
    """A struct that may contain those declared before, and itself in lists that can be empty. ``deep`` ones are in no arrays."""
    taken = draw(st.lists(names, min_size=1, max_size=8, unique=True))
    constants, members, counts, text = [], [], [], []
    for each in taken:
        if draw(st.integers(0, 5)) == 0:
            word = draw(st.sampled_from(("3", "2", "0x1", "02", "0X3")))
            type_ = draw(st.sampled_from(sorted(INTEGERS)))
            constants.append((type_, each, word))
            text.append(f"const {type_} {each} = {word};")
            continue
        sizes, written = draw(dimensions(counts, constants))
        inner = [*flat, *([] if sizes else deep), *([name] if len(sizes) == 1 and isinstance(sizes[0], str) else [])]
        type_ = draw(st.sampled_from([*PRIMITIVES, *inner, *INTEGERS]))
        members.append(Member(type_, each, tuple(sizes), tuple(written)))
        text.append(f"{type_} {each}{''.join(f'[{size}]' for size in written)};")
        if type_ in INTEGERS and not sizes:
            counts.append(each)
    gap = draw(st.sampled_from((" ", "\n", " // text\n", " /* text */ ")))
    body = gap.join(["struct", name, "{", *text, "}"])
    return Declared(name, tuple(members), tuple(constants), body)


@st.composite
def dimensions(draw, counts, constants):
    found = []
    for _ in range(draw(st.sampled_from((0, 0, 0, 1, 1, 2, 3)))):
        kinds = [st.sampled_from(((2, "2"), (1, "1"), (3, "0x3"), (3, "03")))]
        if counts:
            kinds += [st.sampled_from([(each, each) for each in counts])] * 2
        if constants:
            kinds.append(st.sampled_from([(int(word, 16 if word[1:2] in {"x", "X"} else 8), each) for _, each, word in constants]))
        found.append(draw(st.one_of(kinds)))
    return [size for size, _ in found], [word for _, word in found]


@st.composite
def files(draw, most=4):
    """Some structs of one package."""
    found, flat, deep = [], [], []
    for number in range(draw(st.integers(1, most))):
        name = f"t{number}_t"
        found.append(draw(structs(name, flat, deep)))
        (deep if any(each.type in {name, *deep} for each in found[-1].members) else flat).append(name)
    return found


def text_of(found):
    return f"package {PACKAGE};\n" + "\n".join(each.text for each in found) + "\n"


def random_value(name, types, rng, depth=0):
    """Plain values of a struct: sizes agree with arrays, and recursion ends."""
    declared = types[name]
    values = {}
    for member in declared.members:
        if member.name in declared.counts:
            values[member.name] = rng.randrange(0, 4 if depth == 0 else 2) if depth < 3 else 0
        else:
            sizes = [values[size] if isinstance(size, str) else size for size in member.sizes]
            values[member.name] = array(member.type, sizes, types, rng, depth)
    return values


def array(type_, sizes, types, rng, depth):
    if type_ == "byte" and len(sizes) == 1:
        return rng.randbytes(sizes[0])
    if sizes:
        return [array(type_, sizes[1:], types, rng, depth) for _ in range(sizes[0])]
    return random_value(type_, types, rng, depth + 1) if type_ in types else scalar(type_, rng)


def scalar(type_, rng):
    match type_:
        case "boolean":
            return rng.random() < 0.5
        case "byte":
            return rng.randrange(256)
        case "string":
            return "".join(rng.choice("aZ é€😀\0") for _ in range(rng.randrange(5)))
        case "float":
            return rng.choice((0.0, -0.0, 1.5, float("inf"), float("nan"), 3.4028234663852886e38, rng.randrange(-999, 999) / 64))
        case "double":
            return rng.choice((0.0, -0.0, 5e-324, float("-inf"), float("nan"), rng.random()))
        case _:
            limit = 1 << (INTEGERS[type_] - 1)
            return rng.choice((-limit, limit - 1, 0, rng.randrange(-limit, limit)))


def as_generated(value, name, types, classes):
    """Plain values as an object of lcm-gen's class."""
    made = classes[f"{PACKAGE}.{name}"]()
    for member in types[name].members:
        setattr(made, member.name, objects(value[member.name], member.type, types, classes))
    return made


def objects(value, type_, types, classes):
    if isinstance(value, list):
        return [objects(each, type_, types, classes) for each in value]
    return as_generated(value, type_, types, classes) if type_ in types else value
