union U { 1: i32 x }
