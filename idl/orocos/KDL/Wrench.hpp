#pragma once

#include <orocos/KDL/Vector.hpp>

namespace KDL {

struct Wrench {
    Vector force;
    Vector torque;
};

}  // namespace KDL
