// omniORB's generated stubs: a TimedDoubleSeq out of and into streams in memory. Its streams own what they write, so a new one is made each time.
#include <cstring>

#include "BasicDataType.hh"
#include "timing.hpp"

namespace {

// omniORB swaps where it is told that the message's byte order is not the network's; a TimedDoubleSeq of ours is little-endian.
class Reading {
public:
    Reading(const unsigned char* message, std::int64_t size) : stream(const_cast<unsigned char*>(message), static_cast<_CORBA_ULong>(size)) {
        stream.setByteSwapFlag(true);
    }
    cdrMemoryStream stream;
};

}  // namespace

extern "C" {

double decode_ns(const char*, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    RTC::TimedDoubleSeq value;
    publish(value);
    return nanoseconds(iterations, [&] {
        Reading from(message, size);
        value <<= from.stream;
        return value.data.length() > 0;
    });
}

double encode_ns(const char*, const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    RTC::TimedDoubleSeq value;
    Reading from(message, size);
    value <<= from.stream;
    bool same = false;
    const double took = nanoseconds(iterations, [&] {
        cdrMemoryStream out(static_cast<_CORBA_ULong>(0), static_cast<_CORBA_Boolean>(1));
        out.setByteSwapFlag(true);
        value >>= out;
        same = out.bufSize() == static_cast<_CORBA_ULong>(size);
        return same;
    });
    return same ? took : -1;
}

}  // extern "C"
