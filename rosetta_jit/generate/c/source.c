$made
$roundings#include "$name.h"

$includes

_Static_assert((unsigned char)-1 == 255 && sizeof(int) >= 4, "bytes of eight bits, and an int of 32 at least, are needed");
_Static_assert(sizeof(float) == 4 && sizeof(double) == 8, "floating-point numbers of IEEE 754 are needed");
_Static_assert(FLT_EVAL_METHOD != 2, "floating-point numbers must not be computed with more digits: use SSE, not x87");
_Static_assert(-1 >> 1 == -1 && (int8_t)255u == -1, "integers must be two's complement throughout");
$asserts

$support

/* Without texts an error has its status, its offset and the number of its site, a row of the tables below. */
#ifdef ${status}_NO_TEXTS
#define TEXT(text) ""
#else
#define TEXT(text) text
#endif

/* What can be wrong with a message, and where. A `{}` in a path stands for an index; parts tell fields apart that are checked at once. */
struct part {
    $number offset;
    $number size;
$step    const char *path;
};

struct site {
    unsigned char status;
$scratch    $number parts;
    const char *path;
    const char *detail;
    const char *line;
    const struct part *part;
};

static const char *const lanes[] = {
    $lanes
};

$locate
static size_t length_of(const char *text)
{
    size_t length = 0;
    while (text[length] != 0) {
        length++;
    }
    return length;
}

/* Tells the caller of a failure, and forgets what the function did before. */
static ${name}_status report(${name}_error *error, const struct site *sites, const struct failure *failure, int64_t available,
                             const ${name}_holder *holder)
{
    const struct site *site = &sites[failure->site];
    const ${name}_status status = (${name}_status)site->status;
    (void)holder;
    if (error == NULL) {
        return status;
    }
    memset(error, 0, sizeof *error);
    error->status = status;
    error->site = (int)failure->site;
    error->path = site->path;
    error->detail = site->detail;
    error->line = site->line;
    if (failure->site == 0) {
        error->lane = failure->offset;
        error->missing = failure->indices[0];
        error->path = lanes[failure->offset];
    } else {
        error->offset = failure->offset;
        memcpy(error->indices, failure->indices, sizeof error->indices);
        locate(error, site, available);
    }
    error->detail_size = length_of(error->detail);
$said    return status;
}

$functions

size_t ${name}_error_path(const ${name}_error *error, char *text, size_t size)
{
    size_t length = 0;
#ifdef ${status}_NO_TEXTS
    (void)error;
#else
    size_t index = 0;
    for (const char *at = error->path; *at != 0; at++) {
        char digits[24];
        size_t count = 0;
        if (at[0] == '{' && at[1] == '}' && index < 4) {
            const int64_t number = error->indices[index++];
            uint64_t rest = number < 0 ? 0u - (uint64_t)number : (uint64_t)number;
            do {
                digits[count++] = (char)('0' + (int)(rest % 10u));
                rest /= 10u;
            } while (rest != 0);
            if (number < 0) {
                digits[count++] = '-';
            }
            at++;
        } else {
            digits[count++] = *at;
        }
        while (count > 0) {
            count--;
            if (length + 1 < size) {
                text[length] = digits[count];
            }
            length++;
        }
    }
#endif
    if (size > 0) {
        text[length < size ? length : size - 1] = 0;
    }
    return length;
}

const char *${name}_status_text(${name}_status status)
{
#ifdef ${status}_NO_TEXTS
    (void)status;
    return "";
#else
    static const char texts[] =
$texts
        "unknown";
    const char *text = texts;
    for (int number = (int)status < 0 || (int)status > $last ? $count : (int)status; number > 0; number--) {
        text += length_of(text) + 1;
    }
    return text;
#endif
}
