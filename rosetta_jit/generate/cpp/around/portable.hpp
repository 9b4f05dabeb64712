#include <yarp/os/ConnectionReader.h>
#include <yarp/os/ConnectionWriter.h>
#include <yarp/os/Portable.h>
#include <string>

/* A message that reads and writes itself on a YARP port. What is wrong with the last one that was refused is in `error`. */
struct portable : public yarp::os::Portable {
    holder message;
    rosetta_jit::error error;

    bool read(yarp::os::ConnectionReader &connection) override
    {
        connection.convertTextMode();
        incoming_.resize(connection.getSize());
        if (!connection.expectBlock(&incoming_[0], incoming_.size())) {
            return false;
        }
        const auto found = codec_.try_decode(incoming_.data(), incoming_.size(), message);
        error = found ? rosetta_jit::error{} : found.error();
        return found.has_value();
    }

    bool write(yarp::os::ConnectionWriter &connection) const override
    {
        std::string bytes;
        if (!codec_.try_encode(message, bytes)) {
            return false;
        }
        connection.appendBlock(bytes.data(), bytes.size());
        connection.convertTextMode();
        return !connection.isError();
    }

private:
    mutable codec codec_;
    std::string incoming_;
};
