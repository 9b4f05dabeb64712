// lcm-gen's C++, decoding into an object that is used again and encoding into a buffer that is given.
#include <cstring>
#include <vector>

#include "rjtest/doubles_t.hpp"
#include "timing.hpp"

extern "C" {

double decode_ns(const char*, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const Messages messages{data, ends, count};
    rjtest::doubles_t value;
    publish(value);
    return nanoseconds_in_turn(count, iterations, [&](std::int64_t number) {
        const int size = static_cast<int>(messages.size(number));
        return value.decode(messages.at(number), 0, size) == size;
    });
}

double encode_ns(const char*, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const Messages messages{data, ends, count};
    std::vector<rjtest::doubles_t> values(static_cast<std::size_t>(count));
    std::vector<unsigned char> buffer(messages.longest());
    publish(buffer);
    const auto write = [&](std::int64_t number) {
        const int size = static_cast<int>(messages.size(number));
        return values[static_cast<std::size_t>(number)].encode(buffer.data(), 0, size) == size;
    };
    for (std::int64_t number = 0; number < count; ++number) {
        const int size = static_cast<int>(messages.size(number));
        const bool is_read = values[static_cast<std::size_t>(number)].decode(messages.at(number), 0, size) == size;
        if (!is_read || !write(number) || std::memcmp(buffer.data(), messages.at(number), messages.size(number)) != 0) {
            return -1;
        }
    }
    return nanoseconds_in_turn(count, iterations, write);
}

}  // extern "C"
