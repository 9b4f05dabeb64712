"""What `.proto` files can say; the features of editions say the same as older versions in other words."""

from __future__ import annotations

from rosetta_jit.frameworks.probe import Probe


def message(fields: str, *, syntax: str = "proto3", more: str = "") -> str:
    """A message of some fields."""
    return f'syntax = "{syntax}"; package probe; {more} message Probe {{ {fields} }}'


PROBES = {
    ".proto": {
        "boolean": message("bool x = 1;"),
        "int32": message("int32 x = 1;"),
        "int64": message("int64 x = 1;"),
        "uint32": message("uint32 x = 1;"),
        "uint64": message("uint64 x = 1;"),
        "float32": message("float x = 1;"),
        "float64": message("double x = 1;"),
        "string, UTF-8": message("string x = 1;"),
        "blob": message("bytes x = 1;"),
        "array, variable": message("repeated double x = 1;"),
        "struct": message("Point x = 1;", more="message Point { double x = 1; }"),
        "oneof": message("oneof x { double d = 1; int32 i = 2; }"),
        "enum, closed": message("optional Color x = 1;", syntax="proto2", more="enum Color { RED = 0; }"),
        "enum, open": message("Color x = 1;", more="enum Color { RED = 0; }"),
        "optional": message("optional int32 x = 1;"),
        "required": message("required int32 x = 1;", syntax="proto2"),
        "default": message("optional int32 x = 1 [default = 5];", syntax="proto2"),
        "map": message("map<int32, double> x = 1;"),
        "recursion": message("repeated Probe x = 1;"),
        "extension": message("optional int32 x = 1; extensions 100 to 200;", syntax="proto2") + " extend Probe { optional int32 y = 100; }",
        "evolution": message("int32 x = 1;"),
        "namespace": message("int32 x = 1;"),
        "import": Probe(
            'syntax = "proto3"; package probe; import "point.proto"; message Probe { Point x = 1; }',
            {"point.proto": 'syntax = "proto3"; package probe; message Point { double x = 1; }'},
        ),
        "time": message("google.protobuf.Timestamp x = 1;", more='import "google/protobuf/timestamp.proto";'),
        "duration": message("google.protobuf.Duration x = 1;", more='import "google/protobuf/duration.proto";'),
        "documentation": message("\n// where it is\nint32 x = 1;"),
        "service": message("int32 x = 1;", more="service Server { rpc Ask(Probe) returns (Probe); }"),
    }
}
