// lcm-gen's C++, decoding into an object that is used again and encoding into a buffer that is given.
#include <cstring>
#include <vector>

#include "rjtest/doubles_t.hpp"
#include "timing.hpp"

extern "C" {

double decode_ns(const char*, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    rjtest::doubles_t value;
    publish(value);
    return nanoseconds(iterations, [&] { return value.decode(message, 0, static_cast<int>(size)) == size; });
}

double encode_ns(const char*, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    rjtest::doubles_t value;
    if (value.decode(message, 0, static_cast<int>(size)) != size) {
        return -1;
    }
    std::vector<unsigned char> buffer(static_cast<std::size_t>(size));
    publish(buffer);
    const double took = nanoseconds(iterations, [&] { return value.encode(buffer.data(), 0, static_cast<int>(size)) == size; });
    return std::memcmp(buffer.data(), message, buffer.size()) == 0 ? took : -1;
}

}  // extern "C"
