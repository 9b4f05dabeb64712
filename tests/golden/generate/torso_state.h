/* Made by rosetta-jit. Changes will be lost. */
/* decode: yarp.icub.torso.state, yarp3 -> rst.kinematics.JointAngles, by torso_state.mapping */
/* 10: len(.angles) <-> 3 */
/* 11: .angles[0] <-> float32(radians(.yaw)) */
/* 12: .angles[1] <-> float32(radians(.roll)) */
/* 13: .angles[2] <-> float32(radians(.pitch)) */
/* encode: yarp.icub.torso.state, yarp3 <- rst.kinematics.JointAngles, by torso_state.mapping */
/* 10: len(.angles) <-> 3 */
/* 11: .angles[0] <-> float32(radians(.yaw)) */
/* 12: .angles[1] <-> float32(radians(.roll)) */
/* 13: .angles[2] <-> float32(radians(.pitch)) */
#ifndef TORSO_STATE_H
#define TORSO_STATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a message. All but OK and FULL say what is wrong with it. */
typedef enum torso_state_status {
    TORSO_STATE_OK = 0,
    TORSO_STATE_FULL = 1,
    TORSO_STATE_TRUNCATED = 2,
    TORSO_STATE_TRAILING = 3,
    TORSO_STATE_TAG = 4,
    TORSO_STATE_CONSTANT = 5,
    TORSO_STATE_COUNT = 6,
    TORSO_STATE_LENGTH = 7,
    TORSO_STATE_NESTING = 8,
    TORSO_STATE_TEXT = 9,
    TORSO_STATE_VARINT = 10,
    TORSO_STATE_RANGE = 11,
    TORSO_STATE_INDEX = 12,
    TORSO_STATE_MISSING = 13,
    TORSO_STATE_IMAGE = 14,
    TORSO_STATE_REJECTED = 15,
    TORSO_STATE_UNION = 16,
} torso_state_status;

/* Elements of an array or text: rows `start` to `start + count` of a lane. */
typedef struct torso_state_span {
    int64_t start;
    int64_t count;
} torso_state_span;

/* rst.kinematics.JointAngles */
typedef struct torso_state_JointAngles {
    torso_state_span unknown; /* fields that the schema does not know, as they came; in `unknown` */
    torso_state_span angles; /* Joint angles, in rad; in `angles` */
} torso_state_JointAngles;

/* A message. Its arrays and texts lie in lanes, whose memory the caller gives: `rows` with room for `capacity`, of which `used` are taken. */
typedef struct torso_state_holder {
    torso_state_JointAngles message;
    struct {
        uint8_t *rows;
        int64_t capacity;
        int64_t used;
    } unknown; /* 1: .(unknown) */
    struct {
        float *rows;
        int64_t capacity;
        int64_t used;
    } angles; /* 2: .angles */
    int64_t now; /* ns since 1970, for mappings that ask for it */
    int64_t number; /* of the message, for mappings that count */
} torso_state_holder;

/* What is wrong with a message. Where TORSO_STATE_NO_TEXTS is defined for the source, all texts are empty. Texts live as long as the program, `detail` of a rejected message as long as the holder stays as it is. */
typedef struct torso_state_error {
    torso_state_status status;
    int64_t offset; /* of the message's byte */
    const char *path; /* the field, as `.joints[{}].name`, with `{}` for each of the indices; of a full lane, its name */
    int64_t indices[4];
    const char *detail; /* one sentence for a person */
    size_t detail_size;
    const char *line; /* of the mapping, where one of its rules is to blame */
    int64_t lane; /* that is full, counted from 1 in the order of the holder */
    int64_t missing; /* rows that it lacks (of scratch memory, bytes) */
    int site; /* the row of the function's table of errors */
} torso_state_error;

/* Reads a message. FULL: a lane lacks room; give it more and call again. After a failure the holder is empty. */
torso_state_status torso_state_decode(torso_state_holder *holder, const void *bytes, size_t size, torso_state_error *error);

/* Writes a message to `bytes`, which has `capacity` of them, and says how many it took. */
torso_state_status torso_state_encode(const torso_state_holder *holder, void *bytes, size_t capacity, size_t *size, torso_state_error *error);

/* How many bytes the message takes. */
torso_state_status torso_state_size(const torso_state_holder *holder, size_t *size, torso_state_error *error);

/* Makes a message empty, and keeps its memory. */
void torso_state_clear(torso_state_holder *holder);

/* The path of an error with its indices, as much as there is room for, ended by a 0. Returns its length, as snprintf does. */
size_t torso_state_error_path(const torso_state_error *error, char *text, size_t size);

/* A status as a word. */
const char *torso_state_status_text(torso_state_status status);

/* How many rows a memory has. What nothing bounds may be defined before this header is included. */
#define TORSO_STATE_ANGLES_ROWS 3 /* no message needs more */

/* Room for the lanes of one holder, where it need not grow. */
typedef struct torso_state_memory {
    float angles[TORSO_STATE_ANGLES_ROWS];
} torso_state_memory;

/* Makes a holder an empty message with that memory. */
static inline void torso_state_use(torso_state_holder *holder, torso_state_memory *memory)
{
    holder->unknown.rows = NULL;
    holder->unknown.capacity = 0;
    holder->angles.rows = memory->angles;
    holder->angles.capacity = TORSO_STATE_ANGLES_ROWS;
    holder->now = 0;
    holder->number = 0;
    torso_state_clear(holder);
}

/* Takes rows of `unknown` for an array or text of `count` elements. NULL where there is no room. */
static inline uint8_t *torso_state_add_unknown(torso_state_holder *holder, torso_state_span *span, int64_t count)
{
    if (count < 0 || count > holder->unknown.capacity - holder->unknown.used) {
        return NULL;
    }
    span->start = holder->unknown.used;
    span->count = count;
    holder->unknown.used += count;
    return holder->unknown.rows + span->start;
}

/* Takes rows of `angles` for an array or text of `count` elements. NULL where there is no room. */
static inline float *torso_state_add_angles(torso_state_holder *holder, torso_state_span *span, int64_t count)
{
    if (count < 0 || count > holder->angles.capacity - holder->angles.used) {
        return NULL;
    }
    span->start = holder->angles.used;
    span->count = count;
    holder->angles.used += count;
    return holder->angles.rows + span->start;
}


#ifdef __cplusplus
}
#endif

#endif
