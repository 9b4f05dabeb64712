// omniORB's generated stubs: a TimedDoubleSeq out of and into streams in memory. Its streams own what they write, so a new one is made each time.
#include <vector>

#include "BasicDataType.hh"
#include "timing.hpp"

namespace {

// omniORB swaps where it is told that the message's byte order is not the network's; a TimedDoubleSeq of ours is little-endian.
class Reading {
public:
    Reading(const Messages& messages, std::int64_t number)
        : stream(messages.at(number), static_cast<_CORBA_ULong>(messages.size(number))) {
        stream.setByteSwapFlag(true);
    }
    cdrMemoryStream stream;
};

}  // namespace

extern "C" {

double decode_ns(const char*, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const Messages messages{data, ends, count};
    RTC::TimedDoubleSeq value;
    publish(value);
    return nanoseconds_in_turn(count, iterations, [&](std::int64_t number) {
        Reading from(messages, number);
        value <<= from.stream;
        return value.data.length() > 0;
    });
}

double encode_ns(const char*, unsigned char* data, const std::int64_t* ends, std::int64_t count, std::int64_t iterations) {
    const Messages messages{data, ends, count};
    std::vector<RTC::TimedDoubleSeq> values(static_cast<std::size_t>(count));
    for (std::int64_t number = 0; number < count; ++number) {
        Reading from(messages, number);
        values[static_cast<std::size_t>(number)] <<= from.stream;
    }
    return nanoseconds_in_turn(count, iterations, [&](std::int64_t number) {
        cdrMemoryStream out(static_cast<_CORBA_ULong>(0), static_cast<_CORBA_Boolean>(1));
        out.setByteSwapFlag(true);
        values[static_cast<std::size_t>(number)] >>= out;
        return out.bufSize() == static_cast<_CORBA_ULong>(messages.size(number));
    });
}

}  // extern "C"
