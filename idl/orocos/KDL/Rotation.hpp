#pragma once

namespace KDL {

/// Row by row.
struct Rotation {
    double data[9];
};

}  // namespace KDL
