#pragma once

#include <cstdint>

namespace base {

/// Since 1970.
struct Time {
    int64_t microseconds;
};

}  // namespace base
