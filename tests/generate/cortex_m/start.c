/* What a Cortex-M does first, and where it goes when it fails. newlib's `_start` opens the files of who debugs it, and calls `main`. */

#include <stdint.h>

extern char __stack[];
void _start(void);
void _exit(int status);

void _init(void) {}
void _fini(void) {}

static void fails(void)
{
    _exit(77);
}

void reset(void)
{
#if defined(__ARM_FP)
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20; /* floats are off at first */
#endif
    _start();
}

__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))__stack, reset, fails, fails, fails, fails, fails, 0, 0, 0, 0, fails, fails, 0, fails, fails,
};
