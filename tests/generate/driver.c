/* Decodes each message of its input (a little-endian length, then bytes) and writes it again: `ok BYTES`, or what is wrong and where. */

#include HEADER
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PASTED(unit, word) unit##_##word
#define JOINED(unit, word) PASTED(unit, word)
#define OF(word) JOINED(UNIT, word)

/* A message that cannot be written has no byte that is wrong. */
static void show(const OF(error) *error, int is_read)
{
    char path[4096];
    OF(error_path)(error, path, sizeof path);
    printf("%s ", OF(status_text)(error->status));
    if (is_read) {
        printf("%lld ", (long long)error->offset);
    }
    printf("[%s] ", path);
    fwrite(error->detail, 1, error->detail_size, stdout); /* it may have a text of the message, and that a NUL */
    printf(error->line[0] != 0 ? " (%s)\n" : "\n", error->line);
}

int main(void)
{
    static OF(memory) memory;
    static OF(holder) holder;
    unsigned char head[4];
    OF(use)(&holder, &memory);
    while (fread(head, 1, sizeof head, stdin) == sizeof head) {
        const size_t size = (size_t)head[0] | (size_t)head[1] << 8 | (size_t)head[2] << 16 | (size_t)head[3] << 24;
        unsigned char *message = malloc(size); /* exactly, so that a tool sees what is read beyond */
        OF(error) error;
        if (fread(message, 1, size, stdin) != size) {
            return 1;
        }
        if (OF(decode)(&holder, message, size, &error) != 0) {
            show(&error, 1);
        } else {
            size_t needed = 0, written = 0;
            if (OF(size)(&holder, &needed, &error) != 0) {
                show(&error, 0);
            } else {
                unsigned char *copy = malloc(needed);
                if (OF(encode)(&holder, copy, needed, &written, &error) != 0 || written != needed) {
                    show(&error, 0);
                } else {
                    printf("ok ");
                    for (size_t at = 0; at < written; at++) {
                        printf("%02x", copy[at]);
                    }
                    printf("\n");
                }
                free(copy);
            }
        }
        free(message);
    }
    return 0;
}
