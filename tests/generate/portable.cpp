// A bottle through the class that reads and writes itself, and both ways to learn of errors.
#include "torso_state.hpp"
#include <iostream>

int main()
{
    const std::string bottle("\x0a\x01\0\0\3\0\0\0\0\0\0\0\0\x80\x46\x40\0\0\0\0\0\x80\x56\x40\0\0\0\0\0\0\x3e\xc0", 32);
    torso_state::portable port;
    yarp::os::ConnectionReader reader(bottle);
    std::cout << port.read(reader) << ' ' << port.message.angles.size() << ' ' << port.message.angles.at(1) << '\n';
    yarp::os::ConnectionWriter writer;
    std::cout << port.write(writer) << ' ' << writer.bytes.size() << '\n';
    yarp::os::ConnectionReader broken(bottle.substr(0, 20));
    std::cout << port.read(broken) << ' ' << port.error.what() << '\n';
    yarp::os::ConnectionReader ended(bottle, std::size_t{200} << 31);
    std::cout << port.read(ended) << ' ' << port.error.what() << '\n';
    torso_state::codec codec;
    try {
        codec.decode(bottle.data(), 20, port.message);
    } catch (const rosetta_jit::failure &failure) {
        std::cout << rosetta_jit::text_of(failure.error().kind) << ' ' << failure.error().path << ' ' << failure.error().offset << '\n';
    }
    port.message.angles.resize(2);
    std::string bytes;
    const auto refused = codec.try_encode(port.message, bytes);
    std::cout << (refused ? "written" : refused.error().what()) << '\n';
    std::cout << port.can_be_written() << ' ' << port.write(writer) << '\n';
}
