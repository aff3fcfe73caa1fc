/* The parts of the example; each gives whether it went well. */
#ifndef PARTS_H
#define PARTS_H

#include <stdbool.h>

#include "trendid.h"

bool identify_all(void);
bool control_all(void);
bool refuse_all(void);

/* Whether the call succeeded; writes the line `call: text` where not. */
bool done(const char *call, trendid_error error);

#endif
