#include "drive.h"

struct drive drive_new(void)
{
    const struct drive drive = {200.0f, 0.0f, 0.0f, 1u};
    return drive;
}

int32_t drive_move(struct drive *drive, float command)
{
    enum { STEPS = 8 };
    const float time = 0.001f / (float)STEPS;
    const float dead_zone = 0.03f;
    float flow = 0.0f;
    if (command > dead_zone) {
        flow = command - dead_zone;
    } else if (command < -dead_zone) {
        flow = command + dead_zone;
    }
    for (int step = 0; step < STEPS; step++) {
        const float jerk = 1e6f * flow - 20.0f * drive->acceleration - 400.0f * drive->velocity;
        drive->acceleration += time * jerk;
        drive->velocity += time * drive->acceleration;
        drive->position += time * drive->velocity;
    }
    drive->seed = drive->seed * 1664525u + 1013904223u;
    const int32_t noise = (int32_t)(drive->seed >> 24) % 5 - 2;
    return DRIVE_ORIGIN + (int32_t)(drive->position * 200.0f) + noise;
}
