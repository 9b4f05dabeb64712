struct A { 1: i32 x }
struct A { 1: i32 y }
