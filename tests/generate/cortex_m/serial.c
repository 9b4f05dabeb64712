/* A line with one message around the documentation's firmware: prints its answer. */

#include <stdio.h>

size_t on_message(const unsigned char *bytes, size_t size, unsigned char *answer, size_t room);

int main(void)
{
    unsigned char message[256], answer[256];
    const size_t size = on_message(message, fread(message, 1, sizeof message, stdin), answer, sizeof answer);
    for (size_t at = 0; at < size; at++) {
        printf("%02x", answer[at]);
    }
    printf("\n");
    return 0;
}
