// The joints of a bottle by the C that `rosetta-jit generate` writes, timed as the peers are. The unit is compiled as C, by itself.
#include "joints.h"
#include "timing.hpp"

extern "C" double generated_decode_ns(const unsigned char* message, std::int64_t size, float* angles, std::int64_t iterations) {
    static joints_memory memory;
    joints_holder holder;
    joints_use(&holder, &memory);
    const double took = nanoseconds(iterations, [&] { return joints_decode(&holder, message, static_cast<std::size_t>(size), nullptr) == JOINTS_OK; });
    for (std::int64_t index = 0; index < holder.message.angles.count; ++index) {
        angles[index] = holder.angles.rows[holder.message.angles.start + index];
    }
    return took;
}
