// A message in a class of a framework's, decoded and encoded by the code that `rosetta-jit generate` writes for that class, and by the framework's own.
// HEADER and UNIT are those of the generated unit, which is compiled by itself; ROS1, ROS2, PROTOBUF or LCM says whose class it is. rclcpp's structs have no code
// of their own that reads them, but ROS 2's middleware has: with FASTCDR it is Fast CDR, as rmw_fastrtps calls it. Without, roscpp's struct of the same data,
// which PEER_HEADER declares, is filled beside them, behind the four bytes of the encapsulation. The program gets two files, a message for ours and the
// same for theirs, the number of rounds, and the seconds of one; it prints nanoseconds a message, a line for who and job.
#include HEADER
#if defined(FASTCDR)
#include "fastcdr_structs.hpp"
#elif defined(ROS2)
#include PEER_HEADER
#endif
#include "timing.hpp"

#if defined(PROTOBUF)
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#endif

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

namespace {

using Message = UNIT::holder;
#if defined(ROS2) && !defined(FASTCDR)
using Theirs = PEER;
#else
using Theirs = Message;
#endif

using Bytes = std::vector<unsigned char>;

// Several places for a message, of which each turn reads or writes another: where two blocks lie modulo a page can make a copy ten times slower. They are
// the same for ours and for theirs: how fast memory is depends on which one it is.
struct Places {
    static constexpr std::size_t COUNT = 5, STEP = 1376;
    std::vector<Bytes> memory;

