/* The record of 5 000 samples of examples/data/servo.bin. */
#ifndef RECORD_H
#define RECORD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { RECORD_SAMPLES = 5000 };

/* Sample time in s. */
#define RECORD_SAMPLE_TIME 0.001f

struct sample {
    float u; /* command, -1 to 1 */
    float y; /* position in mm, from the reference of the sensor */
};

struct sample record_sample(uint32_t k);

#ifdef __cplusplus
}
#endif

#endif
