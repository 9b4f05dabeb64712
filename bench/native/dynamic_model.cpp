// The dynamic decoder where YARP is not installed: the model of it.
#include "bottle.hpp"
#include "timing.hpp"

extern "C" {

const char* dynamic_decoder() { return "model of YARP"; }

// What it reads, so that it can be compared; -1 where the message is refused.
std::int64_t dynamic_values(const unsigned char* message, std::int64_t size, double* values, std::int64_t room) {
    model::Bottle bottle;
    if (!bottle.from_binary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size))) {
        return -1;
    }
    const auto count = static_cast<std::int64_t>(bottle.size());
    for (std::int64_t index = 0; index < count && index < room; ++index) {
        values[index] = bottle.get(static_cast<std::size_t>(index)).as_float64();
    }
    return count;
}

double dynamic_decode_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    model::Bottle bottle;
    return nanoseconds(iterations, [&] { return bottle.from_binary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size)); });
}

}  // extern "C"
