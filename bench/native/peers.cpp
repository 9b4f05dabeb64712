// What the kernels are measured against, each function timing its own loop: nanoseconds a message, or -1 where the message is refused.
#include <chrono>
#include <cstdint>
#include <cstring>

#ifdef WITH_YARP
#include <yarp/conf/version.h>
#include <yarp/os/Bottle.h>
#else
#include "bottle.hpp"
#endif

namespace {

constexpr float DEGREE = 0.017453292519943295F;
constexpr std::int64_t HEADER = 8;  // tag of the list, count
constexpr std::int64_t WIDTH = 8;   // of a float64

// The compiler must believe that somebody else reads and writes all memory between two messages.
inline void forget() { asm volatile("" ::: "memory"); }

template <typename Decode>
double nanoseconds(std::int64_t iterations, Decode decode) {
    const auto started = std::chrono::steady_clock::now();
    for (std::int64_t turn = 0; turn < iterations; ++turn) {
        forget();
        if (!decode()) {
            return -1;
        }
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - started;
    return took.count() / static_cast<double>(iterations);
}

// The check that a person writes by hand: a list of float64, and as long as it says.
inline bool header_is_good(const unsigned char* message, std::int64_t size, std::int32_t tag, std::int64_t* count) {
    std::int32_t head[2];
    if (size < HEADER) {
        return false;
    }
    std::memcpy(head, message, sizeof head);
    *count = head[1];
    return head[0] == tag && head[1] >= 0 && size == HEADER + WIDTH * static_cast<std::int64_t>(head[1]);
}

}  // namespace

extern "C" {

const char* dynamic_decoder() {
#ifdef WITH_YARP
    return "YARP " YARP_VERSION;
#else
    return "model of YARP";
#endif
}

double dynamic_decode_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
#ifdef WITH_YARP
    yarp::os::Bottle bottle;
    return nanoseconds(iterations, [&] {
        bottle.fromBinary(reinterpret_cast<const char*>(message), static_cast<int>(size));
        return bottle.size() > 0;
    });
#else
    model::Bottle bottle;
    return nanoseconds(iterations, [&] { return bottle.from_binary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size)); });
#endif
}

double loop_decode_ns(const unsigned char* message, std::int64_t size, std::int32_t tag, float* angles, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::int64_t count = 0;
        if (!header_is_good(message, size, tag, &count)) {
            return false;
        }
        for (std::int64_t index = 0; index < count; ++index) {
            double degrees = 0;
            std::memcpy(&degrees, message + HEADER + WIDTH * index, WIDTH);
            angles[index] = static_cast<float>(degrees) * DEGREE;
        }
        return true;
    });
}

double copy_decode_ns(const unsigned char* message, std::int64_t size, std::int32_t tag, double* angles, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::int64_t count = 0;
        if (!header_is_good(message, size, tag, &count)) {
            return false;
        }
        std::memcpy(angles, message + HEADER, static_cast<std::size_t>(WIDTH * count));
        return true;
    });
}

double memmove_ns(unsigned char* target, const unsigned char* source, std::int64_t size, std::int64_t iterations) {
    return nanoseconds(iterations, [=] {
        std::memmove(target, source, static_cast<std::size_t>(size));
        return true;
    });
}

}  // extern "C"
