$made
#ifndef $guard
#define $guard

$includes

namespace $name {

$classes
/* Reads and writes messages. It keeps memory from one message to the next, so that none is allocated in the long run; each thread needs its own. */
class codec {
public:
    codec();
    ~codec();
    codec(codec &&) noexcept;
    codec &operator=(codec &&) noexcept;

$declarations
    /* What `now()` (ns since 1970) and `counter()` say in the mapping. */
    std::int64_t now = 0;
    std::int64_t number = 0;
$state

private:
$hidden    struct memory;
    std::unique_ptr<memory> memory_;
$written};

$functions
$around
} // namespace $name

#endif
