/* Decodes messages of three wires (a number from 0, a little-endian length, then bytes) into one holder, and shows it behind each. */

#include "seen.h"
#include <stdio.h>
#include <stdlib.h>

static void show(const seen_holder *holder)
{
    const seen_Seen *message = &holder->message;
    printf("ok %.*s %.17g [", (int)message->frame.count, (const char *)holder->frame.rows + message->frame.start, message->lead);
    for (int64_t at = 0; at < message->ranges.count; at++) {
        printf("%.17g ", holder->ranges.rows[message->ranges.start + at]);
    }
    printf("] %lld %.17g %d %.17g [", seen_Seen_has_count(message) ? (long long)message->count : -1000, message->least, message->ready != 0,
           message->tilt);
    for (int64_t at = 0; at < message->joined.count; at++) {
        printf("%.17g ", holder->joined.rows[message->joined.start + at]);
    }
    printf("] ");
    for (int64_t at = 0; at < message->names.count; at++) {
        const seen_span *name = &holder->names.rows[message->names.start + at];
        printf("%s%.*s", at == 0 ? "" : "|", (int)name->count, (const char *)holder->names_bytes.rows + name->start);
    }
    printf(" %lld", (long long)message->steps);
}

int main(void)
{
    static seen_memory memory;
    static seen_holder holder;
    unsigned char head[5];
    seen_use(&holder, &memory);
    while (fread(head, 1, sizeof head, stdin) == sizeof head) {
        const size_t size = (size_t)head[1] | (size_t)head[2] << 8 | (size_t)head[3] << 16 | (size_t)head[4] << 24;
        unsigned char *message = malloc(size); /* exactly, so that a tool sees what is read beyond */
        seen_error error;
        seen_status found = SEEN_OK;
        if (fread(message, 1, size, stdin) != size) {
            return 1;
        }
        switch (head[0]) {
        case 0:
            found = seen_decode_scan(&holder, message, size, &error);
            break;
        case 1:
            found = seen_decode_pose(&holder, message, size, &error);
            break;
        default:
            found = seen_decode_tilt(&holder, message, size, &error);
            break;
        }
        if (found == SEEN_OK) {
            show(&holder);
        } else {
            char path[100];
            seen_error_path(&error, path, sizeof path);
            printf("%s %d [%s] %.*s", seen_status_text(found), (int)error.offset, path, (int)error.detail_size, error.detail);
            printf(error.line[0] != 0 ? " (%s)" : "", error.line);
        }
        printf(" %lld %lld %lld\n", (long long)seen_age_scan(holder.state), (long long)seen_age_pose(holder.state),
               (long long)seen_age_tilt(holder.state));
        free(message);
    }
    return 0;
}
