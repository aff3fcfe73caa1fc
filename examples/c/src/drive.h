/* A simulated drive in the place of the machine: x''' + 20 x'' + 400 x' = 10^6 u in mm, behind a valve with a dead zone. */
#ifndef DRIVE_H
#define DRIVE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct drive {
    float position;     /* mm */
    float velocity;     /* mm/s */
    float acceleration; /* mm/s^2 */
    uint32_t seed;      /* of the noise of the sensor, two counts */
};

/* Code of the sensor at the begin of the travel, and mm per count. */
enum { DRIVE_ORIGIN = 8000000 };
#define DRIVE_MM_PER_COUNT 0.005f

/* At rest at 200 mm. */
struct drive drive_new(void);

/* Moves on by one millisecond under `command`; gives the code of the sensor. */
int32_t drive_move(struct drive *drive, float command);

#ifdef __cplusplus
}
#endif

#endif
