// Decodes messages of three wires (a number from 0, a little-endian length, then bytes) into one object, and shows it behind each.

#include "seen.hpp"
#include <cstdio>
#include <memory>

static void show(const seen::holder &seen)
{
    std::printf("ok %s %.17g [", seen.frame.c_str(), seen.lead);
    for (const double each : seen.ranges) {
        std::printf("%.17g ", each);
    }
    const long long count = seen.count ? static_cast<long long>(*seen.count) : -1000;
    std::printf("] %lld %.17g %d %.17g [", count, seen.least, seen.ready ? 1 : 0, seen.tilt);
    for (const double each : seen.joined) {
        std::printf("%.17g ", each);
    }
    const char *between = "] ";
    for (const std::string &each : seen.names) {
        std::printf("%s%s", between, each.c_str());
        between = "|";
    }
    std::printf(" %lld", static_cast<long long>(seen.steps));
}

int main()
{
    seen::codec codec;
    seen::holder holder;
    unsigned char head[5];
    while (std::fread(head, 1, sizeof head, stdin) == sizeof head) {
        const std::size_t size = head[1] | static_cast<std::size_t>(head[2]) << 8 | static_cast<std::size_t>(head[3]) << 16 | static_cast<std::size_t>(head[4]) << 24;
        const std::unique_ptr<unsigned char[]> message(new unsigned char[size]); // exactly, so that a tool sees what is read beyond
        if (std::fread(message.get(), 1, size, stdin) != size) {
            return 1;
        }
        const auto found = head[0] == 0   ? codec.try_decode_scan(message.get(), size, holder)
                           : head[0] == 1 ? codec.try_decode_pose(message.get(), size, holder)
                                          : codec.try_decode_tilt(message.get(), size, holder);
        if (found) {
            show(holder);
        } else {
            const rosetta_jit::error &error = found.error();
            std::printf("%s %d [%s] %s", rosetta_jit::text_of(error.kind), static_cast<int>(error.offset), error.path.c_str(), error.detail.c_str());
            std::printf(error.line.empty() ? "" : " (%s)", error.line.c_str());
        }
        std::printf(" %lld %lld %lld\n", static_cast<long long>(codec.age_scan()), static_cast<long long>(codec.age_pose()), static_cast<long long>(codec.age_tilt()));
    }
    codec.reset();
    return codec.age_scan() == -1 ? 0 : 1;
}
