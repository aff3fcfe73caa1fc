/* What a unit is, beside the interface that all units share (fmi2.c). */
#ifndef MODEL_H
#define MODEL_H

#include <stdbool.h>
#include <stddef.h>

#include "trendid.h"

#define REALS_MAX 40
#define INTEGERS_MAX 10
#define BOOLEANS_MAX 6

/* The variables, by the value references of modelDescription.xml. */
struct values {
    double reals[REALS_MAX];
    int integers[INTEGERS_MAX];
    int booleans[BOOLEANS_MAX];
};

/* How many variables there are of a type: first the parameters, then the inputs, the others are outputs. */
struct kind {
    size_t parameters;
    size_t inputs;
    size_t all;
};

/* The variables, and the identity of the unit. */
struct description {
    const char *guid;
    struct kind reals;
    struct kind integers;
    struct kind booleans;
};

extern const struct description description;

/* Bytes of the object behind a unit. */
extern const size_t object_bytes;

/* The start values of modelDescription.xml. */
void model_defaults(struct values *values);

/* Sample time in s. */
double model_sample_time(const struct values *values);

/* Begins with the parameters; says what is refused. */
trendid_error model_begin(void *object, struct values *values, trendid_detail *detail);

/* One sample: inputs to outputs; says what is refused. */
trendid_error model_sample(void *object, struct values *values, trendid_detail *detail);

#endif
