#pragma once
#include <Eigen/Core>
struct A {
    int x;
};
