$made
#include "$name.h"

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
    $number step;
    const char *path;
};

struct site {
    unsigned char status;
    const char *path;
    const char *detail;
    const char *line;
    $number scratch;
    $number parts;
    const struct part *part;
};

static const char *const lanes[] = {
    $lanes
};

static size_t indices_in(const char *path)
{
    size_t found = 0;
    for (; *path != 0; path++) {
        found += path[0] == '{' && path[1] == '}' ? 1u : 0u;
    }
    return found;
}

/* The field among those of a site that lacks bytes, of which `available` are there. */
static void locate(${name}_error *error, const struct site *site, int64_t available)
{
    for (int number = 0; number < site->parts; number++) {
        const struct part *part = &site->part[number];
        int64_t element = 0;
        if (part->step != 0 && available - part->offset - part->size >= 0) {
            element = (available - part->offset - part->size) / part->step + 1;
        }
        if (part->step != 0 || (int64_t)part->offset + part->size > available) {
            const size_t indices = indices_in(part->path);
            error->path = part->path;
            error->offset += part->offset + element * part->step;
            if (part->step != 0 && indices > 0) {
                error->indices[indices - 1] = element;
            }
            return;
        }
    }
}

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
    ${name}_error found = {${status}_FULL, 0, "", {0, 0, 0, 0}, "", 0, "", 0, 0, 0};
    (void)holder;
    found.status = (${name}_status)site->status;
    found.site = (int)failure->site;
    found.path = site->path;
    found.detail = site->detail;
    found.line = site->line;
    if (failure->site == 0) {
        found.lane = failure->offset;
        found.missing = failure->indices[0];
        found.path = lanes[failure->offset];
    } else {
        found.offset = failure->offset;
        memcpy(found.indices, failure->indices, sizeof found.indices);
        locate(&found, site, available);
    }
    found.detail_size = length_of(found.detail);
$said    if (error != NULL) {
        *error = found;
    }
    return found.status;
}

$functions

size_t ${name}_error_path(const ${name}_error *error, char *text, size_t size)
{
    size_t length = 0;
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
    switch (status) {
$texts
    }
    return "unknown";
#endif
}
