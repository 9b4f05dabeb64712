#pragma once

#include <orocos/KDL/Rotation.hpp>
#include <orocos/KDL/Vector.hpp>

namespace KDL {

struct Frame {
    Vector p;
    Rotation M;
};

}  // namespace KDL
