/* == decode == */
    /* Reads a message. After a failure the holder is in a valid state, and what it has is not said. */
    rosetta_jit::result<rosetta_jit::done> try_decode(const void *bytes, std::size_t size, holder &target)
    {
$reads
        return decode_any(bytes, size, target);
    }

    /* The same; throws rosetta_jit::failure. */
    void decode(const void *bytes, std::size_t size, holder &target) { static_cast<void>(try_decode(bytes, size, target).value()); }
#if __cplusplus >= 202002L
    void decode(std::span<const std::byte> bytes, holder &target) { decode(bytes.data(), bytes.size(), target); }
#endif
/* == reads == */
        if (ROSETTA_JIT_LIKELY($read)) {
            return rosetta_jit::done{};
        }
/* == read_at_once_private == */
    /* Reads a message as nearly all are, where a compiler sees the object, too; false where it is another one, or something is wrong with it. */
    static bool is_read(const unsigned char *__restrict bytes, std::int64_t end, holder &given_object)
    {
$statements
        return true;
    }

/* == read_at_once_called_private == */
    /* Reads a message as nearly all are; false where it is another one, or something is wrong with it. */
    ROSETTA_JIT_APART static bool is_read(const unsigned char *__restrict bytes, std::int64_t end, holder &given_object)
    {
$statements
        return true;
    }

/* == read_empty_at_once_private == */
    /* Reads a message whose texts and lists are all empty; false where it is another one. */
    ROSETTA_JIT_INLINE static bool is_read_empty(const unsigned char *__restrict bytes, std::int64_t end, holder &given_object)
    {
$statements
        return true;
    }

/* == decode_any_private == */
    /* Reads any message, and says what is wrong with it. */
    rosetta_jit::detail::outcome<rosetta_jit::done> decode_any(const void *bytes, std::size_t size, holder &target);

/* == puts == */
        const std::int64_t size = put_at_once(source, static_cast<unsigned char *>(bytes), static_cast<std::int64_t>(capacity));
        if (ROSETTA_JIT_LIKELY(size >= 0)) {
            return static_cast<std::size_t>(size);
        }
/* == puts_empty == */
        const std::int64_t empty_size = put_empty_at_once(source, static_cast<unsigned char *>(bytes), static_cast<std::int64_t>(capacity));
        if (empty_size >= 0) {
            return static_cast<std::size_t>(empty_size);
        }
/* == put_each_private == */
    /* Writes elements of a list, of which there is one at least, and says where they end; a negative number where anything is wrong. */
    ROSETTA_JIT_APART static std::int64_t $name(const holder &given_object, unsigned char *__restrict bytes, std::int64_t end, $parameters)
    {
$statements
    }

/* == put_empty_at_once_private == */
    /* Writes a message without elements that have texts or lists; a negative number where it is another one, or anything is wrong. */
    static std::int64_t put_empty_at_once(const holder &given_object, unsigned char *__restrict bytes, std::int64_t end)
    {
$statements
    }

/* == put_at_once_private == */
    /* Writes a message where a compiler sees the object, too, and says how many bytes it took; a negative number where anything is wrong. */
    static std::int64_t put_at_once(const holder &given_object, unsigned char *__restrict bytes, std::int64_t end)
    {
$statements
    }

/* == encode_any_private == */
    /* Writes any message, and says what is wrong with it. */
    rosetta_jit::detail::outcome<std::size_t> encode_any(const holder &source, void *bytes, std::size_t capacity);

/* == wire == */
    /* Reads a message of `$wire`, and sets what its messages tell: the rest of the target stays. One that is refused changes nothing. */
    rosetta_jit::result<rosetta_jit::done> try_decode_$wire(const void *bytes, std::size_t size, holder &target);

    /* The same; throws rosetta_jit::failure. */
    void decode_$wire(const void *bytes, std::size_t size, holder &target) { static_cast<void>(try_decode_$wire(bytes, size, target).value()); }
#if __cplusplus >= 202002L
    void decode_$wire(std::span<const std::byte> bytes, holder &target) { decode_$wire(bytes.data(), bytes.size(), target); }
#endif

    /* How many messages of all wires have been decoded since the last one of `$wire`; -1 before the first. */
    std::int64_t age_$wire() const noexcept { return kept.unpack[$last] == 0 ? -1 : kept.unpack[$every] - kept.unpack[$last]; }
/* == encode == */
    /* How many bytes the message takes. */
    rosetta_jit::result<std::size_t> try_size(const holder &source);

    /* Writes the message to `bytes`, which has `capacity` of them, and says how many it took. */
    rosetta_jit::result<std::size_t> try_encode(const holder &source, void *bytes, std::size_t capacity)
    {
$puts
        return encode_any(source, bytes, capacity);
    }

    /* Makes a string the message. */
    rosetta_jit::result<rosetta_jit::done> try_encode(const holder &source, std::string &bytes);

    /* The message; throws rosetta_jit::failure. */
    std::string encode(const holder &source)
    {
        std::string bytes;
        static_cast<void>(try_encode(source, bytes).value());
        return bytes;
    }
#if __cplusplus >= 202002L
    std::size_t encode(const holder &source, std::span<std::byte> bytes) { return try_encode(source, bytes.data(), bytes.size()).value(); }
#endif
