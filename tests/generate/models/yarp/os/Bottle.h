#pragma once
#include <yarp/os/ConnectionReader.h>
#include <yarp/os/ConnectionWriter.h>

namespace yarp::os {
class Bottle {
public:
    bool read(ConnectionReader &) { return false; }
    bool write(ConnectionWriter &) const { return false; }
    void fromBinary(const char *bytes, std::size_t size) { bytes_.assign(bytes, size); }
    const char *toBinary(std::size_t *size)
    {
        *size = bytes_.size();
        return bytes_.data();
    }

private:
    std::string bytes_;
};
} // namespace yarp::os
