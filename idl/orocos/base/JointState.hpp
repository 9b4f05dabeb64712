#pragma once

namespace base {

struct JointState {
    double position;
    float speed;
    float effort;
    float raw;
    float acceleration;
};

}  // namespace base
