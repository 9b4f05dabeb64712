// State and command of several joints, in the order of their names.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace robot {

/// Microseconds since 1970.
struct Time {
    int64_t microseconds;
};

struct JointState {
    double position;
    float speed;
    float effort;
    float raw;
    float acceleration;
};

struct Joints {
    Time time;
    std::vector<std::string> names;
    std::vector<JointState> elements;
};

}  // namespace robot
