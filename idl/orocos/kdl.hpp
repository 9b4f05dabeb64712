// The geometry types of the Kinematics and Dynamics Library, as their typekit carries them.
#pragma once

namespace KDL {

struct Vector {
    double data[3];
};

/// Row-major.
struct Rotation {
    double data[9];
};

struct Frame {
    Vector p;
    Rotation M;
};

struct Twist {
    Vector vel;
    Vector rot;
};

struct Wrench {
    Vector force;
    Vector torque;
};

}  // namespace KDL
