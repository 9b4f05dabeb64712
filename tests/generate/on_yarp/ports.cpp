// Messages from one port to another, by several carriers: good ones, and a broken one between them.
#include "torso_state.hpp"
#include <yarp/os/Bottle.h>
#include <yarp/os/Network.h>
#include <yarp/os/Port.h>
#include <iostream>
#include <thread>

using torso_state::portable;

// A message of two angles.
struct broken : public portable {
    bool write(yarp::os::ConnectionWriter &connection) const override
    {
        yarp::os::Bottle two;
        two.fromString("45.0 90.0");
        return two.write(connection);
    }
};

// Shows each message that a port gets.
struct shows : public yarp::os::PortReader {
    const char *carrier = "";
    portable found;

    bool read(yarp::os::ConnectionReader &connection) override
    {
        if (!connection.isValid()) {
            return false;
        }
        const bool is_read = found.read(connection);
        std::cout << carrier << ": ";
        if (is_read) {
            std::cout << found.message.angles.size() << " angles, " << found.message.angles.at(1) << std::endl;
        } else {
            std::cout << found.error.what() << std::endl;
        }
        return is_read;
    }
};

// What the documentation shows.
void example(yarp::os::Port &port)
{
#include "example.inc"
}

int main()
{
    yarp::os::Network network;
    yarp::os::Network::setLocalMode(true);
    yarp::os::Port from, to;
    shows reader;
    to.setReader(reader);
    to.open("/to");
    from.open("/from");
    portable sent;
    sent.message.angles = {0.785398F, 1.5708F, -0.523599F};
    const broken wrong;
    for (const char *const carrier : {"tcp", "local", "text_ack"}) {
        reader.carrier = carrier;
        if (!yarp::os::Network::connect("/from", "/to", carrier)) {
            return 1;
        }
        from.write(sent);
        if (std::string(carrier) != "local") {
            from.write(wrong);
            from.write(sent);
        }
        yarp::os::Network::disconnect("/from", "/to");
    }
    yarp::os::Port waiting;
    waiting.open("/waiting");
    yarp::os::Network::connect("/from", "/waiting");
    std::thread writer([&] { from.write(sent); });
    example(waiting);
    writer.join();
    from.close();
    to.close();
    waiting.close();
}
