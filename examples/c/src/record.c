#include "record.h"

/* Six bytes a sample, little endian: command as int16 (32 768 is full), position as int32 in micrometres. */
static const uint8_t bytes[] = {
#include "record_bytes.h"
};

_Static_assert(sizeof bytes == 6u * RECORD_SAMPLES, "the record has 5 000 samples");

/* Position of the sensor at the start of the drive, in micrometres. */
enum { REFERENCE = 1234567 };

struct sample record_sample(uint32_t k)
{
    const uint8_t *at = &bytes[6u * k];
    const uint16_t command = (uint16_t)(at[0] | (uint16_t)(at[1] << 8));
    const uint32_t position = (uint32_t)at[2] | (uint32_t)at[3] << 8 | (uint32_t)at[4] << 16 | (uint32_t)at[5] << 24;
    /* Each conversion is exact or rounded once, so that every machine starts from the same bits. */
    const struct sample sample = {
        .u = (float)(int16_t)command * (1.0f / 32768.0f),
        .y = (float)((int32_t)position - REFERENCE) * 0.001f,
    };
    return sample;
}
