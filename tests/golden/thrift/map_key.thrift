struct S { 1: map<double, i32> x }
