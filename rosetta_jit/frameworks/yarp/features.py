"""What bottle schemas and YARP's Thrift can say."""

from __future__ import annotations

from rosetta_jit.frameworks.probe import Probe


def schema(*fields: str) -> str:
    """A bottle of some fields."""
    return f'"probe.Probe"\n( {" ".join(fields)} )\n'


def thrift(fields: str, before: str = "") -> str:
    """A struct of some fields."""
    return f"namespace yarp probe\n{before}\nstruct Probe {{ {fields} }}\n"


def native(word: str, name: str) -> str:
    """A struct of a number that YARP knows by a name of C++."""
    return thrift(f'1: {word} (yarp.type = "{name}") x;')


def young(text: str) -> Probe:
    """A type that has come after 2012."""
    return Probe(text, without=("yarp2012",))


WORDS = {"int32": ":int", "float64": ":double"}
YOUNG = {"int8": ":int8", "uint8": ":uint8", "int16": ":int16", "int64": ":int64", "float32": ":float32"}
THRIFT_WORDS = {"boolean": "bool", "int32": "i32", "float64": "double"}
YOUNG_THRIFT = {"int8": "byte", "int16": "i16", "int64": "i64"}
UNSIGNED = {8: "byte", 16: "i16", 64: "i64"}

PROBES: dict[str, dict[str, str | Probe]] = {
    ".bottle-schema": {
        "boolean": schema('("x" :bool)'),
        **{feature: schema(f'("x" {word})') for feature, word in WORDS.items()},
        **{feature: young(schema(f'("x" {word})')) for feature, word in YOUNG.items()},
        "string, unchecked": schema('("x" :string)'),
        "string, fixed": schema('("x" :string (:length 16))'),
        "blob": schema('("x" :blob)'),
        "blob, fixed": schema('("x" :blob (:length 16))'),
        "blob, sized by a field": schema('("n" :int)', '("x" :blob (:length n))'),
        "array, fixed": schema('("x" (:list :double (:length 9)))'),
        "array, variable": schema('("x" (:list :double))'),
        "array, sized by a field": schema('("n" :int)', '("x" (:list :double) (:length n))'),
        "array, several fixed dimensions": schema('("x" (:list (:list :double (:length 4)) (:length 3)))'),
        "array of arrays": schema('("x" (:list (:list :double)))'),
        "struct": schema('("p" (:bottle ("x" :double) ("y" :int)))'),
        "default": schema('("x" :int (:default 5))'),
        "union with a discriminator": schema('("x" (:union ("i" :int) ("d" :double)))'),
        "map": schema('("x" (:dict :double))'),
        "constant": schema('("x" :int 5)', '("y" :int)'),
        "recursion": schema('("x" (:list "probe.Probe"))'),
        "namespace": schema('("x" :int)'),
        "import": Probe(
            '(:import "point.bottle-schema")\n' + schema('("p" "probe.Point")'),
            {"point.bottle-schema": '"probe.Point"\n( ("x" :double) )\n'},
        ),
        "time": schema('("x" "yarp.os.Stamp")') + '"yarp.os.Stamp"\n( ("sequence" :int) ("time" :double) )\n',
        "unit": schema('("x" :double (:unit :metre))'),
        "documentation": schema('("x" :int (:documentation "where it is"))'),
    },
    ".thrift": {
        **{feature: thrift(f"1: {word} x;") for feature, word in THRIFT_WORDS.items()},
        **{feature: young(thrift(f"1: {word} x;")) for feature, word in YOUNG_THRIFT.items()},
        **{f"uint{bits}": young(native(word, f"std::uint{bits}_t")) for bits, word in UNSIGNED.items()},
        "uint32": native("i32", "std::uint32_t"),
        "float32": young(native("double", "yarp::conf::float32_t")),
        "string, unchecked": thrift("1: string x;"),
        "blob": thrift("1: binary x;"),
        "array, variable": thrift("1: list<double> x;"),
        "array of arrays": thrift("1: list<list<double>> x;"),
        "struct": thrift("1: Point p;", "struct Point { 1: double x; }"),
        "enum, open": thrift("1: Color c;", "enum Color { RED, GREEN }"),
        "default": thrift("1: i32 x = 5;"),
        "map": thrift("1: map<string, double> x;"),
        "set": thrift("1: set<i32> x;"),
        "constant": thrift("1: i32 x;", "const i32 LIMIT = 5"),
        "recursion": thrift("1: i32 y; 2: list<Probe> x;"),
        "namespace": thrift("1: i32 x;"),
        "import": Probe(
            'include "point.thrift"\n' + thrift("1: Point p;"),
            {"point.thrift": "namespace yarp probe\nstruct Point { 1: double x; }\n"},
        ),
        "documentation": thrift("\n/** where it is */\n1: i32 x;"),
        "service": thrift("1: i32 x;", "service Server { i32 ask(1: i32 question); }"),
    },
}
