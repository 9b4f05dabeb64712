#pragma once

namespace KDL {

struct Vector {
    double data[3];
};

}  // namespace KDL
