#pragma once

#include <orocos/KDL/Vector.hpp>

namespace KDL {

struct Twist {
    Vector vel;
    Vector rot;
};

}  // namespace KDL
