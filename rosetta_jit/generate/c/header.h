$made
#ifndef $guard
#define $guard

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a message. All but OK and FULL say what is wrong with it. */
typedef enum ${name}_status {
$statuses
} ${name}_status;

/* Elements of an array or text: rows `start` to `start + count` of a lane. */
typedef struct ${name}_span {
    int64_t start;
    int64_t count;
} ${name}_span;

$structs

$values$state/* A message. Its arrays and texts lie in lanes, whose memory the caller gives: `rows` with room for `capacity`, of which `used` are taken. */
typedef struct ${name}_holder {
    $root message;
$members
} ${name}_holder;

/* What is wrong with a message. Where ${status}_NO_TEXTS is defined for the source, all texts are empty. Texts live as long as the program, `detail` of a rejected message as long as the holder stays as it is. */
typedef struct ${name}_error {
    ${name}_status status;
    int64_t offset; /* of the message's byte */
    const char *path; /* the field, as `.joints[{}].name`, with `{}` for each of the indices; of a full lane, its name */
    int64_t indices[4];
    const char *detail; /* one sentence for a person */
    size_t detail_size;
    const char *line; /* of the mapping, where one of its rules is to blame */
    int64_t lane; /* that is full, counted from 1 in the order of the holder */
    int64_t missing; /* rows that it lacks (of scratch memory, bytes) */
    int site; /* the row of the function's table of errors */
} ${name}_error;

$declarations

/* Makes a message empty, and keeps its memory. */
void ${name}_clear(${name}_holder *holder);

/* The path of an error with its indices, as much as there is room for, ended by a 0. Returns its length, as snprintf does. */
size_t ${name}_error_path(const ${name}_error *error, char *text, size_t size);

/* A status as a word. */
const char *${name}_status_text(${name}_status status);

$memory

$accessors
#ifdef __cplusplus
}
#endif

#endif
