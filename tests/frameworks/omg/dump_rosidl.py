"""Run by Debian's Python, which has rosidl: what rosidl_parser reads out of `.idl` files, in the form of `rosidl_shapes`, as JSON.

dump_rosidl.py folder file...
"""

import ast
import json
import pathlib
import sys

from rosidl_parser.definition import (
    AbstractNestedType,
    AbstractString,
    AbstractWString,
    Array,
    BasicType,
    BoundedSequence,
    IdlLocator,
    Message,
    NamespacedType,
)
from rosidl_parser.parser import parse_idl_file

WORDS = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}
DUMMY = "structure_needs_at_least_one_member"


def shape(message):
    members = [each for each in message.structure.members if each.name != DUMMY]
    fields = [[each.name, spelled(each.type), default_of(each)] for each in members]
    return {"fields": fields, "constants": [[each.name, constant_type(each.type), each.value] for each in message.constants]}


def spelled(type_):
    if isinstance(type_, AbstractNestedType):
        size = str(type_.size) if isinstance(type_, Array) else f"<={type_.maximum_size}" if isinstance(type_, BoundedSequence) else ""
        return f"{spelled(type_.value_type)}[{size}]"
    if isinstance(type_, (AbstractString, AbstractWString)):
        bound = getattr(type_, "maximum_size", None)
        return ("wstring" if isinstance(type_, AbstractWString) else "string") + (f"<={bound}" if bound else "")
    if isinstance(type_, NamespacedType):
        return "/".join(type_.namespaced_name())
    assert isinstance(type_, BasicType)
    return WORDS.get(type_.typename, type_.typename)


def constant_type(type_):
    """Without the bound that rosidl gives a string constant: its own length."""
    return "string" if isinstance(type_, AbstractString) else spelled(type_)


def default_of(member):
    if not member.has_annotation("default"):
        return None
    value = member.get_annotation_value("default")["value"]
    return list(ast.literal_eval(value)) if isinstance(member.type, AbstractNestedType) else value


folder, *files = sys.argv[1:]
found = {}
for name in files:
    content = parse_idl_file(IdlLocator(pathlib.Path(folder), pathlib.Path(name))).content
    for message in content.get_elements_of_type(Message):
        found["/".join(message.structure.namespaced_type.namespaced_name())] = shape(message)
print(json.dumps(found))