    explicit Places(std::size_t size) {
        for (std::size_t place = 0; place < COUNT; place++) {
            memory.emplace_back(place * STEP + size);
        }
    }
    unsigned char* of(int turn, const Bytes& message) {
        const std::size_t place = static_cast<std::size_t>(turn) % COUNT;
        unsigned char* const at = memory[place].data() + place * STEP;
        std::copy(message.begin(), message.end(), at);
        return at;
    }
};

#if defined(FASTCDR)
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

bool theirs_read(const unsigned char* data, std::size_t size, Theirs& message) {
    FastBuffer buffer(reinterpret_cast<char*>(const_cast<unsigned char*>(data)), size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    try {
        cdr.read_encapsulation();
        fastcdr_structs::read(cdr, message);
        return true;
    } catch (const eprosima::fastcdr::exception::Exception&) {
        return false;
    }
}

bool theirs_write(const Theirs& message, unsigned char* data, std::size_t size) {
    FastBuffer buffer(reinterpret_cast<char*>(data), size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    fastcdr_structs::write(cdr, message);
    return true;
}
#elif defined(ROS1) || defined(ROS2)
#if defined(ROS2)
constexpr std::size_t ENCAPSULATION = 4;
#else
constexpr std::size_t ENCAPSULATION = 0;
#endif

// Whether data is little-endian CDR, or none.
bool is_encapsulated(const unsigned char* data, std::size_t size) {
    return ENCAPSULATION == 0 || (size >= ENCAPSULATION && data[0] == 0 && data[1] == 1);
}

bool theirs_read(const unsigned char* data, std::size_t size, Theirs& message) {
    if (!is_encapsulated(data, size)) {
        return false;
    }
    ros::serialization::IStream stream(const_cast<unsigned char*>(data) + ENCAPSULATION, static_cast<std::uint32_t>(size - ENCAPSULATION));
    ros::serialization::deserialize(stream, message);
    return true;
}

bool theirs_write(const Theirs& message, unsigned char* data, std::size_t size) {
    const unsigned char encapsulation[] = {0, 1, 0, 0};
    std::copy(encapsulation, encapsulation + ENCAPSULATION, data);
    ros::serialization::OStream stream(data + ENCAPSULATION, static_cast<std::uint32_t>(size - ENCAPSULATION));
    ros::serialization::serialize(stream, message);
    return true;
}

// The message as the framework writes it whatever it was read from, to be compared.
std::string canonical(const Theirs& message) {
    std::string found(ENCAPSULATION + ros::serialization::serializationLength(message), 0);
    theirs_write(message, reinterpret_cast<unsigned char*>(&found[0]), found.size());
    return found;
}
#elif defined(LCM)
bool theirs_read(const unsigned char* data, std::size_t size, Theirs& message) { return message.decode(data, 0, static_cast<int>(size)) >= 0; }

bool theirs_write(const Theirs& message, unsigned char* data, std::size_t size) { return message.encode(data, 0, static_cast<int>(size)) >= 0; }

// The message as the framework writes it whatever it was read from, to be compared.
std::string canonical(const Theirs& message) {
    std::string found(static_cast<std::size_t>(message.getEncodedSize()), 0);
    theirs_write(message, reinterpret_cast<unsigned char*>(&found[0]), found.size());
    return found;
}
#elif defined(PROTOBUF)
bool theirs_read(const unsigned char* data, std::size_t size, Theirs& message) { return message.ParseFromArray(data, static_cast<int>(size)); }

bool theirs_write(const Theirs& message, unsigned char* data, std::size_t size) { return message.SerializeToArray(data, static_cast<int>(size)); }

// The message as the framework writes it whatever it was read from, to be compared: entries of maps in order.
std::string canonical(const Theirs& message) {
    std::string found;
    {
        google::protobuf::io::StringOutputStream stream(&found);
        google::protobuf::io::CodedOutputStream coded(&stream);
        coded.SetSerializationDeterministic(true);
        message.SerializeToCodedStream(&coded);
    }
    return found;
}
#endif

template <class Class, class Read> double read(Read work, std::int64_t iterations) {
    Class message;
    publish(message);
    return work(message) ? nanoseconds(iterations, [&] { return work(message); }) : -1;  // its memory is there then
}

template <class Class, class Read> double read_anew(Read work, std::int64_t iterations) {
    return nanoseconds(iterations, [&] {
        Class message;
        publish(message);
        const bool done = work(message);
        publish(message);  // else a compiler may leave out to set what nobody reads before it is gone
        return done;
    });
}

template <class Class, class Write> double write(const Class& message, unsigned char* place, Write work, std::int64_t iterations) {
    publish(message);
    publish(place);
    return nanoseconds(iterations, [&] { return work(message, place); });
}

// Messages of a few bytes in turn: where each of them lies is in memory, as in a program that gets one after the other. In a loop over a single one a
// compiler finds out once, before the loop, where the message ends.
constexpr std::size_t FEW_BYTES = 16, MANY = 64;

struct Given {
    const unsigned char* data;
    std::size_t size;
};

template <class Class, class Read> double read_in_turn(const Bytes& one, Read work, std::int64_t iterations) {
    std::vector<unsigned char> memory(MANY * FEW_BYTES);
    Given given[MANY];
    for (std::size_t number = 0; number < MANY; number++) {
        given[number] = {std::copy(one.begin(), one.end(), &memory[number * FEW_BYTES]) - one.size(), one.size()};
    }
    Class message;
    publish(message);
    publish(given);
    const double took = nanoseconds(std::max<std::int64_t>(1, iterations / static_cast<std::int64_t>(MANY)), [&] {
        for (const Given& each : given) {
            forget();
            if (!work(each.data, each.size, message)) {
                return false;
            }
        }
        return true;
    });
    return took < 0 ? took : took / static_cast<double>(MANY);
}

// Whether what ours reads from the one message is what theirs reads from the other, and comes back the same.
bool agree(UNIT::codec& codec, const Message& one, const Theirs& other, const Bytes& ours) {
    std::string written;
#if defined(ROS2)
    const std::string expected(ours.begin(), ours.end());
    if (!codec.try_encode(one, written) || written != expected || one.header.frame_id != other.header.frame_id) {
        return false;
    }
#if defined(FASTCDR)
    std::string theirs(ours.size(), 0);
    return one == other && theirs_write(other, reinterpret_cast<unsigned char*>(&theirs[0]), theirs.size()) && theirs == expected;
#else
    return true;
#endif
#else
    Message again;
    if (ours.empty() || canonical(one) != canonical(other) || !codec.try_encode(other, written)) {
        return false;
    }
    return codec.try_decode(written.data(), written.size(), again) && canonical(again) == canonical(other);
#endif
}

Bytes content(const char* path) {
    std::ifstream file(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

struct Contender {
    const char* name;
    std::function<double(std::int64_t iterations, int turn)> job;
    std::int64_t iterations;
};

}  // namespace

int main(int, char** arguments) {
    const Bytes ours = content(arguments[1]), theirs = content(arguments[2]);
    const int rounds = std::atoi(arguments[3]);
    const double round_ns = 1e9 * std::atof(arguments[4]);
    static UNIT::codec codec;
    Message one;
    Theirs other;
    if (!codec.try_decode(ours.data(), ours.size(), one) || !theirs_read(theirs.data(), theirs.size(), other) || !agree(codec, one, other, ours)) {
        std::fputs("the messages that are read or written differ\n", stderr);
        return 1;
    }
    Places places(std::max(ours.size(), theirs.size()));
    const auto encode = [&](const Message& message, unsigned char* buffer) { return codec.try_encode(message, buffer, ours.size()).has_value(); };
    const auto peer_encode = [&](const Theirs& message, unsigned char* buffer) { return theirs_write(message, buffer, theirs.size()); };
    std::vector<Contender> contenders = {
        {"ours decode", [&](std::int64_t iterations, int turn) {
            const unsigned char* const data = places.of(turn, ours);
            const std::size_t size = ours.size();
            return read<Message>([=](Message& message) { return codec.try_decode(data, size, message).has_value(); }, iterations);
        }, 0},
        {"theirs decode", [&](std::int64_t iterations, int turn) {
            const unsigned char* const data = places.of(turn, theirs);
            const std::size_t size = theirs.size();
            return read<Theirs>([=](Theirs& message) { return theirs_read(data, size, message); }, iterations);
        }, 0},
        {"ours anew", [&](std::int64_t iterations, int turn) {
            const unsigned char* const data = places.of(turn, ours);
            const std::size_t size = ours.size();
            return read_anew<Message>([=](Message& message) { return codec.try_decode(data, size, message).has_value(); }, iterations);
        }, 0},
        {"theirs anew", [&](std::int64_t iterations, int turn) {
            const unsigned char* const data = places.of(turn, theirs);
            const std::size_t size = theirs.size();
            return read_anew<Theirs>([=](Theirs& message) { return theirs_read(data, size, message); }, iterations);
        }, 0},
        {"ours encode", [&](std::int64_t iterations, int turn) { return write(one, places.of(turn, ours), encode, iterations); }, 0},
        {"theirs encode", [&](std::int64_t iterations, int turn) { return write(other, places.of(turn, theirs), peer_encode, iterations); }, 0},
    };
    if (std::max(ours.size(), theirs.size()) <= FEW_BYTES) {
        const auto decode = [](const unsigned char* data, std::size_t size, Message& message) { return codec.try_decode(data, size, message).has_value(); };
        contenders.push_back({"ours turn", [&, decode](std::int64_t iterations, int) { return read_in_turn<Message>(ours, decode, iterations); }, 0});
        const auto peer_decode = [](const unsigned char* data, std::size_t size, Theirs& message) { return theirs_read(data, size, message); };
        contenders.push_back({"theirs turn", [&, peer_decode](std::int64_t iterations, int) { return read_in_turn<Theirs>(theirs, peer_decode, iterations); }, 0});
    }
    for (Contender& each : contenders) {
        each.iterations = std::max<std::int64_t>(1, static_cast<std::int64_t>(round_ns / std::max(each.job(100, 0), 0.1)));
    }
    constexpr int TURNS = 10;
    const int count = static_cast<int>(contenders.size());
    for (int round = 0; round < rounds; round++) {
        std::vector<double> took(contenders.size());
        for (int turn = 0; turn < TURNS; turn++) {  // so that a busy moment of the machine hits all alike; who comes first changes
            for (int number = 0; number < count; number++) {
                const std::size_t place = static_cast<std::size_t>(number + turn) % contenders.size();
                const Contender& each = contenders[place];
                const double taken = each.job(std::max<std::int64_t>(1, each.iterations / TURNS), turn);
                if (taken < 0) {
                    return 1;
                }
                took[place] += taken / TURNS;
            }
        }
        for (std::size_t number = 0; number < contenders.size(); number++) {
            std::printf("%s %.3f\n", contenders[number].name, took[number]);
        }
    }
    return 0;
}
