// The dynamic decoder, real YARP: a bottle out of bytes, and what has a class of its own as it is read from a socket.
#include <algorithm>
#include <cstring>

#include <yarp/conf/version.h>
#include <yarp/os/Bottle.h>
#include <yarp/os/InputStream.h>
#include <yarp/os/Route.h>
#include <yarp/os/impl/StreamConnectionReader.h>
#include <yarp/sig/Image.h>
#include <yarp/sig/Vector.h>

#include "timing.hpp"

namespace {

// A stream that gives a message out of the memory where it lies.
class Message : public yarp::os::InputStream {
public:
    using yarp::os::InputStream::read;

    Message(const unsigned char* data, std::size_t size) : data_(data), size_(size) {}

    yarp::conf::ssize_t read(yarp::os::Bytes& target) override {
        const std::size_t taken = std::min(target.length(), size_ - at_);
        std::memcpy(target.get(), data_ + at_, taken);
        at_ += taken;
        return static_cast<yarp::conf::ssize_t>(taken);
    }

    void close() override {}
    bool isOk() const override { return true; }

private:
    const unsigned char* data_;
    std::size_t size_;
    std::size_t at_ = 0;
};

template <typename Readable>
double read_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    Readable value;
    publish(value);
    const yarp::os::Route route;
    return nanoseconds(iterations, [&] {
        Message stream(message, static_cast<std::size_t>(size));
        yarp::os::impl::StreamConnectionReader reader;
        reader.reset(stream, nullptr, route, static_cast<std::size_t>(size), false);
        return value.read(reader);
    });
}

}  // namespace

extern "C" {

const char* dynamic_decoder() { return "YARP " YARP_VERSION; }

// What it reads, so that it can be compared.
std::int64_t dynamic_values(const unsigned char* message, std::int64_t size, double* values, std::int64_t room) {
    yarp::os::Bottle bottle;
    bottle.fromBinary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size));
    const auto count = static_cast<std::int64_t>(bottle.size());
    for (std::int64_t index = 0; index < count && index < room; ++index) {
        values[index] = bottle.get(static_cast<std::size_t>(index)).asFloat64();
    }
    return count;
}

double dynamic_decode_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    yarp::os::Bottle bottle;
    return nanoseconds(iterations, [&] {
        bottle.fromBinary(reinterpret_cast<const char*>(message), static_cast<std::size_t>(size));
        return bottle.size() > 0;
    });
}

double yarp_image_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    return read_ns<yarp::sig::ImageOf<yarp::sig::PixelRgb>>(message, size, iterations);
}

double yarp_vector_ns(const unsigned char* message, std::int64_t size, std::int64_t iterations) {
    return read_ns<yarp::sig::Vector>(message, size, iterations);
}

}  // extern "C"
