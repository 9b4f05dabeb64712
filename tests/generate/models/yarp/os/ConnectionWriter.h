#pragma once
#include <cstddef>
#include <string>

namespace yarp::os {
class ConnectionWriter {
public:
    void appendBlock(const char *data, std::size_t size) { bytes.append(data, size); }
    bool isTextMode() const { return false; }
    bool isError() const { return false; }
    std::string bytes;
};
} // namespace yarp::os
