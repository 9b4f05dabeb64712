#include <yarp/os/Bottle.h>
#include <yarp/os/ConnectionReader.h>
#include <yarp/os/ConnectionWriter.h>
#include <yarp/os/Portable.h>
#include <algorithm>
$clock#include <string>

/* A message that reads and writes itself on a YARP port. What is wrong with the last one that was refused is in `error`. */
struct portable : public yarp::os::Portable {
    holder message;
    mutable rosetta_jit::error error;

    /* A connection stays open where this returns false. */
    bool read(yarp::os::ConnectionReader &connection) override
    {
        if (const auto *const sent = dynamic_cast<const portable *>(connection.getReference())) {
            message = sent->message; /* of the same process, by the carrier `local`, which sends no bytes */
            return true;
        }
        if (!take(connection)) {
            error = {rosetta_jit::status::truncated, "", static_cast<std::int64_t>(incoming_.size()), "the connection ends here", ""};
            return false;
        }
$begins        const auto found = codec_.try_decode(incoming_.data(), incoming_.size(), message);
$ends        error = found ? rosetta_jit::error{} : found.error();
        return found.has_value();
    }

    /* YARP closes a connection where this returns false: `can_be_written` says so before. */
    bool write(yarp::os::ConnectionWriter &connection) const override
    {
        std::string bytes;
        if (!put(bytes)) {
            return false;
        }
        if (connection.isTextMode()) {
            yarp::os::Bottle shown;
            shown.fromBinary(bytes.data(), bytes.size());
            return shown.write(connection);
        }
        connection.appendBlock(bytes.data(), bytes.size());
        return !connection.isError();
    }

    bool can_be_written() const
    {
        std::string bytes;
        return put(bytes);
    }

private:
    /* All of a message. A sender says how long it is: memory is taken as its bytes come. Text is a bottle's. */
    bool take(yarp::os::ConnectionReader &connection)
    {
        if (connection.isTextMode()) {
            yarp::os::Bottle shown;
            const bool is_read = shown.read(connection);
            std::size_t length = 0;
            const char *const bytes = shown.toBinary(&length);
            incoming_.assign(bytes, length);
            return is_read;
        }
        const std::size_t size = connection.getSize();
        std::size_t there = 0;
        incoming_.clear();
        while (there < size) {
            const std::size_t more = std::min(size - there, std::max(there, std::size_t{1} << 20));
            incoming_.resize(there + more);
            if (!connection.expectBlock(&incoming_[there], more)) {
                incoming_.resize(there);
                return false;
            }
            there += more;
        }
        return connection.isValid();
    }

    bool put(std::string &bytes) const
    {
$begins        const auto made = codec_.try_encode(message, bytes);
$ends        error = made ? rosetta_jit::error{} : made.error();
        return made.has_value();
    }
$nanoseconds
    mutable codec codec_;
    std::string incoming_;
};
