// The dynamic decoder where YARP is not installed: the model of it.
#include "bottle.hpp"
#include "timing.hpp"

extern "C" {

const char* dynamic_decoder() { return "model of YARP"; }

double dynamic_decode_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    model::Bottle bottle;
    return nanoseconds(iterations, [&] { return bottle.from_binary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size)); });
}

}  // extern "C"
