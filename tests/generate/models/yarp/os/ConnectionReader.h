#pragma once
#include <cstddef>
#include <cstring>
#include <string>

namespace yarp::os {
class ConnectionReader {
public:
    explicit ConnectionReader(std::string bytes) : bytes_(std::move(bytes)) {}
    bool expectBlock(char *target, std::size_t size)
    {
        if (size > bytes_.size()) {
            return false;
        }
        std::memcpy(target, bytes_.data(), size);
        bytes_.erase(0, size);
        return true;
    }
    std::size_t getSize() const { return bytes_.size(); }
    bool convertTextMode() { return true; }

private:
    std::string bytes_;
};
} // namespace yarp::os
