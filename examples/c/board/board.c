#include "board.h"

#if defined(__arm__)

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Semihosting (ARM, "Semihosting for AArch32 and AArch64"): operation in r0, argument in r1, answer in r0. */
static uintptr_t semihosting(uintptr_t operation, const void *argument)
{
    register uintptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_EXIT = 0x18 };

static void write_text(const char *text, size_t length)
{
    /* The terminal, opened for writing: the standard output of the emulator. */
    static const char terminal[] = ":tt";
    static uintptr_t handle;
    static bool open;
    if (!open) {
        const uintptr_t arguments[3] = {(uintptr_t)terminal, 4u, sizeof terminal - 1u};
        handle = semihosting(SYS_OPEN, arguments);
        open = true;
    }
    const uintptr_t arguments[3] = {handle, (uintptr_t)text, length};
    (void)semihosting(SYS_WRITE, arguments);
}

void board_line(const char *text)
{
    write_text(text, strlen(text));
    write_text("\n", 1);
}

void board_exit(bool success)
{
    /* ADP_Stopped_ApplicationExit, or a run time error. */
    (void)semihosting(SYS_EXIT, success ? (const void *)0x20026 : (const void *)0x20023);
    for (;;) {
    }
}

#else

#include <stdio.h>
#include <stdlib.h>

void board_line(const char *text)
{
    puts(text);
}

void board_exit(bool success)
{
    exit(success ? EXIT_SUCCESS : EXIT_FAILURE);
}

#endif
