"""What bottle schemas and YARP's Thrift can say."""

from __future__ import annotations


def schema(*fields: str) -> str:
    """A bottle of some fields."""
    return f'"probe.Probe"\n( {" ".join(fields)} )\n'


def thrift(fields: str, before: str = "") -> str:
    """A struct of some fields."""
    return f"namespace yarp probe\n{before}\nstruct Probe {{ {fields} }}\n"


WORDS = {"int8": ":int8", "int16": ":int16", "int32": ":int", "int64": ":int64", "float32": ":float32", "float64": ":double"}
THRIFT_WORDS = {"boolean": "bool", "int8": "byte", "int16": "i16", "int32": "i32", "int64": "i64", "float64": "double"}

PROBES = {
    ".bottle-schema": {
        "boolean": schema('("x" :bool)'),
        **{feature: schema(f'("x" {word})') for feature, word in WORDS.items()},
        "string, unchecked": schema('("x" :string)'),
        "blob": schema('("x" :blob)'),
        "array, fixed": schema('("x" (:list :double (:length 9)))'),
        "array, variable": schema('("x" (:list :double))'),
        "array of arrays": schema('("x" (:list (:list :double)))'),
        "struct": schema('("p" (:bottle ("x" :double) ("y" :int)))'),
        "map": schema('("x" (:dict :double))'),
        "constant": schema('("x" :int 5)', '("y" :int)'),
        "namespace": schema('("x" :int)'),
        "unit": schema('("x" :double (:unit :degree))'),
    },
    ".thrift": {
        **{feature: thrift(f"1: {word} x;") for feature, word in THRIFT_WORDS.items()},
        "string, unchecked": thrift("1: string x;"),
        "blob": thrift("1: binary x;"),
        "array, variable": thrift("1: list<double> x;"),
        "array of arrays": thrift("1: list<list<double>> x;"),
        "struct": thrift("1: Point p;", "struct Point { 1: double x; }"),
        "enum": thrift("1: Color c;", "enum Color { RED, GREEN }"),
        "default": thrift("1: i32 x = 7;"),
        "map": thrift("1: map<string, double> x;"),
        "set": thrift("1: set<i32> x;"),
        "constant": thrift("1: i32 x;", "const i32 LIMIT = 5"),
        "namespace": thrift("1: i32 x;"),
        "service": thrift("1: i32 x;", "service Server { i32 ask(1: i32 question); }"),
    },
}
