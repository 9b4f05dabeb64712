struct S { 1: set<list<i32>> x }
