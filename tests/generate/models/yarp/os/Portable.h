// A model of YARP's classes: their signatures, and a connection that is a string.
#pragma once
#include <yarp/os/ConnectionReader.h>
#include <yarp/os/ConnectionWriter.h>

namespace yarp::os {
class Portable {
public:
    virtual ~Portable() = default;
    virtual bool read(ConnectionReader &reader) = 0;
    virtual bool write(ConnectionWriter &writer) const = 0;
};
} // namespace yarp::os
