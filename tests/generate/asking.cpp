// What a mapping asks the host, on a port.
#include "number.hpp"
#include <chrono>
#include <iostream>

int main()
{
    number::portable port;
    for (int i = 0; i < 3; ++i) {
        yarp::os::ConnectionReader reader(std::string("\1\1\0\0\1\0\0\0\x28\0\0\0", 12));
        port.read(reader);
        const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
        std::cout << port.message.value << ' ' << (port.message.now <= now && now - port.message.now < 60'000'000'000) << '\n';
    }
}
