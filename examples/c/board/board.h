/* What the examples need of a machine: a line of text out, and an end. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a line to the terminal, or through the debugger of the emulator. */
void board_line(const char *text);

/* Ends the program; on a board it stops. */
void board_exit(bool success);

#ifdef __cplusplus
}
#endif

#endif
