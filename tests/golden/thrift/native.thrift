struct I { 1: i32 a } (yarp.name = "yarp::os::Stamp")
struct S { 1: I x }
