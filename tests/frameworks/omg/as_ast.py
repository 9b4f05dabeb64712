"""Our schema in the form of omniidl's tree, with all typedefs followed: what both must say of a file."""

from __future__ import annotations

from functools import singledispatch

from rosetta_jit.model.types import Array, Bool, Bytes, Enum, Float, Int, Ref, String

WORDS = {"unsigned short": "ushort", "unsigned long": "ulong", "long long": "longlong", "unsigned long long": "ulonglong"}


def ours(schema):
    """Structs, unions, enums and constants by name."""
    found = {name: declaration(declared, schema) for name, declared in schema.types.items()}
    return found | {name: {"const": constant(each, schema)} for name, each in schema.constants.items()}


def declaration(declared, schema):
    if isinstance(declared, Enum):
        home = declared.name.rpartition("::")[0]
        return {"enum": [f"{home}::{word}".removeprefix("::") for word, _ in declared.values]}
    if [field.name for field in declared.fields] == ["_d", "_u"]:
        switch, union = (field.type for field in declared.fields)
        cases = [case(union, index, schema) for index in range(len(union.cases))]
        return {"union": cases, "switch": type_tree(switch)}
    return {"struct": [[field.name, type_tree(field.type)] for field in declared.fields]}


def case(union, index, schema):
    labels = list(union.labels[index]) + (["default"] if union.default == index else [])
    return [labels, union.cases[index].name, type_tree(union.cases[index].type)]


def constant(each, schema):
    if isinstance(each.type, Ref):
        enum = schema.types[each.type.name]
        return declaration(enum, schema)["enum"][each.value]
    return str(int(each.value)) if isinstance(each.value, bool) else str(each.value)


@singledispatch
def type_tree(type_):
    raise AssertionError(type_)


@type_tree.register(Bool)
@type_tree.register(Int)
@type_tree.register(Float)
def _(type_):
    return WORDS.get(type_.spelling, type_.spelling)


@type_tree.register
def _(type_: String):
    return {type_.spelling: type_.maximum or 0}


@type_tree.register
def _(type_: Bytes):
    return {"array": type_.spelling, "length": type_.length} if type_.length else {"seq": type_.spelling, "bound": type_.maximum or 0}


@type_tree.register
def _(type_: Array):
    element = type_tree(type_.element)
    return {"array": element, "length": type_.length} if type_.length else {"seq": element, "bound": type_.maximum or 0}


@type_tree.register
def _(type_: Ref):
    return {"ref": type_.name}


def theirs(ast):
    """Omniidl's declarations in the same form."""
    numbers = {word: number for entry in ast.values() for number, word in enumerate(entry.get("enum", ()))}
    found = {}
    for name, entry in ast.items():
        if "struct" in entry:
            found[name] = {"struct": [[member, followed(type_, dims, ast)] for member, type_, dims in entry["struct"]]}
        elif "union" in entry:
            cases = [[[label_of(x, numbers) for x in labels], member, followed(t, dims, ast)] for labels, member, t, dims in entry["union"]]
            found[name] = {"union": cases, "switch": followed(entry["switch"], [], ast)}
        elif "typedef" not in entry:
            found[name] = entry
    return found


def label_of(label, numbers):
    if label == "default":
        return label
    return numbers[label] if label in numbers else ord(label) if isinstance(label, str) else int(label)


def followed(type_, dims, ast):
    for length in reversed(dims):
        type_ = {"array": type_, "length": length}
    match type_:
        case {"ref": name} if "typedef" in ast.get(name, {}):
            return followed(ast[name]["typedef"], ast[name]["dims"], ast)
        case {"seq": element, "bound": bound}:
            return {"seq": followed(element, [], ast), "bound": bound}
        case {"array": element, "length": length}:
            return {"array": followed(element, [], ast), "length": length}
        case _:
            return type_
