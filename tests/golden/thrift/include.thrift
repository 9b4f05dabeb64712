include "missing.thrift"
struct S { 1: i32 x }
