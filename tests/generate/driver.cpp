// Reads messages from standard input, each behind its size in four bytes, and says what a generated codec makes of each: the message that it
// writes of what it read, or the error. HEADER declares the units, which UNITS lists as EACH(name); the first argument names one if there are several.
#include HEADER
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

static void show(const rosetta_jit::error &error, bool is_read)
{
    std::printf("%s ", rosetta_jit::text_of(error.kind));
    if (is_read) {
        std::printf("%lld ", static_cast<long long>(error.offset));
    }
    std::printf("[%s] ", error.path.c_str());
    std::fwrite(error.detail.data(), 1, error.detail.size(), stdout); // it may have a text of the message, and that a NUL
    std::printf(error.line.empty() ? "\n" : " (%s)\n", error.line.c_str());
}

template <class Codec, class Holder> static void answer(Codec &codec, Holder &holder, const unsigned char *message, std::size_t size)
{
    const auto read = codec.try_decode(message, size, holder);
    if (!read) {
        show(read.error(), true);
        return;
    }
    const auto needed = codec.try_size(holder);
    if (!needed) {
        show(needed.error(), false);
        return;
    }
    const std::unique_ptr<unsigned char[]> copy(new unsigned char[*needed]); // exactly, so that a tool sees what is written beyond
    const auto written = codec.try_encode(holder, copy.get(), *needed);
    if (!written) {
        show(written.error(), false);
        return;
    }
    std::string again;
    if (!codec.try_encode(holder, again) || again.size() != *written || again.compare(0, *written, reinterpret_cast<char *>(copy.get()), *written) != 0) {
        std::printf("the two ways to encode differ\n");
        return;
    }
    for (const std::size_t room : {std::size_t{0}, std::size_t{1}, std::size_t{5}, *written / 2, *written > 0 ? *written - 1 : 0}) {
        const std::unique_ptr<unsigned char[]> few(new unsigned char[room]);
        if (room < *written && codec.try_encode(holder, few.get(), room)) {
            std::printf("written without room\n");
            return;
        }
    }
    std::printf("ok ");
    for (std::size_t at = 0; at < *written; at++) {
        std::printf("%02x", copy[at]);
    }
    std::printf("\n");
}

template <class Codec, class Holder> static int answer_all()
{
    Codec codec;
    Holder holder; // the same for all: nothing of one message may be left in the next
    unsigned char head[4];
    while (std::fread(head, 1, sizeof head, stdin) == sizeof head) {
        const std::size_t size = head[0] | static_cast<std::size_t>(head[1]) << 8 | static_cast<std::size_t>(head[2]) << 16 | static_cast<std::size_t>(head[3]) << 24;
        const std::unique_ptr<unsigned char[]> message(new unsigned char[size]);
        if (std::fread(message.get(), 1, size, stdin) != size) {
            return 1;
        }
        answer(codec, holder, message.get(), size);
    }
    return 0;
}

int main(int count, char **arguments)
{
#define EACH(unit) \
    if (count < 2 || std::strcmp(arguments[1], #unit) == 0) { \
        return answer_all<unit::codec, unit::holder>(); \
    }
    UNITS
    return 2;
}
